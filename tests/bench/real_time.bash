#!/bin/bash
# real_time.bash [SECONDS [PRIORITY]]
# real_time.bash --hour [SECONDS [PRIORITY]]
#
# By hand. The first form: what the loop of rig_controller takes on this machine, beside a rival that does as much
# work after as long a sleep (rigtwin_rival), and its wake-up latency beside that of cyclictest (package rt-tests): all in turn, several
# times within the same minutes, with the same priority, and the median of the rounds. With real-time rights where this machine grants
# them, and says so where not. Wanted: step time at most 5 us at P99.9, wake-up latency at most 1.2 times cyclictest's at P99. The
# loop is measured as it comes, warming the caches before each period, and without ([controller] wake_early = 0). Where a host takes
# the CPU away, P99.9 is the host's: so it is counted, too, how often that many nanoseconds of reading the clock take 5 us. Nothing
# fails: a busy machine is no fault of the program.
#
# --hour: one run of an hour (SECONDS: less, for a try) under load, with cyclictest in the same hour on another CPU where there is one. The
# load: on every CPU a program that never waits, one that writes to the disk, and one that starts processes, all with the lowest priority, beside
# whatever else the machine does. Periods so late that they would end a run are counted and do not end it. What was measured is published in
# tests/golden/real_time_hour.txt, machine and rights first; the histograms stand there as cyclictest writes them. Thirty seconds say nothing of what happens once in ten minutes.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
hour=
if [ "${1:-}" = --hour ]; then
  hour=yes
  shift
  set -- "${1:-3600}" "${2:-80}"
fi
seconds=${1:-30}
priority=${2:-80}
rounds=5
each=$((seconds / rounds > 0 ? seconds / rounds : 1))
program=build/host/bin/rig_controller
rival=build/host/bin/rigtwin_rival
for file in $program ${hour:-$rival}; do
  [ "$file" != yes ] || continue
  [ -x "$file" ] || { echo "$file is missing: cmake --preset host && cmake --build build/host --target $(basename $file)"; exit 1; }
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

ulimit -l unlimited 2>/dev/null || true
rights="with real-time rights"
how=()
before=()
as_cyclictest=(-m "-p$priority")
describe() { # RIG LINE… -- a rig description with more in [controller]
  { cat "host_sim/rigs/$1.toml"; printf '\n[controller]\npriority = %s\nlate_in_a_row = 1000000\n' "$priority"; shift; printf '%s\n' "$@"; }
}
describe paper_hil_fdva >"$folder/warmed.toml"
describe paper_hil_fdva "wake_early = 0" >"$folder/plain.toml"
describe paper_rig_fdva >"$folder/quarter_car.toml"
# The hour is to be measured whole: periods so late that they would end a run (10 ms) are counted in the histogram instead.
describe paper_hil_fdva "" "[supervision]" "gap = 1" >"$folder/whole.toml"
if "$program" --rig "$folder/plain.toml" --simulated --duration 0.1 --out /dev/null 2>&1 | grep -q 'refused: no real-time rights'; then
  how=(--no-realtime)
  if chrt -f "$priority" true 2>/dev/null; then
    rights="SCHED_FIFO by chrt, memory NOT LOCKED: this machine does not grant it; no warm-up"
    before=(chrt -f "$priority")
    as_cyclictest=("-p$priority")
  else
    rights="WITHOUT real-time rights, which this machine does not grant: the figures are those of an ordinary program; no warm-up"
    as_cyclictest=()
  fi
fi
# Everything that this machine can be kept busy with, until the folder is removed.
keep_busy() {
  for _ in $(seq "$(nproc)"); do
    nice -n 19 sh -c 'while [ -d "$0" ]; do i=0; while [ $i -lt 100000 ]; do i=$((i + 1)); done; done' "$folder" &
  done
  nice -n 19 sh -c 'while [ -d "$0" ]; do dd if=/dev/zero of="$0/load" bs=1M count=64 conv=fsync 2>/dev/null || exit 0; done' "$folder" &
  nice -n 19 sh -c 'while [ -d "$0" ]; do ls "$0" >/dev/null 2>&1; done' "$folder" &
}

if [ -n "$hour" ]; then
  keep_busy
  theirs=
  if command -v cyclictest >/dev/null; then
    last=$(($(nproc) - 1))
    cyclictest -q -t1 -a$last -i1000 -l$((seconds * 1000)) -h100000 "${as_cyclictest[@]}" >"$folder/cyclictest" 2>&1 &
    theirs=$!
  fi
  status=0
  "${before[@]}" "$program" --rig "$folder/whole.toml" --simulated --cycles 0 --duration 60 --out /dev/null --histogram "$folder/hour.us" \
    "${how[@]}" >"$folder/hour" 2>&1 &
  ours=$!
  sleep "$seconds"
  kill -TERM $ours || true
  wait $ours || status=$?
  [ $status -eq 0 ] || [ $status -eq 7 ] || { cat "$folder/hour"; exit $status; }  # 7: a safe stop, which is published too
  [ -z "$theirs" ] || wait "$theirs" || true
  published=${RIGTWIN_PUBLISHED:-tests/golden/real_time_hour.txt}
  {
    echo "# tests/bench/real_time.bash --hour: $seconds s under load, $(date -u +%Y-%m-%d)"
    echo "# $rights"
    echo "# Linux $(uname -r) $(uname -m), $(nproc) CPUs,$(sed -n 's/^model name[^:]*://p' /proc/cpuinfo | head -n 1)"
    grep -E 'wake-up latency|step time|sample age|late periods|ended by' "$folder/hour" | sed 's/^/#/'
    echo "# rig_controller: us, periods by wake-up latency, by step time, by age of samples"
    cat "$folder/hour.us"
    if [ -s "$folder/cyclictest" ]; then
      echo "# cyclictest in the same time: us, wake-ups"
      awk '/^[0-9]/ { if ($2 + 0 > 0) print $1, $2 + 0 } /^#/' "$folder/cyclictest"
    else
      echo "# cyclictest is missing (package rt-tests): no comparison"
    fi
  } >"$folder/published"
  cp "$folder/published" "$published"
  grep '^#' "$published" | head -n 8
  echo "published in $published"
  exit 0
