"""rigtwin in a notebook: recordings as pandas frames, rig descriptions with editable keys, every analysis as an object.

Frames: index ``t`` [s], a column for each channel (``z_r``, ``F_w``, …; ``rigtwin channels`` lists them) in SI units; ``frame.attrs["units"]``
maps column to unit. What a function cannot take is an ``InputError`` with ``file`` and ``line``.

Recordings are read, written and simulated in this process, without a copy; an analysis is the program `rigtwin` in a process of its own:
Ctrl-C ends it, its memory goes with it, and its result is the JSON that the program writes (host_sim/schemas).
"""
from __future__ import annotations

import json as _json
import os as _os
import pathlib as _pathlib
import re as _re
import shutil as _shutil
import socket as _socket
import subprocess as _subprocess
import tempfile as _tempfile
import tomllib as _tomllib

import pandas as _pandas

from . import _core
from ._core import InputError, OutputError, RunStopped, UsageError

__version__ = _core.version
__all__ = ["Rig", "Result", "InputError", "OutputError", "RunStopped", "UsageError", "read", "write", "simulate", "compare", "diagnose",
           "plan", "frf", "stability", "transfer", "estimate", "replicate", "live"]


class _Place:
    """File and line of an InputError, from its text "file:line: what is wrong, expected what"."""

    def __init__(self, group, convert):
        self._group, self._convert = group, convert

    def __get__(self, error, owner=None):
        found = _re.match(r"(?P<file>[^\n]*?):(?:(?P<line>\d+):)? ", str(error))
        value = found and found[self._group]
        return self._convert(value) if value else None


InputError.file = _Place("file", str)
InputError.line = _Place("line", int)


class Rig:
    """A rig description: its text, with comments, and its keys.

    >>> rig = Rig.load("rig.toml")
    >>> softer = rig.edit({"suspension.stiffness": 27e3, "tolerance.suspension.damping": 0.05})
    >>> softer.suspension.stiffness
    27000.0
    >>> softer.save("softer.toml")
    """

    def __init__(self, text: str, source: str | _os.PathLike = "rig.toml"):
        self.text, self.source = text, str(source)
        self.kind, self.sample_rate = _core.check(text, self.source)

    @classmethod
    def load(cls, path: str | _os.PathLike) -> Rig:
        """The description in a TOML file. InputError with file and line where it is wrong."""
        try:
            text = _pathlib.Path(path).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"{path}: cannot be read: {error}, expected a rig description (TOML)") from None
        return cls(text, path)

    @property
    def keys(self) -> dict:
        """All keys as a dictionary of tables."""
        return _tomllib.loads(self.text)

    def __getattr__(self, name):
        if name.startswith("_") or "text" not in self.__dict__ or name not in self.keys:  # a copy has no text at first
            raise AttributeError(f"no table or key {name!r}")
        return _Table(self.keys[name])

    @property
    def tolerances(self) -> dict[str, float]:
        """Parameter → relative bound."""
        return self.keys.get("tolerance", {})

    @property
    def effects(self) -> dict[str, dict]:
        """Effect → its parameters."""
        return self.keys.get("effects", {})

    def edit(self, changes: dict[str, object]) -> Rig:
        """A copy with other values: "table.key" → number, text, list; None takes a key away. Comments stay. Of ``laws.NAME.at`` and
        ``effects.NAME.force`` the table is ``laws.NAME``; of ``tolerance.tyre.stiffness`` it is ``tolerance``. InputError where the new
        description is wrong."""
        text = self.text
        for path, value in changes.items():
            text = _edited(text, path, value)
        return Rig(text, self.source)

    def save(self, path: str | _os.PathLike) -> None:
        """Writes the text; a file appears whole or not at all."""
        target = _pathlib.Path(path)
        part = target.with_name(f".{target.name}.{_os.getpid()}")
        part.write_text(self.text, encoding="utf-8")
        part.replace(target)

    def __eq__(self, other):
        return isinstance(other, Rig) and self.keys == other.keys

    def __repr__(self):
        return f"Rig({self.source!r}: {self.kind}, {self.sample_rate:g} Hz)"

    def _repr_html_(self):
        return f"<pre>{_escaped(self.text)}</pre>"


class _Table(dict):
    """A table of a description: keys are attributes, too."""

    def __new__(cls, value):
        return super().__new__(cls) if isinstance(value, dict) else value

    def __getattr__(self, name):
        try:
            return _Table(self[name])
        except KeyError:
            raise AttributeError(f"no key {name!r}, expected one of {', '.join(self)}") from None


def _escaped(text):
    return text.replace("&", "&amp;").replace("<", "&lt;")


