#!/bin/bash
# new_effect.bash RIGTWIN -- a new effect is one new file, its test, and one entry in the list of effects. `rigtwin new-effect` adds the
# example of model/README.md to a copy of the tree; its test passes, and simulate, stability, diagnose and rig_controller then know it.
. "$(dirname "$0")/common.bash"
made_by=$1
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
test=$tree/tests/model/effects/helper_spring_test.cpp
list=$tree/model/effects/catalogue.hpp
"$made_by" new-effect helper_spring --tree "$tree"
# What model/README.md shows is what the command writes.
diff <(sed -n '/^ *```cpp$/,/^ *```$/p' model/README.md | sed '/```/d; s/^   //') "$effect" ||
  { echo "  ^ model/README.md (<) and rigtwin new-effect (>) differ"; exit 1; }
if command -v clang-format >/dev/null && clang-format --version | grep -q 'version 14'; then
  clang-format --dry-run -Werror "$effect" "$test" "$list"
fi
touch -r model/README.md "$effect" "$test" "$list"
changed=$({ LC_ALL=C diff -rq --exclude=node_modules . "$tree" || true; } | grep -v '^Only in \.:' | sed "s|$tree/||g" | LC_ALL=C sort)
expected="Files ./model/effects/catalogue.hpp and model/effects/catalogue.hpp differ
Only in model/effects: helper_spring.hpp
Only in tests/model/effects: helper_spring_test.cpp"
if [ "$changed" != "$expected" ] || [ "$(diff model/effects/catalogue.hpp "$list" | grep -c '^[<>]')" != 2 ]; then
  echo "$changed"
  echo "  ^ more or less than two new files and one entry of two lines"
  exit 1
fi
if "$made_by" new-effect helper_spring --tree "$tree" 2>"$folder/again" || ! grep -q 'is there already' "$folder/again"; then
  echo "the second new-effect of that name is not refused"
  exit 1
fi

cmake -S "$tree" -B "$folder/build" -G Ninja -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG" \
  -DCMAKE_UNITY_BUILD=ON -DBUILD_TESTING=OFF -DRIGTWIN_LANES=1 >"$folder/log" ||
  { cat "$folder/log"; exit 1; }
cmake --build "$folder/build" --parallel "$jobs" --target rigtwin rig_controller >"$folder/log" || { tail -n 50 "$folder/log"; exit 1; }
rigtwin=$folder/build/bin/rigtwin
# The test by itself: the program of all tests would take as long as everything else here.
g++ -std=c++20 -O1 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -ffp-contract=off -DEIGEN_DONT_VECTORIZE -I"$folder/build/rooms/model" \
  -isystem "$folder/build/third_party/eigen_headers" "$test" "$folder/build/model/libmodel.a" -lgtest -lgtest_main -pthread -o "$folder/its_test"
"$folder/its_test" --gtest_brief=1
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

"$rigtwin" simulate --rig "$work/with.toml" --road iso8608:C --duration 12 --out "$work/run.csv" >"$work/simulate.txt" 2>&1 ||
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
