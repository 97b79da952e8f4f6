#!/bin/bash
# Product, tests and fuzzers build with clang++, whose warnings differ from g++'s; the tests pass under the address and undefined-behaviour
# sanitizers, whose first finding ends them.
. "$(dirname "$0")/common.bash"
need clang++
build sanitize all

export ASAN_OPTIONS=halt_on_error=1:strict_string_checks=1:detect_stack_use_after_return=1
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
# Minutes of arithmetic: what takes more than a second without sanitizers or ten with them, and whose code a shorter test or a fuzzer (fuzz.diagnose: whole
# diagnoses) goes through as well.
export LEFT_OUT='-TruthGroups.*:TruthSimulation.*:Diagnosis.Names*:Diagnosis.Learns*:StackFit.Diagnosis*:Diagnosis.FindsANegative*:Diagnosis.IsLess*:Diagnosis.Reads*:Diagnosis.Weighs*:DiagnosisAtAnyRate.*:DiagnosisWithoutRoad.*:RecordingFaults.ASecond*:RecordingFaults.TheInputs*:SuspectParameters.Stand*:LawConstancy.Doubts*:LearnLaws.*:Classics.*:Search.*:SelectModel.*:UnitCheck.AreNotSeen*:ParityResidual.PointsAt*:Paper.*:EnergyGuardJourney.LetsAnHour*:TransferCommand.*:TransferCalibration.*:Manual.*:ManualPictures.*:AirSpringDiagnosis.*:SwitchedDuctsDiagnosis.*:MethodComparison.*:EstimateCommand.*:CompensationCommand.*:RecordingFaults.A*:RecordingFaults.Damping*:RecordingFaults.Mains*:RecordingFaults.One*:SuspectParameters.A*:SuspectParameters.L*:SuspectParameters.N*:Plan.C*:Plan.F*:Plan.N*:Plan.S*:*RoundTrip.OfEveryEffectThroughEveryCommand/0:*RoundTrip.OfEveryEffectThroughEveryCommand/1:*RoundTrip.OfEveryEffectThroughEveryCommand/2:TransferPosterior.Is*:TransferPosterior.Draws*:TransferPrediction.AddsTheNoise*:TransferPrediction.C*:TransferPrediction.K*:TransferPrediction.Spreads*:TransferDiscrepancy.Widens*:Nyquist.*:PaperCommand.*:ModelAgainstReference.Follows*Delay:ModelAgainstReference.Follows*Friction:ModelAgainstReference.FollowsDucts*:ModelAgainstReference.FollowsAWheel*:StabilityReport.IsWhole*:ParityResidual.*:Questions/*:Calibration.*:Rths.*:DuctPolicy.Reaches*:DuctPolicy.Beats*:DuctPolicy.LosesLittle*:KalmanFilter.ReachesTheBounds*:KalmanFilter.FindsTheOffset*:Json.SaysThePaper:Refit.FitsReal*:Model/EveryRig.*SixtySeconds*:PlanCommand.*:HowMade.*:StabilityCommand.DecidesByTheCompensated*:Refit.SurvivesAbsurd*:CompensatedStability.Says*:CompensatedStability.Judges*:CompensatedStability.Margins*:Finite.VerdictOrOneLine*:SampledLoop.TendsTo*:StabilityMap.TakesAny*:CharacteristicRoots.AgreeWith*:UnitCheck.FindTheChannel*:HeldOut.TakesAway*:LawBand.Holds*:RecordingMat.SurvivesDamaged*:StabilityMap.IsExact*:SampledLoop.AddsHalf*:EnergyGuardJourney.LetsOther*:Uncertainty.HoldsTheTruth*:Rest.IsNotFound*'

# A suite stays in one process, for what its tests share; suites that take long begin first, each by itself, the others a score at a time.
export RUN="$builds/sanitize/bin/rigtwin_tests" GTEST_BRIEF=1
long='StabilityReport|RecordingMat|DiagnoseCommand|Refit|RigController'
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