def _toml(value) -> str:
    if hasattr(value, "tolist"):  # of numpy
        value = value.tolist()
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_json.dumps(k)} = {_toml(v)}" for k, v in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(v) for v in value) + "]"
    return _json.dumps(value, ensure_ascii=False)


def _edited(text: str, path: str, value) -> str:
    """The text with one key changed, added or taken away."""
    heads = [found[1].strip() for found in _re.finditer(r"(?m)^\s*\[([^\[\]\n]+)\]", text)]
    table = max((head for head in heads if path.startswith(head + ".")), key=len, default=None)
    if table is not None:
        key = path[len(table) + 1:]
    else:
        named = path.startswith(("effects.", "laws.", "converters.", "lasers."))
        table, _, key = path.rpartition(".") if named else path.partition(".")
        if not key:
            table, key = "", path
    written = key if _re.fullmatch(r"[\w-]+", key) else _json.dumps(key)
    lines, begin, end = text.split("\n"), 0, None
    if table:
        heads = [i for i, line in enumerate(lines) if _re.match(rf"\s*\[\s*{_re.escape(table)}\s*\]", line)]
        if not heads:
            return text if value is None else text.rstrip("\n") + f"\n\n[{table}]\n{written} = {_toml(value)}\n"
        begin = heads[0] + 1
    end = next((i for i in range(begin, len(lines)) if _re.match(r"\s*\[", lines[i])), len(lines))
    for i in range(begin, end):
        found = _re.match(rf'(\s*(?:{_re.escape(key)}|"{_re.escape(key)}")\s*=\s*)(?:"[^"]*"|\[.*\]|\{{.*\}}|[^#]*?)(\s*(?:#.*)?)$', lines[i])
        if found:
            lines[i:i + 1] = [] if value is None else [found[1] + _toml(value) + found[2]]
            if value is None and table and not any("=" in line.partition("#")[0] for line in lines[begin:end - 1]):
                del lines[begin - 1]  # the head of a table without keys
            return "\n".join(lines)
    if value is not None:
        while end > begin and not lines[end - 1].strip():
            end -= 1
        lines.insert(end, f"{written} = {_toml(value)}")
    return "\n".join(lines)


# Recordings and frames.

def _frame(recording, **attrs) -> _pandas.DataFrame:
    (_, _, time), *rest = recording.columns()
    frame = _pandas.DataFrame({name: values for name, _, values in rest}, index=_pandas.Index(time, name="t"), copy=False)
    frame.attrs.update(units={"t": "s"} | {name: unit for name, unit, _ in rest}, **attrs)
    return frame


def _recording(frame: _pandas.DataFrame):
    units = frame.attrs.get("units", {})
    columns = [(str(name), units.get(name, ""), frame[name].to_numpy(dtype=float)) for name in frame]
    return _core.Recording.from_columns([("t", "s", frame.index.to_numpy(dtype=float)), *columns])


def read(path, rig: Rig | None = None, *, map=(), rate: float | None = None, time: str | None = None, skip: int = 0,
         start: float | None = None, end: float | None = None) -> _pandas.DataFrame:
    """A recording of any format that ``rigtwin import`` reads, in SI units.

    map: ["F=Kraft [kN]", "x_act=CHANNEL0 * 0.01"]; rate [Hz]: rows are samples at it; time: the column that is the time; skip: lines of text;
    start, end [s]: the part kept. ``attrs``: units, format, notes, left_out (name → reason)."""
    recording, kind, notes, left_out = _core.read(str(path), rig.text if rig else None, rig.source if rig else "", list(map), rate, time, skip,
                                                  start, end)
    return _frame(recording, format=kind, notes=notes, left_out=dict(left_out))


def write(path, frame: _pandas.DataFrame) -> None:
    """Writes a frame; the ending decides: .csv, .mat, .mf4, .rsp, .mcap, .uff, .tsv, .de.csv."""
    _core.write(str(path), _recording(frame))


def simulate(rig: Rig, duration: float = 60.0, road="iso8608:B", speed: float = 27.78, seed: int = 1, *, bandwidth: float | None = None,
             cut_off: float | None = None, noise: bool = True, allow_stop: bool = False, progress=None) -> _pandas.DataFrame:
    """A simulated run through the firmware, `duration` [s] over a road at `speed` [m/s], as ``rigtwin simulate``: the same bits.

    road: "iso8608:A" … "H", or a file; progress: called with the share done. RunStopped where the firmware stops the run."""
    recording = _core.simulate(rig.text, rig.source, str(road), speed, duration, seed, bandwidth, cut_off, noise, allow_stop, progress)
    return _frame(recording)


# Analyses: the program in a process of its own.

