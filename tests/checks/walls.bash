#!/bin/bash
# No source includes what its room must not know. The link lines say it already; this also covers what links cannot see:
# standard headers, and the folders within a room.
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

model=$(in_room model/)
hal=$(in_room hal/)
hal_roles=$(in_room 'hal/[^/]*$')
firmware=$(in_room firmware/ | grep -v '^firmware/controller/' || true)

forbid 'model knows Eigen and itself' '"(hal|firmware|host_sim|tests)/' $model
forbid 'model does no I/O, asks no clock, starts no thread, takes no heap' \
  '<(iostream|fstream|sstream|iomanip|ostream|istream|filesystem|chrono|thread|mutex|future|vector|deque|list|map|set|unordered_map|string|memory|functional|random)>' $model
forbid 'hal knows no other room' '["<](model|firmware|host_sim|tests|Eigen)/' $hal
forbid 'the roles of hal know no back-end' '"hal/[a-z_0-9]+/' $hal_roles
forbid 'the firmware meets the world through the roles of hal; only its main, controller/, picks back-ends' \
  '"(hal/[a-z_0-9]+|host_sim|tests)/' $firmware
forbid 'tests are not part of the product' '"tests/' $(in_room host_sim/)
forbid 'the truth generator shares nothing with what it judges' '"(model|hal|firmware|host_sim)/' $(in_room tests/truth/)
exit $status
