#!/bin/bash
# matlab.bash RIGTWIN -- the package +rigtwin of MATLAB, as far as Octave goes: all but timetables.
. "$(dirname "$0")/common.bash"
command -v octave-cli >/dev/null || skip "octave-cli is missing (apt-get install octave; no profile of toolchains/setup installs it)"
RIGTWIN=$1 octave-cli --norc --quiet --path tests/host_sim/matlab --eval package_test
