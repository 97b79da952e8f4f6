#!/bin/bash
# same_bits.bash REFERENCE PRESET [EMULATOR…] -- the trace program built by PRESET prints what the program REFERENCE prints.
# Of several names for the emulator the first one found is used.
. "$(dirname "$0")/common.bash"
reference=$1
preset=$2
shift 2

case $preset in
  aarch64) need aarch64-linux-gnu-g++ ;;
  armhf) need arm-linux-gnueabihf-g++ ;;
  *clang*) need clang++ ;;
esac
emulator=
for name; do
  if command -v "$name" >/dev/null; then
    emulator=$name
    break
  fi
done
[ $# -eq 0 ] || [ -n "$emulator" ] || skip "$1 is missing (toolchains/setup checks installs it)"

build "$preset" rigtwin_trace
expected=$("$reference")
actual=$($emulator "$builds/$preset/bin/rigtwin_trace")
[ -n "$expected" ] || { echo "$reference prints nothing"; exit 1; }
if [ "$actual" != "$expected" ]; then
  echo "The trace differs between $reference (<) and $builds/$preset/bin/rigtwin_trace (>):"
  diff <(echo "$expected") <(echo "$actual")
fi
echo "$actual"
