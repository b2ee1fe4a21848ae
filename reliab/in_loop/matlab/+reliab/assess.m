function result = assess(test, varargin)
%ASSESS  Verdict on a hybrid test, as `reliab assess` gives it, as a struct.
%   result = reliab.assess('test.csv', 'f', 1, 'xi', 0.02)
%   result = reliab.assess([time command measured], 'f', 1, 'xi', 0.02)    s and m
%   Names are the options of the command line with _ for -, values numbers, strings, or true.
    if isnumeric(test)
        if size(test, 2) ~= 3
            error('reliab:refused', 'A test has three columns: time [s], command [m], measured [m]');
        end
        name = [tempname() '.csv'];
        removed = onCleanup(@() delete(name));
        stream = fopen(name, 'w');
        fprintf(stream, 'time_s,command_m,measured_m\n');
        fprintf(stream, '%.17g,%.17g,%.17g\n', test');
        fclose(stream);
        test = name;
    end
    result = reliab.call('assess', {test}, varargin);
end
