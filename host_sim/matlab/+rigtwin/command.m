function result = command(name, varargin)
% COMMAND  Runs a command of rigtwin and gives its JSON as a structure.
%
%   result = rigtwin.command('stability', '--rig', 'rig.toml')
%
%   After options as on the command line: names and values, with _ for -. A cell array gives an option several values, true one without
%   value, false none. The program is that of the environment variable RIGTWIN, otherwise `rigtwin` on the path. An error of it is
%   rigtwin:usage, rigtwin:input, rigtwin:output, rigtwin:stopped or rigtwin:internal, by its exit status, with its line.
  program = getenv('RIGTWIN');
  if isempty(program)
    program = 'rigtwin';
  end
  json = [tempname() '.json'];
  line = [quoted(program) ' ' name];
  given = [varargin, {'--json', json, '--quiet', true}];
  for i = 1:2:numel(given)
    option = given{i};
    if strncmp(option, '--', 2) == 0
      option = ['--' strrep(option, '_', '-')];
    end
    value = given{i + 1};
    if islogical(value)
      if value
        line = [line ' ' option];
      end
      continue;
    end
    if ~iscell(value)
      value = {value};
    end
    for j = 1:numel(value)
      line = [line ' ' option ' ' quoted(value{j})];
    end
  end
  [status, output] = system([line ' 2>&1']);
  remove = onCleanup(@() delete_if_there(json));
  if status ~= 0
    kinds = {'internal', 'usage', 'input', 'output', 'internal', 'stopped'};
    kind = kinds{max(1, min(status, 6))};
    error(['rigtwin:' kind], '%s', strtrim(output));
  end
  result = jsondecode(fileread(json));
end

function text = quoted(value)
  if isnumeric(value)
    text = sprintf('%.17g', value);
  elseif ispc()
    text = ['"' strrep(value, '"', '\"') '"'];
  else
    text = ['''' strrep(value, '''', '''\''''') ''''];
  end
end

function delete_if_there(file)
  if exist(file, 'file')
    delete(file);
  end
end