class Result(dict):
    """What a command writes as JSON; keys are attributes, too. ``report``: its page (HTML), where it has one."""

    def __init__(self, values, report: str = "", text: str = ""):
        super().__init__(values)
        self.__dict__.update(report=report, text=text)

    def __getattr__(self, name):
        try:
            value = self[name]
        except KeyError:
            raise AttributeError(f"no {name!r}, expected one of {', '.join(self)}") from None
        return Result(value) if isinstance(value, dict) else value

    def _repr_html_(self):
        if self.report:
            page = self.report.replace("&", "&amp;").replace('"', "&quot;")
            return f'<iframe srcdoc="{page}" style="width:100%;height:40em;border:0"></iframe>'
        return f"<pre>{_escaped(self.text or _json.dumps(self, indent=2, ensure_ascii=False))}</pre>"


def _program() -> str:
    beside = _pathlib.Path(_core.__file__).resolve().parents[2] / "bin" / "rigtwin"
    found = _os.environ.get("RIGTWIN") or (str(beside) if beside.exists() else _shutil.which("rigtwin"))
    if not found:
        raise FileNotFoundError("the program rigtwin is not on the path; RIGTWIN names it")
    return found


_errors = {2: UsageError, 3: InputError, 4: OutputError, 6: RunStopped}


def _run(words, progress=None) -> str:
    """Runs the program and gives what it prints; its one line of error as an exception. progress: called with share and words."""
    command = [_program(), *map(str, words), *(["--verbose"] if progress else [])]
    with _tempfile.TemporaryFile() as out:
        with _subprocess.Popen(command, stdout=out, stderr=_subprocess.PIPE, encoding="utf-8", errors="replace") as process:
            try:
                remarks = []
                for line in process.stderr if progress else ():
                    share = _re.match(r".*? +(\d+) %(.*)", line)
                    progress(int(share[1]) / 100, share[2].strip()) if share else remarks.append(line)
                _, rest = process.communicate()
            except BaseException:
                process.terminate()  # it takes its unfinished files away
                raise
        out.seek(0)
        output = out.read().decode("utf-8", "replace")
    if process.returncode:
        last = ("".join(remarks) + rest).strip().rpartition("\n")[2].removeprefix("rigtwin: ")
        raise _errors.get(process.returncode, RuntimeError)(last or f"rigtwin ended with status {process.returncode}")
    return output


class _Files:
    """Rigs and frames as files for one command; they go when it has ended."""

    def __enter__(self):
        self._folder = _tempfile.TemporaryDirectory(prefix="rigtwin-")
        self.path, self._beside = _pathlib.Path(self._folder.name), []
        return self

    def __exit__(self, *_):
        for file in self._beside:
            file.unlink(missing_ok=True)
        self._folder.cleanup()

    def rig(self, rig) -> str:
        """The file of a rig; an edited one stands beside its own file for a while, whose tables and roads it may name."""
        if not isinstance(rig, Rig):
            return str(rig)
        source = _pathlib.Path(rig.source)
        if source.exists() and source.read_text(encoding="utf-8") == rig.text:
            return str(source)
        folder = source.parent if source.exists() and _os.access(source.parent, _os.W_OK) else self.path
        handle, name = _tempfile.mkstemp(prefix=".rigtwin-", suffix=".toml", dir=folder)
        self._beside.append(_pathlib.Path(name))
        with open(handle, "w", encoding="utf-8") as file:
            file.write(rig.text)
        return name

    def data(self, frames, option="--data") -> list[str]:
        many = frames if isinstance(frames, (list, tuple)) else [frames]
        words = []
        for i, frame in enumerate(many):
            if isinstance(frame, _pandas.DataFrame):
                file = self.path / f"{option.strip('-')}_{i + 1}.csv"
                write(file, frame)
                frame = file
            words += [option, str(frame)]
        return words


def _options(choices: dict) -> list[str]:
    words = []
    for name, value in choices.items():
        option = "--" + name.rstrip("_").replace("_", "-")
        if value is True:
            words.append(option)
        elif value is not None and value is not False:
            for one in value if isinstance(value, (list, tuple)) else [value]:
                words += [option, str(one)]
    return words


def _analysis(command, rig, frames, choices, progress=None, report=True, data="--data") -> Result:
    """A command with --json and --report."""
    with _Files() as files:
        json, page = files.path / "result.json", files.path / "report.html"
        words = [command, *(["--rig", files.rig(rig)] if rig is not None else []), *(files.data(frames, data) if frames is not None else [])]
        words += _options(choices) + ["--json", json] + (["--report", page] if report else [])
        text = _run(words, progress)
        return Result(_json.loads(json.read_text(encoding="utf-8")), page.read_text(encoding="utf-8") if page.exists() else "", text)


def compare(rig: Rig, frames, *, refit: bool = False, progress=None, **options) -> Result:
    """Recordings against the simulation of their own input: ``result.channels["F_w"]["nrmse"]`` …, as ``rigtwin compare``."""
    return _analysis("compare", rig, frames, {"refit": refit, **options}, progress)


