#!/bin/bash
# Every source stands as clang-format would write it.   To write it: clang-format -i FILE
. "$(dirname "$0")/common.bash"
need_version clang-format 14
sources | xargs clang-format --dry-run -Werror
