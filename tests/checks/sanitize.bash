#!/bin/bash
# Product, tests and fuzzers build with clang++, whose warnings differ from g++'s; the tests pass under the address and undefined-behaviour
# sanitizers, whose first finding ends them. Rigs are simulated four side by side at most: eight are the same template, which takes a minute to
# compile.
. "$(dirname "$0")/common.bash"
need clang++
build sanitize all

export ASAN_OPTIONS=halt_on_error=1:strict_string_checks=1:detect_stack_use_after_return=1
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
# Left out: eight rigs side by side, which are not built here; and tests that take more than a second without sanitizers or ten seconds with
# them, and whose code a shorter test or a fuzzer runs as well (fuzz.diagnose runs whole diagnoses).
LEFT_OUT=-$(xargs <<'END' | tr ' ' ':'
*RoundTrip.OfEveryEffectThroughEveryCommand/0 *RoundTrip.OfEveryEffectThroughEveryCommand/1 *RoundTrip.OfEveryEffectThroughEveryCommand/2
*RoundTrip.OfEveryEffectThroughEveryCommand/3
AirSpringDiagnosis.* Calibration.* CharacteristicRoots.AgreeWith* Classics.* CompensatedStability.Judges* CompensatedStability.Margins*
CompensatedStability.Says* CompensatedStability.MapOf* CompensationCommand.* DiagnoseCommand.ReadsTheEnds* Diagnosis.DoesNotJudge* Diagnosis.FindsANegative* Diagnosis.IsLess* Diagnosis.Learns* Diagnosis.Names* Diagnosis.Reads* Diagnosis.Refuses*
Diagnosis.SaysOfNo* Diagnosis.Weighs* DiagnosisAtAnyRate.* DiagnosisWithoutRoad.* DuctPolicy.Beats* DuctPolicy.LosesLittle* DuctPolicy.Reaches*
Backlash.IsStepped* Bounds.HoldTheTruth* EnergyGuardJourney.LetsAnHour* EnergyGuardJourney.LetsOther* EstimateCommand.* ExternalEvent.* Faults.AHundred* ForceGuard.EndsTheRun* Finite.Verdict* FirstSentence.Agrees* HeldOut.TakesAway* HowMade.* InnovationGuard.JudgesByTime* InnovationGuard.LeavesARight* InnovationGuard.Notices*
*SideBySide.*/Eight Lanes/SideBySide.RigsThatChangeKeepTheirBits/One Json.SaysThePaper KalmanFilter.FindsTheOffset* KalmanFilter.FollowsARoad* KalmanFilter.ReachesTheBounds* LawBand.Holds* LawConstancy.Doubts* LearnLaws.* *LiveDiagnosisOf.* LiveDiagnosis.B* LiveDiagnosis.D* LiveDiagnosis.G* LiveDiagnosis.N* LiveDiagnosis.S* LowerMinimum.IsFound* Manual.*
ManualPictures.* MethodComparison.* Model/EveryRig.*SixtySeconds* ModelAgainstReference.Follows*Delay ModelAgainstReference.Follows*Friction
ModelAgainstReference.FollowsAWheel* ModelAgainstReference.FollowsDucts* NonlinearLoop.IsCompensated NonlinearLoop.StepIs* Nyquist.* Pages.* PairsOfParts.* PairsOfPartsCommand.* Paper.* PaperCommand.* ParityResidual.* Plan.C* Plan.F* Plan.N* Plan.P*
Plan.S* Plan.W* PlanCommand.* Questions/* RecordingFaults.A* RecordingFaults.Damping* RecordingFaults.Delays* RecordingFaults.Hum* RecordingFaults.Mains* RecordingFaults.One*
RecordingFaults.TheInputs* RecordingFaults.WhatOnly* Reference.Names* Reference.Whitens* RecordingMat.SurvivesDamaged* Refit.FitsReal* Refit.SurvivesAbsurd* Replication.Inverts* Replication.StaysWithin* RivalParameters.* Rest.IsNot* Rths.* SampledLoop.AddsHalf*
SampledLoop.TendsTo* Search.* SearchApart.* SelectModel.* StabilityCommand.DecidesByTheCompensated* StabilityCommand.LimitsHold* StabilityMap.IsExact* StabilityMap.TakesAny*
StabilityReport.IsWhole* StackFit.Diagnosis* Sensitivity.IsTheChange* SuspectParameters.A* SuspectParameters.E* SuspectParameters.H* SuspectParameters.L* SuspectParameters.N* SuspectParameters.Stand* SuspectParameters.Take*
SwitchedDuctsDiagnosis.* TransferCalibration.* TransferCommand.* TransferDiscrepancy.Widens* TransferPosterior.Draws* TransferPosterior.Is* TransferPosterior.StaysAt*
NoiseSpectrum.FindsWhen* TransferPrediction.AddsTheNoise* TransferPrediction.C* TransferPrediction.K* TransferPrediction.Spreads* TruthGroups.* TruthRough.* TruthNeighbours.DifferentiateBy* TruthSimulation.*
Uncertainty.HoldsTheTruth* UncertaintyBudget.* UnitCheck.AreNotSeen* UnitCheck.FindTheChannel*
END
)
# And the rooms that compute: without optimisation they take minutes, and fuzz.diagnose runs them.
computing=$(grep -rhoE '^TEST(_F|_P)?\(\w+' tests/host_sim/{identification,comparison,transfer,plan,stability,compensation,replicate,paper,sweep,show,campaign} \
  tests/host_sim/commands tests/host_sim/manual tests/journeys | sed 's/.*(//; s/^/*/; s/$/.*/' | sort -u | tr '\n' ':')
LEFT_OUT+=:${computing%:}
export LEFT_OUT

# A suite stays in one process, for what its tests share; suites that take long begin first, each by itself, the others a score at a time.
export RUN="$builds/sanitize/bin/rigtwin_tests" GTEST_BRIEF=1
long='Lanes/SideBySide|Kinds/RoundTrip|StabilityReport|RecordingMat|DiagnoseCommand|Refit|RigController'
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