def diagnose(rig: Rig, frames, *, holdout=None, progress=None, **options) -> Result:
    """What the model lacks: verdict.json as an object, ``result.rig`` the description with what was found, ``result.report`` the page."""
    with _Files() as files:
        out = files.path / "diagnosis"
        words = ["diagnose", "--rig", files.rig(rig), *files.data(frames), *(files.data(holdout, "--holdout") if holdout is not None else [])]
        text = _run(words + _options(options) + ["--out", out], progress)
        result = Result(_json.loads((out / "verdict.json").read_text(encoding="utf-8")), (out / "report.html").read_text(encoding="utf-8"), text)
        source = rig.source if isinstance(rig, Rig) else str(rig)
        result.__dict__["rig"] = Rig((out / "rig.toml").read_text(encoding="utf-8"), _pathlib.Path(source).parent / "diagnosed.toml")
        return result


def plan(rig: Rig, *, progress=None, **options) -> Result:
    """What a recording would show, before it is made: road, speed, duration [s], level, seed, without."""
    return _analysis("plan", rig, None, options, progress)


def frf(frames, input: str, output, *, rig: Rig | None = None, progress=None, **options) -> Result:
    """Frequency responses with bands, coherence and delay, from `input` to each of `output`."""
    return _analysis("frf", rig, frames, {"input": input, "output": output, **options}, progress)


def stability(rig: Rig, *, progress=None, **options) -> Result:
    """Delay stability of a hil rig: margins of the sampled loop first."""
    return _analysis("stability", rig, None, options, progress)


def estimate(rig: Rig, frame, *, progress=None, **options) -> Result:
    """The controller's Kalman filter over a recording; ``result.estimates``: its states and forces as a frame."""
    with _Files() as files:
        out, json, page = files.path / "estimates.csv", files.path / "result.json", files.path / "report.html"
        words = ["estimate", "--rig", files.rig(rig), *files.data(frame), *_options(options), "--out", out, "--json", json, "--report", page]
        result = Result({}, text=_run(words, progress))
        result.update(_json.loads(json.read_text(encoding="utf-8")))
        result.__dict__.update(report=page.read_text(encoding="utf-8") if page.exists() else "", estimates=read(out))
        return result


def transfer(source: Rig, frames, target: Rig, *, progress=None, **options) -> Result:
    """A component on another rig, with bands: `source` and its recordings, `target` the rig it goes to."""
    with _Files() as files:
        out = files.path / "transfer"
        words = ["transfer", "--from", files.rig(source), *files.data(frames), "--to", files.rig(target), "--out", out]
        text = _run(words + _options(options), progress)
        page = out / "report.html"
        return Result(_json.loads((out / "transfer.json").read_text(encoding="utf-8")), page.read_text(encoding="utf-8") if page.exists() else "", text)


def replicate(rig: Rig, target, channels, out, *, progress=None, **options) -> Result:
    """The drive that makes a rig do what `target` shows, in the folder `out` (drive_1.csv …); simulated=, runs= as the command has them."""
    with _Files() as files:
        channels = channels if isinstance(channels, str) else ",".join(channels)
        words = ["replicate", "--rig", files.rig(rig), *files.data(target, "--target"), "--channels", channels, "--out", out]
        text = _run(words + _options(options), progress)
    page = _pathlib.Path(out) / "report.html"
    return Result(_json.loads((_pathlib.Path(out) / "replicate.json").read_text(encoding="utf-8")), page.read_text(encoding="utf-8") if page.exists() else "", text)


def live(seconds: float = 10.0, *, port: int = 9870, most: int = 100_000) -> _pandas.DataFrame:
    """What a running controller publishes (``rig_controller --publish``) within `seconds`, one row a datagram with its values."""
    import time as _time
    rows, until = [], _time.monotonic() + seconds
    with _socket.socket(_socket.AF_INET, _socket.SOCK_DGRAM) as receiver:
        receiver.setsockopt(_socket.SOL_SOCKET, _socket.SO_REUSEADDR, 1)
        receiver.bind(("127.0.0.1", port))
        while len(rows) < most and (left := until - _time.monotonic()) > 0:
            receiver.settimeout(left)
            try:
                datagram = _json.loads(receiver.recv(65536))
            except TimeoutError:
                break
            except ValueError:
                continue
            if not isinstance(datagram, dict):  # anybody may send
                continue
            rows.append({k: v for k, v in datagram.items() if isinstance(v, (int, float, str)) and not isinstance(v, bool)})
    frame = _pandas.DataFrame(rows).rename(columns={"timestamp": "t"})
    return frame.set_index("t") if "t" in frame else frame
