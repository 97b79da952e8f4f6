#!/bin/bash
# The GPIO file for the libgpiod that this machine does not have compiles against that version's own header, links its library and
# starts. Debian 12 has 1.6, Debian 13 has 2.x; toolchains/fetch_guest unpacks the other one in the builds' folder guest. The
# guest's journey runs it on lines.
. "$(dirname "$0")/common.bash"
need g++
# version HEADER -- the version of the interface that it declares
version() {
  if grep -q gpiod_line_settings_new "$1"; then echo 2; else echo 1; fi
}
here=$(version "$(find /usr/include -maxdepth 1 -name gpiod.h | head -n 1)")
other=$((3 - here))
root=$builds/guest/other-libgpiod/usr
library=$(find "$root/lib/$(g++ -print-multiarch)" -maxdepth 1 -name libgpiod.so 2>/dev/null || true)
[ -f "$root/include/gpiod.h" ] && [ -n "$library" ] ||
  skip "libgpiod $other could not be had from this machine's package source (toolchains/fetch_guest tries): hal/linux/gpio_v$other.cpp is not compiled here nor run in the guest"
[ "$(version "$root/include/gpiod.h")" = "$other" ] || { echo "$root holds libgpiod $here"; exit 1; }

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat >"$folder/main.cpp" <<'END'
#include <cstdio>

#include "hal/linux/gpio_roles.hpp"
int main() {
  std::printf("%s\n%s", hal::linux::gpio_library().c_str(), hal::linux::list_gpio().c_str());
  const auto lines = hal::linux::OutputLines::open({"no-such-chip", {"line"}, false, 0, "check"});
  const auto edge = hal::linux::EdgeLine::open({"no-such-chip", "line", false, hal::linux::Bias::as_is, "check"});
  std::printf("%s\n%s\n", lines.trouble.c_str(), edge.trouble.c_str());
}
END
g++ -std=c++20 -Wall -Wextra -Wconversion -Werror -I . -isystem "$root/include" "$folder/main.cpp" "hal/linux/gpio_v$other.cpp" \
  hal/linux/gpio.cpp hal/linux/gpio_roles.cpp hal/linux/opened.cpp -o "$folder/main" "$library"
LD_LIBRARY_PATH=${library%/*} "$folder/main" | tee "$folder/said"
grep -q "^libgpiod $other" "$folder/said" || { echo "it says another version"; exit 1; }
[ "$(grep -c "^GPIO chip 'no-such-chip' is not there" "$folder/said")" = 2 ] || { echo "it does not say what is missing"; exit 1; }
