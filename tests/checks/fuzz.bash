#!/bin/bash
# fuzz.bash TARGET -- a fuzzer starts from its corpus and finds nothing in a bounded number of runs, the same ones each time.
. "$(dirname "$0")/common.bash"
need clang++
target=$1
build fuzz "$target"

grown=$(mktemp -d)
trap 'rm -rf "$grown"' EXIT
corpus=tests/fuzz/corpus/$target
[ -d "$corpus" ] || { echo "$corpus is missing: a fuzzer needs seeds"; exit 1; }
"$builds/fuzz/bin/$target" -seed=1 -runs=200000 -max_total_time=30 -max_len=4096 -timeout=10 -print_final_stats=1 \
  -artifact_prefix="$builds/fuzz/$target-" "$grown" "$corpus"
