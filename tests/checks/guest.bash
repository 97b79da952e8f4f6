#!/bin/bash
# guest.bash RIGTWIN RIG_CONTROLLER -- rig_controller for 64-bit Arm on Debian's PREEMPT_RT kernel, under QEMU, with lines and
# converters that the kernel simulates; what it recorded there is read here. Guest time is counted in instructions: it does not
# depend on how busy this machine is.
. "$(dirname "$0")/common.bash"
rigtwin=$1
rig_controller=$2
need qemu-system-aarch64
need aarch64-linux-gnu-g++
need make
need cpio
need dpkg-deb
need cpack
need ninja
fetched=$builds/guest
[ -e "$fetched/complete-board-arm64" ] && [ -e "$fetched/complete-guest" ] ||
  skip "the guest's kernel and libraries are missing in $fetched (toolchains/setup tests fetches them)"
fetched=$(cd "$fetched" && pwd)

build aarch64 rig_controller

# Modules for the kernel's headers as they lie here, once for each kernel and source.
version=$(cat "$fetched/kernel/version")
headers=$fetched/kernel/usr/src/linux-headers-$version
modules=$fetched/modules
wanted=$(cat tests/guest/Kbuild tests/guest/*.c "$fetched/kernel/version" | sha256sum)
if [ "$(cat "$modules/made" 2>/dev/null)" != "$wanted" ]; then
  rm -rf "$modules"
  mkdir -p "$modules"
  sed -i "s|^include .*/usr/src/|include $fetched/kernel/usr/src/|" "$headers/Makefile"
  find "$fetched/source" -name '*.[ch]' -exec cp {} "$modules" \;
  cp tests/guest/Kbuild tests/guest/*.c "$modules"
  make -s -j"$jobs" -C "$headers" M="$modules" ARCH=arm64 CROSS_COMPILE=aarch64-linux-gnu- modules >"$modules/log" 2>&1 ||
    { tail -n 30 "$modules/log"; exit 1; }
  echo "$wanted" >"$modules/made"
fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
root=$folder/root
mkdir -p "$root/bin" "$root/lib" "$root/modules"
cp "$fetched/kernel/bin/busybox" "$root/bin/"
# The program as a board gets it: out of its package.
cpack --config "$builds/aarch64/CPackConfig.cmake" -B "$folder" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
dpkg-deb -x "$folder"/rig-controller_*_arm64.deb "$root"
cp "$fetched/board/usr/bin/cyclictest" "$root/bin/"
aarch64-linux-gnu-g++ -std=c++20 -O1 -Wall -Wextra -static tests/guest/observer.cpp -o "$root/bin/observer"
install -m 755 tests/guest/init "$root/init"
cp tests/guest/rig.toml "$root/rig.toml"
cp host_sim/rigs/paper_hil_fdva.toml "$root/hil.toml"
for module in "$modules"/*.ko; do aarch64-linux-gnu-strip -g -o "$root/modules/${module##*/}" "$module"; done
for name in configfs industrialio kfifo_buf industrialio-triggered-buffer; do
  find "$fetched/kernel/lib/modules/$version" -name "$name.ko" -exec cp {} "$root/modules/" \;
done
# libraries FILE -- what it needs, and what those need
libraries() {
  local name library
  for name in $(aarch64-linux-gnu-objdump -p "$1" | awk '$1 == "NEEDED" { print $2 }'); do
    [ ! -e "$root/lib/$name" ] || continue
    library=$(find "$fetched/board" -name "$name" -path '*aarch64*' | head -n 1)
    [ -n "$library" ] || { echo "$name is missing in $fetched/board"; exit 1; }
    cp -L "$library" "$root/lib/$name"
    libraries "$root/lib/$name"
  done
}
libraries "$root/usr/bin/rig_controller"
libraries "$root/bin/cyclictest"
# And with the other libgpiod, where it could be had: the program's own link, that version's file and library in front.
other=$(find "$fetched/other-libgpiod/usr/lib/aarch64-linux-gnu" -maxdepth 1 -name 'libgpiod.so.?' 2>/dev/null || true)
if [ -n "$other" ]; then
  version_of_other=$(grep -q gpiod_line_settings_new "$fetched/other-libgpiod/usr/include/gpiod.h" && echo 2 || echo 1)
  aarch64-linux-gnu-g++ -std=c++20 -O2 -ffp-contract=off -I . -isystem "$fetched/other-libgpiod/usr/include" \
    -c "hal/linux/gpio_v$version_of_other.cpp" -o "$folder/gpio_other.o"
  link=$(ninja -C "$builds/aarch64" -t commands rig_controller | tail -n 1)
  link=$(sed -e "s|-o bin/rig_controller |-o $root/bin/rig_controller_other $folder/gpio_other.o |" -e "s|[^ ]*/libgpiod\.so[^ ]*|$other|" <<<"$link")
  (cd "$builds/aarch64" && bash -c "$link")
  cp -L "$other" "$root/lib/"
  libraries "$root/bin/rig_controller_other"
