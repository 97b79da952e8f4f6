#!/bin/bash
# fuzz.bash TARGET -- a fuzzer, built by the sanitizer check, starts from its corpus and finds nothing in a bounded
# number of runs, from a fixed seed.
. "$(dirname "$0")/common.bash"
need clang++
target=$1
build sanitize "$target"

grown=$(mktemp -d)
trap 'rm -rf "$grown"' EXIT
corpus=tests/fuzz/corpus/$target
[ -d "$corpus" ] || { echo "$corpus is missing: a fuzzer needs seeds"; exit 1; }
limits="-max_total_time=10 -max_len=4096 -timeout=10"
[ "$target" = fuzz_diagnose ] && limits="-max_total_time=40 -max_len=64 -timeout=60 -close_fd_mask=1"  # a second each
# shellcheck disable=SC2086
"$builds/sanitize/bin/$target" -seed=1 -runs=50000 $limits -print_final_stats=1 \
  -artifact_prefix="$builds/sanitize/$target-" "$grown" "$corpus"
