function result = diagnose(folder, varargin)
%DIAGNOSE  Where model and measurement of a campaign disagree, as `reliab diagnose` gives it, as a struct.
%   result = reliab.diagnose('campaign', 'out', 'diagnosis')
    result = reliab.call('diagnose', {folder}, varargin);
end
