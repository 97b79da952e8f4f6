#!/bin/bash
# Everything builds with clang++, whose warnings differ from g++'s, and its tests pass.
. "$(dirname "$0")/common.bash"
need clang++
build clang
GTEST_BRIEF=1 "$builds/clang/bin/rigtwin_tests"
