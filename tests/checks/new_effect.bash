#!/bin/bash
# new_effect.bash -- a new effect is one new file and one entry in the list of effects. The example of model/README.md is added to a
# copy of the tree; simulate, stability, diagnose and rig_controller then know it.
. "$(dirname "$0")/common.bash"
need g++
folder=$builds/new_effect
tree=$folder/tree

# Same times as here: only what depends on the list is compiled again.
rm -rf "$tree"
mkdir -p "$tree"
tar --exclude=node_modules -cf - CMakeLists.txt CMakePresets.json LICENSE NOTICE README.md model hal firmware host_sim tests toolchains |
  tar -C "$tree" -xf -
ln -s "$PWD/host_sim/report/node_modules" "$tree/host_sim/report/node_modules"

effect=$tree/model/effects/helper_spring.hpp
list=$tree/model/effects/catalogue.hpp
sed -n '/^ *```cpp$/,/^ *```$/p' model/README.md | sed '/```/d; s/^   //' >"$effect"
grep -q '^struct HelperSpring {$' "$effect" || { echo "model/README.md shows no struct HelperSpring"; exit 1; }
sed -i -e '/^#include "model\/effects\/force_sensor_inertia.hpp"$/a #include "model/effects/helper_spring.hpp"' \
  -e 's|^\( *\)ViscousDamping<S>,.*|&\n\1HelperSpring<S>,|' "$list"
touch -r model/README.md "$effect" "$list"
changed=$({ LC_ALL=C diff -rq --exclude=node_modules . "$tree" || true; } | grep -v '^Only in \.:' | sed "s|$tree/||g" | LC_ALL=C sort)
expected="Files ./model/effects/catalogue.hpp and model/effects/catalogue.hpp differ
Only in model/effects: helper_spring.hpp"
if [ "$changed" != "$expected" ] || [ "$(diff model/effects/catalogue.hpp "$list" | grep -c '^[<>]')" != 2 ]; then
  echo "$changed"
  echo "  ^ more or less than one new file and one entry of two lines"
  exit 1
fi

cmake -S "$tree" -B "$folder/build" -G Ninja -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG" \
  -DCMAKE_UNITY_BUILD=ON -DBUILD_TESTING=OFF >"$folder/log" ||
  { cat "$folder/log"; exit 1; }
cmake --build "$folder/build" --parallel "$jobs" --target rigtwin rig_controller >"$folder/log" || { tail -n 50 "$folder/log"; exit 1; }
rigtwin=$folder/build/bin/rigtwin
controller=$folder/build/bin/rig_controller

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp host_sim/rigs/paper_hil_fdva.toml "$work/without.toml"
cat "$work/without.toml" - >"$work/with.toml" <<'END'
[effects.helper_spring]
stiffness = 30e3
onset = 2e-3
END

# complain FILE TEXT…: what was expected of a command, and its output.
complain() {
  local file=$1
  shift
  tail -n 20 "$file"
  echo "  ^ $*"
  exit 1
}
# verdict FOLDER RIG RECORDING: diagnose, and print its verdict in one line.
verdict() {
  "$rigtwin" diagnose --rig "$2" --data "$3" --out "$1" >"$work/diagnose.txt" 2>&1 || complain "$work/diagnose.txt" "diagnose fails"
  tr -d ' \n' <"$1/verdict.json"
}

"$rigtwin" diagnose --explain helper_spring | grep 'stiffness · max(0, dz_b − onset)'

"$rigtwin" simulate --rig "$work/with.toml" --road iso8608:C --duration 20 --out "$work/run.csv" >"$work/simulate.txt" 2>&1 ||
  complain "$work/simulate.txt" "simulate fails"

"$rigtwin" stability --rig "$work/with.toml" --json "$work/stability.json" >"$work/stability.txt" 2>&1 ||
  complain "$work/stability.txt" "stability fails"
tr -d ' \n' <"$work/stability.json" | grep -o '"left_out":\[[^]]*"helper_spring"' ||
  complain "$work/stability.json" "stability does not say that it leaves the effect out"

without=$(verdict "$work/without" "$work/without.toml" "$work/run.csv")
grep -o '"verdict":"named"' <<<"$without" || complain "$work/diagnose.txt" "diagnose names nothing"
grep -o '"effects":\[{"name":"helper_spring"' <<<"$without" || complain "$work/diagnose.txt" "diagnose names another effect"

"$controller" --rig "$work/with.toml" --simulated --virtual-time --road iso8608:B --duration 20 --out "$work/controller.csv" \
  >"$work/controller.txt" 2>&1 || complain "$work/controller.txt" "rig_controller fails"
with=$(verdict "$work/with" "$work/with.toml" "$work/controller.csv")
grep -o '"verdict":"no_discrepancy"' <<<"$with" || complain "$work/diagnose.txt" "the controller's rig is another one"
