% The package +rigtwin in Octave. RIGTWIN names the program; the working folder is the root of the tree.
function package_test()
  addpath(fullfile(pwd(), 'host_sim', 'matlab'));
  folder = tempname();
  mkdir(folder);
  remove = onCleanup(@() rmdir(folder, 's'));
  rig = fullfile(pwd(), 'host_sim', 'rigs', 'paper_hil_fdva.toml');

  % A run has the program's numbers and units; the trace hash of the same command says that it is the same run.
  [run, result] = rigtwin.simulate(rig, 'duration', 2, 'road', 'iso8608:A', 'speed', 20, 'seed', 7, 'no_noise', true);
  assert(numel(run.t) == 2000 && run.t(1) == 0 && run.t(2000) == 1.999);
  assert(strcmp(run.units.F_w, 'N') && strcmp(run.units.zdd_r, 'm/s²') && strcmp(run.units.t, 's') && isempty(run.units.duct_1));
  assert(max(abs(run.dz_w - (run.z_r - run.z_w))) < 1e-12);  % the wheel's deflection by its definition
  [~, again] = rigtwin.simulate(rig, 'duration', 2, 'road', 'iso8608:A', 'speed', 20, 'seed', 7, 'no_noise', true);
  [~, other] = rigtwin.simulate(rig, 'duration', 2, 'road', 'iso8608:A', 'speed', 20, 'seed', 7, 'no_noise', false);
  assert(isequal(result.trace, again.trace) && ~isequal(result.trace, other.trace));

  % A recording of the described rig, with a name that a shell would take apart, is explained by it.
  recording = fullfile(folder, 'it''s $HOME.csv');
  rigtwin.command('simulate', '--rig', rig, '--out', recording, 'duration', 8);
  compared = rigtwin.compare(rig, recording);
  assert(compared.channels.F_w.nrmse < 0.1);
  verdict = rigtwin.diagnose(rig, {recording}, 'out', fullfile(folder, 'out'));
  assert(strcmp(verdict.verdict, 'no_discrepancy') && isempty(verdict.effects));
  assert(exist(fullfile(folder, 'out', 'report.html'), 'file') == 2);

  % Errors are errors, by their kind, with the program's line.
  expect_error(@() rigtwin.simulate('none.toml'), 'rigtwin:input', 'none.toml');
  expect_error(@() rigtwin.simulate(rig, 'velocity', 3), 'rigtwin:usage', 'velocity');
  expect_error(@() rigtwin.read(fullfile(folder, 'none.csv')), 'rigtwin:input', 'none.csv');
  disp('the package +rigtwin: simulate, read, compare, diagnose and errors are right');
end

function expect_error(call, identifier, part)
  try
    call();
  catch caught
    assert(strcmp(caught.identifier, identifier), [caught.identifier ': ' caught.message]);
    assert(~isempty(strfind(caught.message, part)), caught.message);
    return;
  end
  error('no error, expected %s', identifier);
end
