#!/bin/bash
# broken.bash [SCENARIOS] -- by hand: breaks each safety function of tests/faults/broken/functions.txt in a copy of the control loop, and fails
# where the fault campaign (300 scenarios) notices less than 70 % of them, or finds something wrong with the sound loop. Takes two minutes of one
# core; its figures are in tests/golden/broken_functions.txt.
. "$(dirname "$0")/common.bash"
need perl g++
[ -d "$builds/host/third_party/eigen_headers" ] || skip "no host build (cmake --preset host)"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r firmware hal model tests "$folder"
mapfile -t names < <(perl tests/faults/broken/instrument.pl tests/faults/broken/functions.txt "$folder/firmware/loop" || echo FAILED)
[ "${names[-1]}" != FAILED ] || exit 1

flags=(-std=c++20 -O1 -w -ffp-contract=off -DEIGEN_DONT_VECTORIZE -I"$folder" -isystem "$builds/host/third_party/eigen_headers")
cat >"$folder/loop.cpp" < <(
  cd "$folder" && printf '#include "%s"\n' firmware/loop/*.cpp firmware/loop/*/*.cpp hal/sensor_source.cpp hal/simulated/*.cpp)
cat >"$folder/model.cpp" < <(cd "$folder" && printf '#include "%s"\n' model/*.cpp)
for part in loop model tests/faults/broken/main; do
  g++ "${flags[@]}" -c "$folder/$part.cpp" -o "$folder/$(basename "$part").o"
done
g++ "$folder"/{main,loop,model}.o -lgtest -lpthread -o "$folder/broken"
"$folder/broken" "${1:-300}" "${names[@]}"
