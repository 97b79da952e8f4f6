#!/bin/bash
# real_time.bash [SECONDS [PRIORITY]] -- by hand: what the loop of rig_controller takes on this machine, and its wake-up latency beside
# that of cyclictest (package rt-tests) in the same minute with the same priority. With real-time rights where this machine
# grants them, and says so where not. Wanted: step time at most 5 us at P99.9, wake-up latency at most 1.2 times cyclictest's at
# P99. The simulated rig moves between waking up and looking at the clock: its few microseconds count against rig_controller here,
# not in the guest. Nothing fails: a busy machine is no fault of the program.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seconds=${1:-20}
priority=${2:-80}
program=build/host/bin/rig_controller
[ -x "$program" ] || { echo "$program is missing: cmake --preset host && cmake --build build/host --target rig_controller"; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

ulimit -l unlimited 2>/dev/null || true
rights="with real-time rights"
how=()
before=()
as_cyclictest=(-m "-p$priority")
{ cat host_sim/rigs/paper_hil_fdva.toml; printf '\n[controller]\npriority = %s\n' "$priority"; } >"$folder/rights.toml"
if "$program" --rig "$folder/rights.toml" --simulated --duration 0.1 --out /dev/null 2>&1 | grep -q 'refused: no real-time rights'; then
  how=(--no-realtime)
  if chrt -f "$priority" true 2>/dev/null; then
    rights="SCHED_FIFO by chrt, memory NOT LOCKED: this machine does not grant it"
    before=(chrt -f "$priority")
    as_cyclictest=("-p$priority")
  else
    rights="WITHOUT real-time rights, which this machine does not grant: the figures are those of an ordinary program"
    as_cyclictest=()
  fi
fi
echo "$rights; $(uname -r), $(nproc) CPUs, load $(cut -d' ' -f1 /proc/loadavg)"
for rig in paper_hil_fdva paper_rig_fdva; do
  { cat "host_sim/rigs/$rig.toml"; printf '\n[controller]\npriority = %s\nlate_in_a_row = 1000000\n' "$priority"; } >"$folder/$rig.toml"
  status=0
  "${before[@]}" "$program" --rig "$folder/$rig.toml" --simulated --duration "$seconds" --out /dev/null "${how[@]}" >"$folder/$rig" 2>&1 || status=$?
  [ $status -eq 0 ] || { cat "$folder/$rig"; exit $status; }
  echo "$rig, simulated back-end"
  grep -E 'wake-up latency|step time|late periods' "$folder/$rig"
done
step=$(sed -n 's/.*step time .*P99\.9: *\([0-9.]*\) .*/\1/p' "$folder/paper_hil_fdva")
ours=$(sed -n 's/.*wake-up latency .*P99: *\([0-9.]*\) .*/\1/p' "$folder/paper_hil_fdva")
awk -v step="$step" 'BEGIN { printf "loop overhead P99.9: %.1f us, wanted 5 us at most: %s\n", step, (step <= 5 ? "kept" : "NOT KEPT here") }'
command -v cyclictest >/dev/null || { echo "cyclictest is missing (package rt-tests): no comparison"; exit 0; }
cyclictest -q -t1 -i1000 -l$((seconds * 1000)) -h100000 "${as_cyclictest[@]}" >"$folder/cyclictest" ||
  { echo "cyclictest ended with status $?: no comparison"; exit 0; }
theirs=$(awk '/^[0-9]/ { n[NR] = $2; at[NR] = $1; all += $2; last = NR } END { for (i = 1; i <= last; ++i) if ((seen += n[i]) >= 0.99 * all) { print at[i] + 0; exit } }' "$folder/cyclictest")
awk -v ours="$ours" -v theirs="$theirs" 'BEGIN { printf "wake-up latency P99: rig_controller %.1f us, cyclictest %.1f us (whole ones), ratio %.2f, wanted 1.2 at most\n", ours, theirs, (theirs > 0 ? ours / theirs : 0) }'
