#!/bin/bash
# No source includes what its room must not know. The link lines between targets say it already for whole rooms; this check also
# covers standard headers and the order of the rooms inside a room. It knows no exemption.
. "$(dirname "$0")/common.bash"
status=0

# forbid WHY PATTERN FILE… -- an #include of PATTERN (extended regular expression, brackets or quotes included).
forbid() {
  local why=$1 pattern=$2
  shift 2
  [ $# -gt 0 ] || return 0
  if grep -nEH "^ *# *include +$pattern" "$@"; then
    echo "  ^ $why"
    status=1
  fi
}

in_room() {
  sources | grep -E "^$1" || true
}

# order ROOM INNER-ROOM… -- inside ROOM, an inner room includes itself and those named before it. Files at the root of ROOM may include
# all inner rooms; no inner room includes a file at the root.
order() {
  local room=$1 inner later
  shift
  local remaining=("$@")
  for inner in "$@"; do
    remaining=("${remaining[@]:1}")
    later=$(IFS='|'; echo "${remaining[*]}")
    [ -z "$later" ] || forbid "$room: $inner/ comes before those rooms" "\"$room/($later)/" $(in_room "$room/$inner/")
    forbid "$room: a room includes no file of the folder above it" "\"$room/[a-z_0-9]+\\.hpp\"" $(in_room "$room/$inner/")
  done
  local known folder
  known=" $* "
  for folder in "$room"/*/; do
    folder=$(basename "$folder")
    [ -z "$(in_room "$room/$folder/")" ] || [[ $known == *" $folder "* ]] ||
      { echo "$room/$folder is not in the order of $room's rooms (tests/checks/walls.bash)"; status=1; }
  done
}

model=$(in_room model/)
hal=$(in_room hal/)
hal_roles=$(in_room 'hal/[^/]*$')

forbid 'model knows Eigen and itself' '"(hal|firmware|host_sim|tests)/' $model
forbid 'model does no I/O, asks no clock, starts no thread, takes no heap' \
  '<(iostream|fstream|sstream|iomanip|ostream|istream|filesystem|chrono|thread|mutex|future|vector|deque|list|map|set|unordered_map|string|memory|functional|random)>' $model
forbid 'hal knows no other room' '["<](model|firmware|host_sim|tests|Eigen)/' $hal
forbid 'the roles of hal know no back-end' '"hal/[a-z_0-9]+/' $hal_roles
forbid 'firmware knows hal and model' '"(host_sim|tests)/' $(in_room firmware/)
forbid 'the control loop meets the world through the roles of hal' '"hal/[a-z_0-9]+/' $(in_room firmware/loop/)
forbid 'tests are not part of the product' '"tests/' $(in_room host_sim/)
forbid 'the truth generator shares nothing with what it judges' '"(model|hal|firmware|host_sim)/' $(in_room tests/truth/)

forbid 'what is compiled for one kind of processor shares no inline code with other sources (host_sim/comparison/README.md)' \
  '(<(algorithm|functional|map|memory|optional|set|string|vector)>|"(firmware|hal)/)' $(in_room 'host_sim/comparison/lane')

order model numerics components effects laws rig
order firmware loop description recording simulation controller
order firmware/loop common compensation kalman duct_control guards estimator reference
order firmware/description text table laws values
order firmware/controller real_time safety devices reference recording publishing
order host_sim signal least_squares report recording_files closed_loop fmu comparison estimation stability compensation frf show paper identification plan replicate transfer sweep campaign watch live new_effect manual python commands
order host_sim/commands common
order host_sim/recording_files tables text binary export
order host_sim/stability roots margins map report
order host_sim/identification common prepare predict noise parity estimate select learn assess report
order host_sim/transfer common posterior predict validate report
exit $status
