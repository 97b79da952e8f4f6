#!/bin/bash
# clang-tidy finds nothing in the product's rooms (.clang-tidy says what it looks for). Tests are left to the compilers'
# warnings and the sanitizers: what Google Test's macros unfold to takes clang-tidy minutes a file.
. "$(dirname "$0")/common.bash"
need clang++
need_version clang-tidy 14
configure tidy
# The GPIO file of the libgpiod that is not here is compiled nowhere.
not_here=$(for file in hal/linux/gpio_v*.cpp; do grep -q "/$file\"" "$builds/tidy/compile_commands.json" || echo "$file"; done)
mapfile -t judged < <(sources | grep '\.cpp$' | grep -v '^tests/' | grep -vxF "${not_here:-none}" | sort)

# Half of the time goes into headers of libraries, read and judged anew for each source: two dozen sources are judged as one.
# Where that does not compile, or anything is found, each is judged by itself, and that counts.
groups=$(cd "$builds/tidy" && pwd)/groups
rm -rf "$groups"
mkdir -p "$groups"
LC_ALL=C awk -v FOLDER="$groups" -v most=24 -f tests/checks/tidy_groups.awk "${judged[@]/#/$PWD/}" \
  "$builds/tidy/compile_commands.json" >"$groups/list"
grouped=$(cut -d ' ' -f 2- "$groups/list" | wc -w)
[ "$grouped" = "${#judged[@]}" ] || { echo "$grouped of ${#judged[@]} sources are compiled"; exit 1; }

# judge SINGLY GROUPS GROUP SOURCE…
judge() {
  local singly=$1 groups=$2 group=$3 source status=0
  shift 3
  # In a group every source is a file that is included, and a warning of the compiler (shadowed names) none.
  if [ $# -gt 1 ] && clang-tidy -p "$groups" --quiet --warnings-as-errors='*' --extra-arg=-w \
    --header-filter='(^|/)(model|hal|firmware|host_sim)/[a-z_0-9/]*\.[ch]pp$' "$group" >"$group.log" 2>&1; then
    return 0
  fi
  for source; do
    clang-tidy -p "$singly" --quiet --warnings-as-errors='*' "$source" \
      2> >(grep -v ' warnings generated\.$' >&2) || status=1  # those of other people's headers, counted and not shown
  done
  return $status
}
export -f judge
# Long groups first.
awk '{ print NF, $0 }' "$groups/list" | sort -rn | cut -d ' ' -f 2- |
  xargs -P "$(nproc)" -L 1 bash -c 'judge "$0" "$@"' "$builds/tidy" "$groups"
