#!/bin/bash
# clang-tidy finds nothing in the product's rooms (.clang-tidy says what it looks for). Tests are left to the compilers'
# warnings and the sanitizers: what Google Test's macros unfold to takes clang-tidy minutes a file.
. "$(dirname "$0")/common.bash"
need clang++
need_version clang-tidy 14
configure tidy
# The GPIO file of the libgpiod that is not here is compiled nowhere.
not_here=$(for file in hal/linux/gpio_v*.cpp; do grep -q "/$file\"" "$builds/tidy/compile_commands.json" || echo "$file"; done)
sources | grep '\.cpp$' | grep -v '^tests/' | grep -vxF "${not_here:-none}" | sort |
  xargs -P "$(nproc)" -n 1 clang-tidy -p "$builds/tidy" --quiet --warnings-as-errors='*' \
    2> >(grep -v ' warnings generated\.$' >&2)  # those of other people's headers, counted and not shown