fi
# What the host's sensors said, to be replayed there.
"$rig_controller" --rig host_sim/rigs/paper_hil_fdva.toml --simulated --virtual-time --duration 5 --out "$folder/here.csv" >"$folder/out"
cp "$folder/here.csv" "$root/host.csv"
(cd "$root" && find . | cpio -o -H newc --quiet) >"$folder/initrd"

log=$folder/console
timeout 900 qemu-system-aarch64 -M virt -cpu cortex-a53 -smp 1 -m 512 -display none -nodefaults -serial stdio -no-reboot \
  -icount shift=0,sleep=off -kernel "$fetched/kernel/boot/vmlinuz-$version" -initrd "$folder/initrd" \
  -append 'console=ttyAMA0 panic=-1 loglevel=3 rdinit=/init' </dev/null 2>&1 | tr -d '\r' >"$log" || true
# received NAME -- a file that the guest sent
received() {
  awk -v name="$1" '$1 == "FILE" && $2 == name { on = 1; next } $1 == "END" { on = 0 } on' "$log" | base64 -d | gunzip >"$folder/$1"
}
awk '$1 == "FILE" { on = 1 } !on; $1 == "END" { on = 0 }' "$log"
grep -q '^FAILURES 0$' "$log" || { echo "the guest found failures, or did not get to its end"; exit 1; }

status=0
complain() {
  echo "$*"
  status=1
}
# The button is answered within 5 ms of guest time.
micros=$(sed -n 's/^ok .*stop button to safe valves: OBSERVED after \([0-9]*\) us/\1/p' "$log")
[ -n "$micros" ] || complain "the button was not answered"
for each in $micros; do [ "$each" -le 5000 ] || complain "valves safe after $each us, expected 5000 us at most"; done
# Recordings are read as they are, whole up to the end; on a real-time kernel no period is late.
for name in run killed slow full; do
  received "$name.csv"
  rows=$(grep -c '^[0-9]' "$folder/$name.csv")
  "$rigtwin" frf --data "$folder/$name.csv" --input dz_w --output F_w --json "$folder/$name.json" >"$folder/out" 2>&1 || true
  ! grep -E "$name.csv:[0-9]+:" "$folder/out" || complain "  ^ $name.csv is not read without error"
  echo "$name.csv: $rows rows"
done
[ "$(grep -c '^[0-9]' "$folder/run.csv")" -ge 29000 ] || complain "the recording of 30 s is shorter"
[ "$(grep -c '^[0-9]' "$folder/killed.csv")" -ge 2000 ] || complain "more than the last second is lost by kill -9"
# Ages of samples that come every 1/239 s, read every millisecond: evenly between none and 4.18 ms, whatever is between
# sampling and reading on top (0.2 ms allowed). Two queued samples, or stamps of when they were read, would not show that.
awk -F, '/^t,/ { for (i = 1; i <= NF; ++i) if ($i == "age_F_w [s]") c = i } /^[0-9]/ && $1 > 1 { print 1e6 * $c }' "$folder/slow.csv" | sort -g |
  awk '{ a[NR] = $1 } END { low = a[1]; middle = a[int(NR / 2)]; high = a[NR]
    printf "ages of a slower converter: %.0f to %.0f us, median %.0f us\n", low, high, middle
    exit !(NR > 1000 && low >= 0 && low < 200 && middle > 1992 && middle < 2192 && high > 3984 && high < 4384) }' ||
  complain "expected 0 to 4184 us, median 2092"
# The same bits as here.
for name in hil replay; do
  received $name.csv
  cmp <(grep -v '^#' "$folder/$name.csv") <(grep -v '^#' "$folder/here.csv") || complain "the guest's bits differ from this machine's: $name"
done
# Wake-up latency beside that of cyclictest, same kernel, priority and minute; nanoseconds, 99 of 100.
received cyclictest.txt
theirs=$(awk '/^[0-9]/ { n[NR] = $2; at[NR] = $1; all += $2; last = NR } END { for (i = 1; i <= last; ++i) if ((seen += n[i]) >= 0.99 * all) { print at[i] + 0; exit } }' "$folder/cyclictest.txt")
ours=$(sed -n 's/.*wake-up latency .* P99: *\([0-9.]*\) .*/\1/p' "$log" | head -n 1 | awk '{ print $1 * 1000 }')
echo "wake-up latency, P99: rig_controller $ours ns, cyclictest $theirs ns, expected 1.2 times as much at most"
[ "${theirs:-0}" -gt 0 ] && [ $((${ours:-999999} * 10)) -le $((theirs * 12)) ] || complain "rig_controller wakes up later than cyclictest"
exit $status
