#!/bin/bash
# clang-tidy finds nothing in the product's rooms (.clang-tidy says what it looks for), read by inner room as they are compiled: source by
# source it would read the libraries' headers three hundred times, 24 minutes of a processor. Tests are left to the compilers' warnings and the sanitizers: what Google Test's macros unfold to takes
# clang-tidy minutes a file.
. "$(dirname "$0")/common.bash"
need clang++
need run-clang-tidy
need_version clang-tidy 14
configure tidy
run-clang-tidy -p "$builds/tidy" -quiet -j "$jobs" "^$PWD/(model|hal|firmware|host_sim)/|/Unity/unity_"
