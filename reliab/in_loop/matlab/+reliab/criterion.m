function result = criterion(varargin)
%CRITERION  How much error a rig may have, as `reliab criterion` gives it, as a struct.
%   result = reliab.criterion('ellipses', 'ellipses.csv', 'confidence', 0.95)
    result = reliab.call('criterion', {}, varargin);
end
