function [run, result] = simulate(rig, varargin)
% SIMULATE  Simulates a rig: firmware, rig and sensors in one loop.
%
%   run = rigtwin.simulate('rig.toml', 'duration', 60, 'road', 'iso8608:B')
%   [run, result] = rigtwin.simulate(...)     result: what rigtwin simulate --json says
%
%   Names and values are the options of `rigtwin simulate`, with _ for -; true stands for an option without value ('no_noise', true).
%   run: as RIGTWIN.READ gives it.
  folder = tempname();
  mkdir(folder);
  remove = onCleanup(@() rmdir(folder, 's'));
  file = fullfile(folder, 'run.csv');
  result = rigtwin.command('simulate', '--rig', rig, '--out', file, varargin{:});
  run = rigtwin.read(file);
end
