#!/bin/bash
# spin.bash RIGTWIN_SPIN -- the states, requests and reasons of the controller (firmware/loop/common/mode.hpp, trip.hpp), printed as a Promela model by
# rigtwin_spin and explored whole by SPIN: power never without arming, a press always ends in no power and in safe, which is so a way from every
# state, and the first reason is kept. A model that cannot fail proves nothing: each property is also broken once, and must be missed.
. "$(dirname "$0")/common.bash"
need spin gcc
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$1" >"$folder/model.pml"

# explore FILE -- errors that SPIN finds in all states of a model.
explore() {
  mkdir -p "$folder/$1" && cd "$folder/$1"
  spin -a "$folder/$1.pml" >spin.txt || { cat spin.txt; exit 1; }
  gcc -O0 -w -DSAFETY -o pan pan.c
  ./pan -m1000000 >pan.txt
  grep -q 'Warning: Search not completed\|max search depth too small' pan.txt && grep -q 'errors: 0' pan.txt && { cat pan.txt; exit 1; }
  sed -n 's/.*errors: \([0-9]*\).*/\1/p' pan.txt
}

status=0
errors=$(explore model)
if [ "$errors" != 0 ]; then
  grep 'pan:' "$folder/model/pan.txt"
  (cd "$folder/model" && spin -t -p -g "$folder/model.pml" | tail -n 60)
  echo "the controller's table breaks a promise: the way there stands above"
  status=1
fi
grep 'states, stored' "$folder/model/pan.txt" || true

# broken NAME SCRIPT -- the model changed by sed must have an error.
broken() {
  sed "$2" "$folder/model.pml" >"$folder/$1.pml"
  ! cmp -s "$folder/model.pml" "$folder/$1.pml" || { echo "$1: nothing was changed, see tests/spin/main.cpp"; status=1; return; }
  [ "$(explore "$1")" != 0 ] || { echo "$1: not noticed"; status=1; }
}
broken press_keeps_power '/E_HALT -> mode = M_SAFE\|E_ARRIVED/s/ power = false;//'  # either of the two would do
broken safe_gives_power 's/mode == M_SAFE && e == E_HALT -> mode = M_SAFE; power = false;/mode == M_SAFE \&\& e == E_HALT -> mode = M_SAFE; give();/'
broken power_before_arming 's/mode == M_IDLE && e == E_ARM -> mode = M_ARMING;/& power = true;/'
broken reason_is_lost 's/^     follow(E_HALT)$/     first_reason = reason; follow(E_HALT)/'
broken runs_are_reached 's/^     assert(mode != M_IDLE || !power);$/     assert(!(mode == M_HOLDING \&\& power));/'
exit $status
