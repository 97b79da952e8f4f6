#!/bin/bash
# watch.bash RIGTWIN RIG_CONTROLLER [FOLDER] -- the page of rigtwin watch in a browser, beside a controller with a simulated rig: traces
# that move, buttons that ask, a trip with its reason, a controller that is gone, a server that is gone; on a laptop's screen and on a
# tablet's. Screenshots are left in FOLDER, if one is given.
. "$(dirname "$0")/common.bash"
need chromium node

folder=$(mktemp -d)
trap 'rm -rf "$folder" 2>/dev/null || { sleep 1; rm -rf "$folder"; }' EXIT  # a browser that was killed may still write
node --check host_sim/watch/page/watch.js
# timeout ends a test that hangs; no verdict depends on how long something took.
timeout 300 node tests/checks/watch.mjs "$1" "$2" "$folder" "${3:-}"
