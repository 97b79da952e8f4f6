#!/bin/bash
# Everything builds with clang++, whose warnings differ from g++'s, and the tests pass; every header builds on its own, with
# nothing in sight but what its room may know.
. "$(dirname "$0")/common.bash"
need clang++
build clang all all_verify_interface_header_sets
GTEST_BRIEF=1 "$builds/clang/bin/rigtwin_tests"
