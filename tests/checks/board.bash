#!/bin/bash
# board.bash REFERENCE -- model and control loop on a Cortex-M7 (QEMU's mps2-an500, newlib) print the hashes that the program
# REFERENCE prints here; a period costs the instructions of tests/golden/cortex_m7.txt, within 5 %, and a small stack. Code and
# memory are held to their budget by the linker script.
. "$(dirname "$0")/common.bash"
reference=$1
need arm-none-eabi-g++
need qemu-system-arm
version=$(arm-none-eabi-g++ -dumpversion | cut -d. -f1)
most_stack=16384  # bytes, of the loop beyond its caller: the period that starts the virtual car is the deepest

build cortex-m7 rigtwin_board_trace
program=$builds/cortex-m7/bin/rigtwin_board_trace
arm-none-eabi-size "$program"
expected=$("$reference")
# -icount: time is counted in instructions, 64 ns each.
actual=$(timeout 100 qemu-system-arm -M mps2-an500 -nographic -monitor none -serial none -icount shift=6 \
  -semihosting-config enable=on,target=native -kernel "$program" </dev/null 2>&1 | tr -d '\r')
echo "$actual"
status=0
if [ "$(grep -v '^board:' <<<"$actual")" != "$expected" ] || [ -z "$expected" ]; then
  echo "The trace differs between this machine (<) and the board (>):"
  diff <(echo "$expected") <(grep -v '^board:' <<<"$actual") || true
  status=1
fi
while read -r kind golden; do
  read -r instructions stack < <(awk -v kind="$kind" '$1 == "board:" && $2 == kind { print $3, $5 }' <<<"$actual")
  if [ "${stack:-999999}" -gt $most_stack ]; then
    echo "$kind: $stack bytes of stack, expected at most $most_stack"
    status=1
  fi
  if [ "$version" != 12 ]; then
    echo "$kind: instructions are not judged: the numbers are those of g++ 12, here is $version"
  elif [ $((instructions * 100)) -gt $((golden * 105)) ] || [ $((instructions * 100)) -lt $((golden * 95)) ]; then
    echo "$kind: $instructions instructions a period, expected $golden within 5 %"
    status=1
  fi
done < <(grep -v '^#' tests/golden/cortex_m7.txt)
exit $status
