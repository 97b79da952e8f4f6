function run = read(file)
% READ  Reads a recording that rigtwin wrote (CSV); `rigtwin import` makes one of other files.
%
%   run = rigtwin.read('run.csv')
%
%   MATLAB: a timetable, its units in run.Properties.VariableUnits. Octave has none: a structure with a column vector for each channel, t [s]
%   among them, and run.units.
  id = fopen(file, 'r', 'n', 'UTF-8');
  if id < 0
    error('rigtwin:input', '%s cannot be read, expected a recording', file);
  end
  text = fread(id, [1 Inf], '*char');
  fclose(id);
  ends = [find(text == sprintf('\n')), numel(text) + 1];
  from = 1;
  for at = ends  % comments, then the names
    header = strtrim(text(from:at - 1));
    from = at + 1;
    if ~isempty(header) && header(1) ~= '#'
      break;
    end
  end
  columns = strsplit(header, ',');
  units = regexprep(columns, '^[^\[]*(\[(.*)\])?$', '$2');
  names = regexprep(strtrim(regexprep(columns, '\[.*$', '')), '\W', '_');
  numbers = sscanf(strrep(text(from:end), ',', ' '), '%f');
  if isempty(numbers) || mod(numel(numbers), numel(names)) ~= 0
    error('rigtwin:input', '%s has rows of another length than its header, expected a recording that rigtwin wrote', file);
  end
  values = reshape(numbers, numel(names), []).';
  units{1} = 's';
  if exist('OCTAVE_VERSION', 'builtin')
    for i = 1:numel(names)
      run.(names{i}) = values(:, i);
      run.units.(names{i}) = units{i};
    end
  else
    run = array2timetable(values(:, 2:end), 'RowTimes', seconds(values(:, 1)), 'VariableNames', names(2:end));
    run.Properties.VariableUnits = units(2:end);
  end
end
