#!/bin/bash
# python.bash BUILD PYTHON -- the notebook module: its tests in Python, and its stub and its functions have the same parameters.
. "$(dirname "$0")/common.bash"
python=$2
"$python" -c 'import pandas' 2>/dev/null || skip "pandas is missing (toolchains/setup tests installs it)"
export PYTHONPATH=$1/python
"$python" tests/host_sim/python/module_test.py
"$python" - <<'END'
import ast, pathlib
import inspect, rigtwin
stub = ast.parse(pathlib.Path(rigtwin.__file__).with_suffix(".pyi").read_text())
said = {f.name: [a.arg for a in f.args.args + f.args.kwonlyargs] for f in stub.body if isinstance(f, ast.FunctionDef)}
real = {name: [p.name for p in inspect.signature(getattr(rigtwin, name)).parameters.values() if p.kind != p.VAR_KEYWORD] for name in said}
assert said == real, {name: (said[name], real[name]) for name in said if said[name] != real[name]}
assert set(said) | {"Rig", "Result", "InputError", "UsageError", "OutputError", "RunStopped"} == set(rigtwin.__all__)
END
