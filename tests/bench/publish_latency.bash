#!/bin/bash
# publish_latency.bash [ROUNDS [SECONDS]] -- by hand: what --publish costs the loop of rig_controller on this machine. By turns, without
# it, with it while nobody listens, and with it while rigtwin watch does; from the controller's own histograms the median of the
# rounds. With real-time rights where this machine grants them. Nothing fails: a busy machine is no fault of the program.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
rounds=${1:-7}
seconds=${2:-10}
bin=build/host/bin
folder=$(mktemp -d)
server=
finish() {
  [ -z "$server" ] || kill "$server" 2>/dev/null || true
  rm -rf "$folder"
}
trap finish EXIT
{ cat host_sim/rigs/paper_hil_fdva.toml; printf '\n[controller]\nlate_in_a_row = 1000000\n[supervision]\ngap = 1.0\n'; } >"$folder/rig.toml"

how=()
if "$bin/rig_controller" --rig "$folder/rig.toml" --simulated --duration 0.1 --out /dev/null 2>&1 | grep -q 'no real-time rights'; then
  how=(--no-realtime)
fi
"$bin/rigtwin" watch --port 0 --receive 127.0.0.1:0 --socket "$folder/control" >"$folder/watch" &
server=$!
until grep -q requests "$folder/watch"; do sleep 0.1; done
watched=$(sed -n 's/.*UDP \(127.0.0.1:[0-9]*\) .*/\1/p' "$folder/watch")
# A page that watches, in place of a browser.
curl -sN "$(sed -n '1s|/?|/events?|p' "$folder/watch")" >/dev/null 2>&1 &

figure() { awk -v line="$2" -v name="$3:" 'index($0, "  " line " ") == 1 { for (i = 1; i < NF; ++i) if ($i == name) print $(i + 1) }' "$1"; }
measure() { # NAME OPTION… -- a run into the lists of NAME
  local name=$1 line quantile
  shift
  "$bin/rig_controller" --rig "$folder/rig.toml" --simulated --duration "$seconds" --out "$folder/run.csv" --overwrite "${how[@]}" "$@" \
    >"$folder/out" 2>&1 || { cat "$folder/out"; exit 1; }
  for line in "step time" "wake-up latency"; do
    for quantile in P50 P99 P99.9; do figure "$folder/out" "$line" "$quantile" >>"$folder/$name.$line.$quantile"; done
  done
  sed -n 's/.*lost to publishing \([0-9]*\)/\1/p' "$folder/out" >>"$folder/$name.lost"
}
for _ in $(seq "$rounds"); do
  measure without
  measure nobody --publish 127.0.0.1:9
  measure watched --publish "$watched"
done
median() { sort -g "$1" | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }
echo "${how[*]:-with real-time rights}, $(nproc) CPUs, load $(cut -d' ' -f1 /proc/loadavg); medians of $rounds rounds of $seconds s, us"
for line in "step time" "wake-up latency"; do
  for name in without nobody watched; do
    printf '  %-16s %-8s' "$line" "$name"
    for quantile in P50 P99 P99.9; do printf ' %8.1f' "$(median "$folder/$name.$line.$quantile")"; done
    printf '   rounds P99:'
    tr '\n' ' ' <"$folder/$name.$line.P99"
    echo
  done
done
echo "  lost to publishing: $(cat "$folder/nobody.lost" "$folder/watched.lost" | awk '{ n += $1 } END { print n + 0 }')"
