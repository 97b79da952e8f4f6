#!/usr/bin/env python3
"""Figures about learned laws, over recordings whose law is known. Run by hand; it takes some minutes of processor time:

    tests/confusion/laws.py build/host/bin SEED [COUNT [KIND …]] > tests/golden/laws.txt

Draws every group law:KIND:* with COUNT seeds from SEED on, and rigs that hide nothing or an effect of the catalogue;
diagnoses each, reads verdict.json and truth.json. On benches a polynomial NARX of as many numbers as the law's model
has free parameters is fitted to the same data and judged, free running, on the same quarter that neither saw."""
import csv
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import time

FLOOR, FLOOR_MEMORY, EXPONENT = 1.2, 1.5, 0.05  # wanted: error / noise floor without and with memory, of the exponent
# What a right answer is: shape of a learned law, or effect of the catalogue.
RIGHT = {
    "power_law_low": {"power law"}, "power_law_high": {"power law", "quadratic_damping"},
    "cubic_damping": {"power law"}, "smooth_friction": {"smooth friction"},
    "blow_off": {"degressive"}, "stribeck_friction": {"stribeck", "stribeck_friction"},
    "asymmetric_damper": {"asymmetric", "asymmetric_damper"},
    "lopsided_spring": {"asymmetric power law", "asymmetric"}, "leaf_friction": {"follows the load"},
    "hysteresis": {"hysteresis", "bouc_wen"}, "lugre_friction": {"hysteresis", "bouc_wen", "stribeck_friction", "smooth friction"},
    "machine_play": {"hysteresis"},
}
MEMORY = {"hysteresis", "lugre_friction", "machine_play"}


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, timeout=600)


def solved(a, b):
    """a x = b by elimination with pivots."""
    n = len(b)
    rows = [list(r) + [v] for r, v in zip(a, b)]
    for i in range(n):
        p = max(range(i, n), key=lambda r: abs(rows[r][i]))
        rows[i], rows[p] = rows[p], rows[i]
        if abs(rows[i][i]) < 1e-30:
            return None
        for r in range(i + 1, n):
            f = rows[r][i] / rows[i][i]
            if f:
                rows[r] = [u - f * v for u, v in zip(rows[r], rows[i])]
    x = [0.0] * n
    for i in reversed(range(n)):
        x[i] = (rows[i][n] - sum(rows[i][k] * x[k] for k in range(i + 1, n))) / rows[i][i]
    return x


def narx_error(x, force, split, size):
    """rms error / rms of F behind `split` of a NARX with `size` terms: F(k) over F(k-1), F(k-2), x(k), x(k-1), x(k-2)
    and products of deflection and velocity, by least squares on what is before; free running from measured values."""
    unit = math.sqrt(sum(v * v for v in x) / len(x))
    speed = math.sqrt(sum((x[k] - x[k - 1]) ** 2 for k in range(1, len(x))) / len(x))
    strong = math.sqrt(sum(v * v for v in force) / len(force))

    def terms(k, f1, f2):
        u, v = x[k] / unit, (x[k] - x[k - 1]) / speed
        a = [f1 / strong, f2 / strong, u, x[k - 1] / unit, x[k - 2] / unit, abs(v) * v, v ** 3, u ** 3, u * u * v, abs(u) * v,
             u * abs(v), abs(v) ** 0.5 * v, math.tanh(10 * v), abs(u) * math.tanh(10 * v), u * v, u * u, v * v, 1.0]
        return a[:max(6, min(size, len(a)))]

    n = len(terms(2, 0.0, 0.0))
    a, b = [[0.0] * n for _ in range(n)], [0.0] * n
    for k in range(2, split):
        t = terms(k, force[k - 1], force[k - 2])
        for i in range(n):
            ti = t[i]
            b[i] += ti * force[k] / strong
            row = a[i]
            for j in range(i, n):
                row[j] += ti * t[j]
    for i in range(n):
        for j in range(i):
            a[i][j] = a[j][i]
    w = solved(a, b)
    if w is None:
        return math.inf
    f2, f1, error, power = force[split - 2], force[split - 1], 0.0, 0.0
    for k in range(split, len(x)):
        f = strong * sum(wi * ti for wi, ti in zip(w, terms(k, f1, f2)))
        if not abs(f) < 1e9:
            return math.inf
        error += (f - force[k]) ** 2
        power += force[k] ** 2
        f2, f1 = f1, f
    return math.sqrt(error / power)


def error_of(rigtwin, rig, data):
    """The error of F that a rig description leaves on a recording."""
    out = run(rigtwin, "compare", "--rig", rig, "--data", data, "--start", "estimated").stdout
    found = re.search(r"^\s*F\s+([0-9.]+)", out, re.M)
    return float(found.group(1)) if found else math.nan


def split_bench(folder):
    with open(folder / "rec1.csv") as f:
        rows = list(csv.reader(f))
    head, rows = rows[0], rows[1:]
    cut = len(rows) * 3 // 4
    for name, part in (("first.csv", rows[:cut]), ("last.csv", rows[cut:])):
        start = float(part[0][0])
        with open(folder / name, "w", newline="") as f:
            out = csv.writer(f, lineterminator="\n")
            out.writerow(head)
            for r in part:
                out.writerow([f"{float(r[0]) - start:.6f}"] + r[1:])
    column = {name: [float(r[i]) for r in rows] for i, name in enumerate(head)}
    return cut, column


