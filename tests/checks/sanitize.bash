#!/bin/bash
# Everything builds with clang++, whose warnings differ from g++'s; every test passes under the address and
# undefined-behaviour sanitizers, whose first finding ends it.
. "$(dirname "$0")/common.bash"
need clang++
build sanitize all

export ASAN_OPTIONS=halt_on_error=1:strict_string_checks=1:detect_stack_use_after_return=1
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
export GTEST_TOTAL_SHARDS GTEST_BRIEF=1
GTEST_TOTAL_SHARDS=$(nproc)
# Minutes of arithmetic that other tests go through as well: whole diagnoses but two, the truth generator against itself and in series, the
# paper's two-minute runs but one, an hour of a rig.
export GTEST_FILTER='-TruthGroups.*:TruthSimulation.*:Diagnosis.Names*:Diagnosis.FindsANegative*:Diagnosis.IsLess*:Search.*:Slips.AreNotSeen*:Redundancy.PointsAt*:Paper.*:EnergyGuardJourney.LetsAnHour*'
running=()
for ((i = 0; i < GTEST_TOTAL_SHARDS; ++i)); do
  GTEST_SHARD_INDEX=$i "$builds/sanitize/bin/rigtwin_tests" >"$builds/sanitize/shard_$i.log" 2>&1 &
  running+=($!)
done
status=0
for ((i = 0; i < GTEST_TOTAL_SHARDS; ++i)); do
  wait "${running[i]}" || status=1
  cat "$builds/sanitize/shard_$i.log"
done
exit $status
