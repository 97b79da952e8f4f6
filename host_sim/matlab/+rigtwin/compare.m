function result = compare(rig, data, varargin)
% COMPARE  Compares recordings with the simulation of their own input.
%
%   result = rigtwin.compare('rig.toml', 'recording.csv')
%   result.channels.F_w.nrmse
%
%   data: a file, or a cell array of files. Names and values are the options of `rigtwin compare`, with _ for -. result: its JSON.
  result = rigtwin.command('compare', '--rig', rig, '--data', data, varargin{:});
end
