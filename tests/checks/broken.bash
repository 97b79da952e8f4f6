#!/bin/bash
# broken.bash [SCENARIOS] -- by hand: breaks each safety function of tests/faults/broken/functions.txt in a copy of the control loop and its
# description, and fails where their tests notice less than 95 % of them, or the fault campaign (300 scenarios) less than 70 %, or where either finds something
# wrong with the sound loop. Its figures are in tests/golden/broken_functions.txt.
. "$(dirname "$0")/common.bash"
need perl g++
[ -d "$builds/host/third_party/eigen_headers" ] || skip "no host build (cmake --preset host)"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r firmware hal model tests "$folder"
mapfile -t names < <(perl tests/faults/broken/instrument.pl tests/faults/broken/functions.txt "$folder" || echo FAILED)
[ "${names[-1]}" != FAILED ] || exit 1

builds=$(realpath "$builds")
compiler=(g++)
if command -v ccache >/dev/null; then compiler=(ccache g++); fi
flags=(-std=c++20 -O1 -w -ffp-contract=off -DEIGEN_DONT_VECTORIZE -isystem "$builds/host/third_party/eigen_headers" -I. "-I$builds/host/generated"
  "-DRIGTWIN_SOURCE_DIR=\"$PWD\"")
# unit NAME FILE… -- one text of several sources.
unit() {
  printf '#include "%s"\n' "${@:2}" >"$folder/$1.cpp"
  echo "$1"
}
cd "$folder"
mapfile -t units < <(
  unit loop firmware/loop/*.cpp firmware/loop/*/*.cpp hal/sensor_source.cpp hal/simulated/*.cpp hal/replay/*.cpp
  unit model model/*/*.cpp
  unit heap tests/support/without_heap.cpp
  for inner in . laws table text values; do
    unit "description_${inner/./whole}" "firmware/description/$inner"/*.cpp
  done
  unit campaign tests/faults/broken/main.cpp
  unit tests tests/faults/broken/tests_main.cpp
  for inner in tests/firmware/loop tests/firmware/loop/{common,compensation,guards,reference}; do
    unit "tests_$(basename "$inner")" "${inner%/}"/*_test.cpp
  done
  unit tests_description tests/firmware/description/{rig_description,wide_limits,loop_proof}_test.cpp)
printf '%s\n' "${units[@]}" | xargs -P2 -I{} "${compiler[@]}" "${flags[@]}" -c {}.cpp -o {}.o
g++ campaign.o loop.o model.o -lgtest -lpthread -o campaign
g++ tests.o tests_*.o description_*.o heap.o loop.o model.o -lgmock -lgtest -lpthread -o broken_tests
cd - >/dev/null

# by_tests NUMBER NAME -- "NAME TEST": the first test that fails, or "not noticed".
by_tests() {
  local said test status=0
  said=$(timeout 300 "$folder/broken_tests" "$1" --gtest_fail_fast --gtest_brief=1 2>&1) || status=$?
  test=$(grep -om1 '^\[  FAILED  \] [^ ,]*' <<<"$said" | cut -d' ' -f6) || true
  [ $status = 0 ] && test='not noticed'
  printf '%s %s\n' "$2" "${test:-ended with $status}"
}
export -f by_tests
export folder
if [ "$(by_tests 0 sound)" != 'sound not noticed' ]; then
  echo 'a test of the sound loop fails'
  exit 1
fi
for i in "${!names[@]}"; do echo "$((i + 1)) ${names[$i]}"; done | xargs -P2 -L1 bash -c 'by_tests $0 $1' >"$folder/by_tests"
status=0
campaign=$("$folder/campaign" "${1:-300}" "${names[@]}") || status=$?
missed=0
for name in "${names[@]}"; do
  test=$(awk -v name="$name" '$1 == name { print substr($0, length(name) + 2) }' "$folder/by_tests")
  [ "$test" != 'not noticed' ] || missed=$((missed + 1))
  printf '%-52s %-60s %s\n' "$name" "$test" "$(awk -v name="$name" '$1 == name { $1 = ""; print substr($0, 2) }' <<<"$campaign")"
done
echo "$((${#names[@]} - missed)) of ${#names[@]} noticed by tests"
tail -1 <<<"$campaign"
[ $((missed * 20)) -le ${#names[@]} ] || status=1
exit $status
