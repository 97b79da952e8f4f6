#!/bin/bash
# clang-tidy finds nothing (.clang-tidy says what it looks for).
. "$(dirname "$0")/common.bash"
need clang++
need_version clang-tidy 14
configure tidy
sources | grep '\.cpp$' | grep -v '^tests/fuzz/' | sort |
  xargs -P "$(nproc)" -n 1 clang-tidy -p "$builds/tidy" --quiet --warnings-as-errors='*' \
    2> >(grep -v ' warnings generated\.$' >&2)  # those of other people's headers, counted and not shown