def one(binaries, group, seed):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="laws_"))
    run(binaries / "rigtwin_truth", group, str(seed), folder)
    truth = json.loads((folder / "truth.json").read_text())
    records = sorted(str(p) for p in folder.glob("rec*.csv"))
    begun = time.time()
    said = run(binaries / "rigtwin", "diagnose", "--rig", folder / "rig.toml", "--data", *records, "--out", folder / "found")
    if not (folder / "found" / "verdict.json").exists():
        return {"failure": said.stderr.strip()}
    verdict = json.loads((folder / "found" / "verdict.json").read_text())
    gaps = {c: g["after"] / g["noise_floor"] for c, g in verdict["gap"].items() if g["noise_floor"] > 0.0}
    channel = max(gaps, key=gaps.get) if gaps else "-"
    shapes = [law["shape"] for law in verdict["laws"]] + [e["name"] for e in verdict["effects"]]
    result = {"folder": folder, "truth": truth, "verdict": verdict, "shapes": shapes, "ratio": gaps.get(channel, math.nan),
              "channel": channel, "seconds": time.time() - begun}
    for law in verdict["laws"]:
        if "exponent" in law["parameters"]:
            result["exponent"] = law["parameters"]["exponent"]
    return result


def narx_line(binaries, r):
    folder = r["folder"]
    cut, column = split_bench(folder)
    run(binaries / "rigtwin", "diagnose", "--rig", folder / "rig.toml", "--data", folder / "first.csv", "--out", folder / "part")
    rigtwin = binaries / "rigtwin"
    if not (folder / "part" / "rig.toml").exists():
        return None
    part = json.loads((folder / "part" / "verdict.json").read_text())
    size = len(part["parameters"]) + sum(len(e["parameters"]) for e in part["effects"]) + sum(
        max(len(law["parameters"]), 2 * len(law.get("branches", []))) for law in part["laws"])
    before = error_of(rigtwin, folder / "rig.toml", folder / "last.csv")
    after = error_of(rigtwin, folder / "part" / "rig.toml", folder / "last.csv")
    x = column["x_act"]
    return before, after, narx_error(x, column["F"], cut, 8), narx_error(x, column["F"], cut, 18), size


def main():
    binaries = pathlib.Path(sys.argv[1])
    seed = int(sys.argv[2])
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    kinds = sys.argv[4:] or ["component_bench", "hil", "quarter_car"]
    groups = run(binaries / "rigtwin_truth", "--groups").stdout.split()
    tally = {"memoryless": [0, 0], "shape": [0, 0], "exponent": [0, 0], "memory": [0, 0], "hysteresis": [0, 0], "false laws": [0, 0]}

    def score(name, right):
        tally[name][0] += bool(right)
        tally[name][1] += 1

    print(f"seeds {seed} … {seed + count - 1}, 30 s a recording")
    print(f"{'law':44} {'verdict':15} {'error/floor':>12} {'s':>5}  found")
    for group in groups:
        parts = group.split(":")
        if parts[0] not in ("law", "none", "single") or parts[1] not in kinds:
            continue
        for s in range(seed, seed + count):
            if parts[0] == "single" and (hash_of(group) + s) % 4:
                continue  # a quarter of the single effects
            r = one(binaries, group, s)
            if "failure" in r:
                print(f"{group}:{s}  {r['failure']}", flush=True)
                continue
            if parts[0] != "law":
                score("false laws", bool(r["verdict"]["laws"]))
                if r["verdict"]["laws"]:
                    print(f"{group + ':' + str(s):44} {r['verdict']['verdict']:15} {r['ratio']:8.2f} {r['channel']:>4}  {r['seconds']:4.0f}  {', '.join(r['shapes'])}", flush=True)
                continue
            name = parts[2]
            more = ""
            right = bool(set(r["shapes"]) & RIGHT.get(name, set()))
            if name in MEMORY:
                score("memory", r["ratio"] <= FLOOR_MEMORY)
                score("hysteresis", right)
            else:
                score("memoryless", r["ratio"] <= FLOOR)
                score("shape", right)
            if "power_law" in name or name == "cubic_damping":
                true = r["truth"]["unknown"]["spec"].get("exponent", 3.0)
                found = r.get("exponent")
                score("exponent", found and abs(found["value"] - true) <= EXPONENT)
                if found:
                    more = f"  exponent {found['value']:.3f} [{found['ci95'][0]:.3f}, {found['ci95'][1]:.3f}], true {true:.3f}"
            if parts[1] == "component_bench" and s == seed:
                line = narx_line(binaries, r)
                if line:
                    more += "  last quarter: before {:.4f}, found {:.4f}, NARX of 8 {:.4f}, of 18 {:.4f} ({} numbers found)".format(*line)
            print(f"{group + ':' + str(s):44} {r['verdict']['verdict']:15} {r['ratio']:8.2f} {r['channel']:>4}  {r['seconds']:4.0f}  {', '.join(r['shapes'])}{more}", flush=True)
    print()
    for name, (right, all_of) in tally.items():
        if all_of:
            print(f"{name:12} {right:3} of {all_of:3}  {100.0 * right / all_of:5.1f} %")


def hash_of(text):
    return sum(ord(c) for c in text)


main()
