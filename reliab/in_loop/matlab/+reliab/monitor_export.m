function result = monitor_export(kind, place, varargin)
%MONITOR_EXPORT  Write the running error for the loop of a test.
%   reliab.monitor_export('c', 'monitor', 'f', 1, 'xi', 0.02, 'rate', 4096)
%   reliab.monitor_export('fmu', 'monitor.fmu', 'structure', 'frame.toml', 'rate', 4096)
    result = reliab.call('monitor', {'--export', kind, place}, varargin);
end
