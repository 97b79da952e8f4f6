#!/bin/bash
# The GPIO file for the libgpiod that this machine does not have compiles too, where that version's header can be found: in the
# folder RIGTWIN_OTHER_LIBGPIOD. Debian 12 has 1.6, Debian 13 has 2.x.
. "$(dirname "$0")/common.bash"
need g++
# version HEADER -- the version of the interface that it declares
version() {
  if grep -q gpiod_line_settings_new "$1"; then echo 2; else echo 1; fi
}
here=$(version "$(find /usr/include -maxdepth 1 -name gpiod.h | head -n 1)")
other=$((3 - here))
header=${RIGTWIN_OTHER_LIBGPIOD:+$RIGTWIN_OTHER_LIBGPIOD/gpiod.h}
[ -n "$header" ] && [ -f "$header" ] || skip "the header of libgpiod $other is not on this machine, which has $here: hal/linux/gpio_v$other.cpp is not compiled"
[ "$(version "$header")" = "$other" ] || { echo "$header is that of libgpiod $here"; exit 1; }
g++ -std=c++20 -fno-exceptions -Wall -Wextra -Wconversion -Werror -fsyntax-only -I . -isystem "$RIGTWIN_OTHER_LIBGPIOD" \
  "hal/linux/gpio_v$other.cpp"