fi
echo "$rights; $(uname -r), $(nproc) CPUs, load $(cut -d' ' -f1 /proc/loadavg); $rounds rounds of $each s each"

quantile() { # FILE LINE NAME -- that quantile of a line of a histogram
  awk -v line="$2" -v name="$3:" 'index($0, "  " line " ") == 1 { for (i = 1; i < NF; ++i) if ($i == name) print $(i + 1) }' "$1"
}
median() { sort -g "$folder/$1" | awk '{ v[NR] = $1 } END { print NR ? v[int((NR + 1) / 2)] : "nan" }'; }
note() { # FILE LINE KEY -- P50, P99 and P99.9 of a line into the lists of KEY
  for q in P50 P99 P99.9; do quantile "$1" "$2" $q >>"$folder/$3.$q"; done
}
for round in $(seq $rounds); do
  for rig in warmed plain quarter_car; do
    status=0
    "${before[@]}" "$program" --rig "$folder/$rig.toml" --simulated --duration "$each" --out /dev/null --overwrite --histogram "$folder/$rig.us" \
      "${how[@]}" >"$folder/$rig" 2>&1 ||
      status=$?
    [ $status -eq 0 ] || { cat "$folder/$rig"; exit $status; }
    note "$folder/$rig" "step time" "$rig"
    note "$folder/$rig" "wake-up latency" "$rig.wake"
  done
  awk '/^[0-9]/ { all += $3; if ($1 >= 5) beyond += $3 } END { print beyond + 0, all }' "$folder/warmed.us" >>"$folder/beyond.loop"
  window=$(quantile "$folder/warmed" "step time" P50 | awk '{ print int($1 * 1000) }')
  "${before[@]}" "$rival" "$each" $([ ${#how[@]} -gt 0 ] && echo 0 || echo "$priority") "$window" >"$folder/rival"
  awk '/nothing took/ { print $(NF - 2), $NF }' "$folder/rival" >>"$folder/beyond.nothing"
  note "$folder/rival" "rival" rival
  note "$folder/rival" "rival, warmed" rival_warmed
  note "$folder/rival" nothing nothing
  if command -v cyclictest >/dev/null &&
    cyclictest -q -t1 -i1000 -l$((each * 1000)) -h100000 "${as_cyclictest[@]}" >"$folder/cyclictest"; then
    awk '/^[0-9]/ { n[NR] = $2; at[NR] = $1; all += $2; last = NR } END { for (i = 1; i <= last; ++i) if ((seen += n[i]) >= 0.99 * all) { print at[i] + 0; exit } }' \
      "$folder/cyclictest" >>"$folder/cyclictest.P99"
  fi
  echo "round $round: step time P99.9 warmed $(tail -n 1 "$folder/warmed.P99.9"), plain $(tail -n 1 "$folder/plain.P99.9"), rival $(tail -n 1 "$folder/rival.P99.9"), nothing $(tail -n 1 "$folder/nothing.P99.9") us"
done
row() { printf '  %-44s %6.1f %6.1f %6.1f\n' "$1" "$(median "$2.P50")" "$(median "$2.P99")" "$(median "$2.P99.9")"; }
echo "medians of the rounds, us:                        P50    P99  P99.9"
row "hil, simulated back-end: step time" warmed
row "hil, not warmed" plain
row "quarter_car, simulated back-end: step time" quarter_car
row "rival, after its sleep" rival
row "rival, warmed" rival_warmed
row "nothing, as long as the loop's median" nothing
awk -v a="$(median warmed.P99.9)" -v b="$(median plain.P99.9)" -v c="$(median rival.P99.9)" 'BEGIN {
  printf "loop overhead P99.9: %.1f us, %.2f times that of the rival after its sleep (not warmed: %.2f times); wanted 5 us at most: %s\n",
         a, a / c, b / c, (a <= 5 ? "kept" : "NOT KEPT here") }'
share() { awk '{ a += $1; b += $2 } END { print a / b }' "$folder/beyond.$1"; }
awk -v loop="$(share loop)" -v nothing="$(share nothing)" 'BEGIN {
  own = (loop - nothing) / (1 - nothing)
  printf "5 us or longer: the loop %.3f %% of its periods, nothing at all %.3f %%; of the loop\047s own %.3f %%, wanted 0.1 at most: %s\n",
         100 * loop, 100 * nothing, 100 * own, (own <= 0.001 ? "kept" : "NOT KEPT here") }'
[ -s "$folder/cyclictest.P99" ] || { echo "cyclictest is missing (package rt-tests) or failed: no comparison"; exit 0; }
awk -v ours="$(median warmed.wake.P99)" -v theirs="$(median cyclictest.P99)" 'BEGIN {
  printf "wake-up latency P99: rig_controller %.1f us, cyclictest %.1f us (whole ones), ratio %.2f, wanted 1.2 at most\n",
         ours, theirs, (theirs > 0 ? ours / theirs : 0) }'
