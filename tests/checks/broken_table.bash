#!/bin/bash
# broken_table.bash -- each safety function of tests/faults/broken/functions.txt still stands in the code, once. broken.bash, by hand, breaks them.
. "$(dirname "$0")/common.bash"
need perl
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r firmware hal "$folder"
perl tests/faults/broken/instrument.pl tests/faults/broken/functions.txt "$folder" >"$folder/names"
echo "$(wc -l <"$folder/names") safety functions"
