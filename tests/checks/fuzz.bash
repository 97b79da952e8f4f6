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
inputs="$grown $corpus"
[ -d "$corpus" ] || { echo "$corpus is missing: a fuzzer needs seeds"; exit 1; }
limits="-runs=50000 -max_total_time=10 -max_len=4096 -timeout=10"
# A whole diagnosis takes seconds to minutes without optimisation: each seed of the corpus runs once, but for four that take minutes. All and
# more by hand, with -runs=N and the folder.
[ "$target" = fuzz_diagnose ] && {
  limits="-runs=1 -timeout=600 -close_fd_mask=1"
  inputs=$(find "$corpus" -type f ! -name car ! -name found_020 ! -name found_034 ! -name found_metres | sort)
}
# libFuzzer's own status for a finding, 77, is what a skipped test ends with here.
# shellcheck disable=SC2086
"$builds/sanitize/bin/$target" -seed=1 $limits -error_exitcode=1 -print_final_stats=1 \
  -artifact_prefix="$builds/sanitize/$target-" $inputs
