#!/bin/bash
# package.bash PRESET ARCHITECTURE -- the Debian package of rig_controller for a board: of that architecture, with the program,
# its unit, rule, limits and example rigs in their places; `cmake --install` puts the same tree there.
. "$(dirname "$0")/common.bash"
preset=$1
architecture=$2
need dpkg-deb
[ -e "$builds/guest/complete-board-$architecture" ] ||
  skip "the libraries of $architecture boards are missing in $builds/guest (toolchains/setup board fetches them)"
case $preset in
  aarch64) need aarch64-linux-gnu-g++ ;;
  armhf) need arm-linux-gnueabihf-g++ ;;
esac

build "$preset" rig_controller
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cpack --config "$builds/$preset/CPackConfig.cmake" -B "$folder" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
package=$(echo "$folder"/rig-controller_*_"$architecture".deb)
[ -f "$package" ] || { ls "$folder"; echo "no package for $architecture"; exit 1; }
dpkg-deb -I "$package"
dpkg-deb -x "$package" "$folder/root"
status=0
for file in bin/rig_controller lib/systemd/system/rig_controller@.service \
  lib/systemd/system/rig_controller-awake@.service lib/udev/rules.d/70-rig_controller.rules \
  lib/systemd/system-generators/rig_controller-generator \
  share/rig_controller/limits.d/rig_controller.conf share/rig_controller/publish.conf share/rig_controller/rigs/example_rig.toml \
  share/rig_controller/rigs/example_hil.toml share/doc/rig_controller/README.md; do
  [ -s "$folder/root/usr/$file" ] || { echo "/usr/$file is missing"; status=1; }
done
DESTDIR=$folder/tree cmake --install "$builds/$preset" --prefix /usr >"$folder/log" || { cat "$folder/log"; exit 1; }
diff <(cd "$folder/root" && find . -type f | sort) <(cd "$folder/tree" && find . -type f | sort) ||
  { echo "  ^ the package (<) and cmake --install (>) differ"; status=1; }
machine=$(LC_ALL=C objdump -f "$folder/root/usr/bin/rig_controller" 2>/dev/null | sed -n 's/.*file format //p')
echo "program: $machine, $(stat -c %s "$folder/root/usr/bin/rig_controller") bytes"
[ -x "$folder/root/usr/lib/systemd/system-generators/rig_controller-generator" ] || { echo "the generator cannot be run"; status=1; }
dpkg-deb -I "$package" postinst | grep -q 'addgroup' || { echo "the group rig is not made"; status=1; }
if command -v systemd-analyze >/dev/null; then
  sed 's|^ExecStart=.*|ExecStart=/bin/true|' "$folder/root/usr/lib/systemd/system/rig_controller@.service" >"$folder/rig_controller@x.service"
  cp "$folder/root/usr/lib/systemd/system/rig_controller-awake@.service" "$folder/rig_controller-awake@x.service"
  ! systemd-analyze verify "$folder/rig_controller@x.service" 2>&1 | grep 'rig_controller@' || { echo "  ^ the systemd unit"; status=1; }
fi
exit $status
