#!/bin/bash
# board.bash REFERENCES -- model and control loop on a Cortex-M7 (QEMU's mps2-an500, newlib) print the hashes that the same programs
# print here: rigtwin_board_loop, the control loop alone, rigtwin_board_semi_active, with Kalman filter and rollout or a compensation
# beside it, rigtwin_board_trace, with the simulated rig, and rigtwin_board_laws, the model with laws from tables, in folder REFERENCES. A period
# costs the instructions of tests/golden/cortex_m7.txt, within 5 %, and a small stack. Code and memory are held to their budget by
# the linker scripts; a stack that is too small for construction faults.
. "$(dirname "$0")/common.bash"
references=$1
need arm-none-eabi-g++
need qemu-system-arm
version=$(arm-none-eabi-g++ -dumpversion | cut -d. -f1)
declare -A most_stack=([loop]=2560 [trace]=2560 [laws]=2560 [semi_active]=3584)  # bytes, of a period beyond its caller

build cortex-m7 rigtwin_board_loop rigtwin_board_semi_active rigtwin_board_trace rigtwin_board_laws
status=0
for program in loop semi_active trace laws; do
  image=$builds/cortex-m7/bin/rigtwin_board_$program
  arm-none-eabi-size "$image"
  expected=$("$references/rigtwin_board_$program")
  # -icount: time is counted in instructions, 64 ns each.
  actual=$(timeout 300 qemu-system-arm -M mps2-an500 -nographic -monitor none -serial none -icount shift=6 \
    -semihosting-config enable=on,target=native -kernel "$image" </dev/null 2>&1 | tr -d '\r') || status=1
  echo "$actual"
  if [ "$(grep -v '^board:' <<<"$actual")" != "$expected" ] || [ -z "$expected" ]; then
    echo "$program: the trace differs between this machine (<) and the board (>):"
    diff <(echo "$expected") <(grep -v '^board:' <<<"$actual") || true
    status=1
  fi
  while read -r kind golden; do
    read -r instructions stack < <(awk -v kind="$kind" '$1 == "board:" && $2 == kind { print $3, $5 }' <<<"$actual") || true
    if [ "${stack:-999999}" -gt "${most_stack[$program]}" ]; then
      echo "$program $kind: $stack bytes of stack, expected at most ${most_stack[$program]}"
      status=1
    fi
    if [ "$version" != 12 ]; then
      echo "$program $kind: instructions are not judged: the numbers are those of g++ 12, here is $version"
    elif [ $((instructions * 100)) -gt $((golden * 105)) ] || [ $((instructions * 100)) -lt $((golden * 95)) ]; then
      echo "$program $kind: $instructions instructions a period, expected $golden within 5 %"
      status=1
    fi
  done < <(awk -v program=$program '$1 == program { print $2, $3 }' tests/golden/cortex_m7.txt)
done
exit $status
