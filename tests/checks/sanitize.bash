#!/bin/bash
# Everything builds with clang++, whose warnings differ from g++'s; every test passes under the address and
# undefined-behaviour sanitizers, whose first finding ends it.
. "$(dirname "$0")/common.bash"
need clang++
build sanitize all rigtwin_for_checks

export ASAN_OPTIONS=halt_on_error=1:strict_string_checks=1:detect_stack_use_after_return=1
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
# Minutes of arithmetic that other tests go through as well: whole diagnoses but a few, whole transfers, the manual, the truth generator against itself and in series, the
# paper's two-minute runs but one, an hour of a rig.
export LEFT_OUT='-TruthGroups.*:TruthSimulation.*:Diagnosis.Names*:Diagnosis.Learns*:StackFit.Diagnosis*:Diagnosis.FindsANegative*:Diagnosis.IsLess*:Diagnosis.Reads*:Diagnosis.Weighs*:DiagnosisAtAnyRate.*:DiagnosisWithoutRoad.*:RecordingFaults.ASecond*:RecordingFaults.TheInputs*:SuspectParameters.Stand*:LawConstancy.Doubts*:LearnLaws.names*:Classics.*:Search.*:SelectModel.*:UnitCheck.AreNotSeen*:ParityResidual.PointsAt*:Paper.*:EnergyGuardJourney.LetsAnHour*:TransferCommand.*:TransferCalibration.*:Manual.*:ManualPictures.*:AirSpringDiagnosis.*:SwitchedDuctsDiagnosis.*:MethodComparison.*:EstimateCommand.*:CompensationCommand.*'

# A suite stays in one process, for what its tests share; suites that take long begin first, each by itself, the others a score at a time.
export RUN="$builds/sanitize/bin/rigtwin_tests" GTEST_BRIEF=1
long='StabilityReport|PaperCommand|Kinds/RoundTrip|RecordingMat|DiagnoseCommand|ModelAgainstReference|Model/EveryRig|ParityResidual|Nyquist|Refit'
logs="$builds/sanitize/suites"
rm -rf "$logs"
mkdir -p "$logs"
suites=$(GTEST_FILTER=$LEFT_OUT "$RUN" --gtest_list_tests | sed -n 's/^\([^ #]*\.\).*$/\1*/p')
status=0
{
  grep -E "^($long)\." <<<"$suites"
  grep -vE "^($long)\." <<<"$suites" | xargs -n 20 | tr ' ' ':'
} | cat -n | LOGS=$logs xargs -P "$(nproc)" -L 1 bash -c 'GTEST_FILTER="$1$LEFT_OUT" "$RUN" >"$LOGS/$0.log" 2>&1' || status=1
for log in $(ls "$logs" | sort -n); do cat "$logs/$log"; done
listed=$(GTEST_FILTER=$LEFT_OUT "$RUN" --gtest_list_tests | grep -c '^  ')
ran=$(awk '/^\[==========\] [0-9]+ tests? .*ran\./ { sum += $2 } END { print sum + 0 }' "$logs"/*.log)
echo "$ran of $listed tests ran under the sanitizers"
[ "$ran" -eq "$listed" ] || status=1
exit $status
