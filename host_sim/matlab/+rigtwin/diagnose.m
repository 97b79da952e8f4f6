function verdict = diagnose(rig, data, varargin)
% DIAGNOSE  Names what a rig does that its description does not know.
%
%   verdict = rigtwin.diagnose('rig.toml', 'recording.csv', 'out', 'result')
%   verdict.verdict, verdict.effects(1).name
%
%   data: a file, or a cell array of files. Names and values are the options of `rigtwin diagnose`, with _ for -. With 'out' the folder holds
%   verdict.json, report.html and rig.toml. verdict: verdict.json.
  verdict = rigtwin.command('diagnose', '--rig', rig, '--data', data, varargin{:});
end
