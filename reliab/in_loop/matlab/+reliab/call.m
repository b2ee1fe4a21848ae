function result = call(command, words, options)
%CALL  Ask the command line; a refusal is an error with its sentence.
%   The program is `reliab`, or what the environment variable RELIAB names.
    program = getenv('RELIAB');
    if isempty(program)
        program = 'reliab';
    end
    answer = [tempname() '.json'];
    words = [{command} words written(options) {'--json', answer}];
    words = cellfun(@(word) quoted(char(word)), words, 'UniformOutput', false);
    line = [program sprintf(' %s', words{:})];
    [code, said] = system([line ' 2>&1']);
    if code > 1 || exist(answer, 'file') ~= 2
        error('reliab:refused', '%s', strtrim(regexprep(said, '^Error: ', '')));
    end
    removed = onCleanup(@() delete(answer));
    result = jsondecode(fileread(answer));
end

function words = written(options)
    if mod(numel(options), 2) ~= 0
        error('reliab:refused', 'Options come as names and values');
    end
    words = {};
    for k = 1:2:numel(options)
        value = options{k + 1};
        name = ['--' strrep(char(options{k}), '_', '-')];
        if isstring(value)
            value = cellstr(value);
        end
        if islogical(value)
            words = [words repmat({name}, 1, double(value))];
        elseif isnumeric(value)
            words = [words {name} arrayfun(@(x) sprintf('%.17g', x), value(:)', 'UniformOutput', false)];
        elseif iscell(value)
            words = [words {name} value(:)'];
        else
            words = [words {name, value}];
        end
    end
end

function word = quoted(word)
    if ispc()
        if any(word == '"')
            error('reliab:refused', 'A value must not hold a quotation mark');
        end
        word = ['"' word '"'];
    else
        word = ['''' strrep(word, '''', '''\''''') ''''];
    end
end
