#!/bin/bash
# package_rigtwin.bash BUILD-FOLDER -- the Debian packages of this PC: rigtwin and rig-controller on a machine that has nothing but what the
# packages depend on, and rigtwin-dev for a program of somebody else.
#
# The machine is a folder with the files of those packages alone, and with dpkg's list of them. dpkg itself installs ours there, so a missing
# dependency stops it, and then the manual's tour runs inside: with a shell and the usual small tools, without compiler, cmake and source
# tree. It proves that the dependencies suffice on this release of Debian. Not proven: other releases, and apt's download
# (toolchains/prove_fresh_machine has a network). Without root the tour runs on this machine, from the unpacked packages.
. "$(dirname "$0")/common.bash"
host=$1
need cpack
need dpkg-deb
need dpkg-shlibdeps
status=0
complain() {
  echo "$*"
  status=1
}

(
  flock 9
  cmake --build "$host" --parallel "$jobs" --target rigtwin rigtwin_fmu rig_controller model rigtwin_documents rigtwin_python
) 9>"$builds/host.lock"
foreign=()
if command -v aarch64-linux-gnu-g++ >/dev/null; then  # as the target packages does
  build aarch64 rigtwin_fmu
  foreign+=(lib/rigtwin/fmu/aarch64-linux/rigtwin.so)
fi
if command -v x86_64-w64-mingw32-g++-posix >/dev/null; then
  build win64 rigtwin_fmu
  foreign+=(lib/rigtwin/fmu/win64/rigtwin.dll)
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cpack --config "$host/CPackConfig.cmake" -B "$folder" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
architecture=$(dpkg --print-architecture)
program=$(echo "$folder"/rigtwin_*_"$architecture".deb)
development=$(echo "$folder"/rigtwin-dev_*_"$architecture".deb)
controller=$(echo "$folder"/rig-controller_*_"$architecture".deb)
notebooks=$(echo "$folder"/python3-rigtwin_*_"$architecture".deb)
for package in "$program" "$development" "$controller" "$notebooks"; do
  [ -f "$package" ] || { ls "$folder"; echo "a package is missing"; exit 1; }
  dpkg-deb -x "$package" "$folder/root"
done
dpkg-deb -I "$program" | grep -E 'Depends|Version|Description'
for file in bin/rigtwin bin/rig_controller lib/rigtwin/fmu/linux64/rigtwin.so "${foreign[@]}" share/rigtwin/rigs/paper_hil_fdva.toml \
  share/man/man1/rigtwin.1 share/man/man1/rig_controller.1 share/bash-completion/completions/rigtwin share/doc/rigtwin/LICENSE \
  share/doc/rigtwin/manual.html share/doc/rigtwin/tour.sh lib/python3/dist-packages/rigtwin/__init__.py lib/rigtwin/libmodel.a lib/cmake/rigtwin/rigtwin-config.cmake \
  share/rigtwin/matlab/+rigtwin/simulate.m include/rigtwin/model/rig/rig_model.hpp include/rigtwin/model/laws/placed_laws.hpp; do
  [ -s "$folder/root/usr/$file" ] || complain "/usr/$file is missing"
done
ls "$folder"/root/usr/lib/python3/dist-packages/rigtwin/_core*.so >/dev/null || complain "python3-rigtwin has no compiled half"

# The pages as man(1) reads them.
if command -v groff >/dev/null; then
  for page in "$folder"/root/usr/share/man/man1/*.1; do
    groff -k -man -Tutf8 -ww -z "$page" 2>&1 | grep . && complain "  ^ ${page##*/}"
  done
fi

# model/ in a program of somebody else, from rigtwin-dev alone.
cmake -S "$folder/root/usr/share/doc/rigtwin-dev/example" -B "$folder/example" -DCMAKE_PREFIX_PATH="$folder/root/usr" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_CXX_FLAGS="-Wall -Wextra" >"$folder/log" 2>&1 && cmake --build "$folder/example" >>"$folder/log" 2>&1 ||
  { cat "$folder/log"; complain "the example of find_package(rigtwin) does not compile"; }
said=$("$folder/example/kerb" || true)
echo "find_package(rigtwin): $said"
[[ $said =~ ^largest\ dynamic\ wheel\ load\ [1-9][0-9]+\ N$ ]] || complain "  ^ the example does not say its wheel load"

# closure PACKAGE… -- these packages and all that they depend on, as they are installed here.
closure() {
  local known=" " package next=("$@") dependency
  while [ ${#next[@]} -gt 0 ]; do
    package=${next[0]}
    next=("${next[@]:1}")
    [[ $known != *" $package "* ]] || continue
    dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null | grep -q '^installed' || continue
    known+="$package "
    for dependency in $(dpkg-query -W -f '${Depends}, ${Pre-Depends}' "$package" | sed 's/([^)]*)//g; s/:any//g; s/[,|]/ /g'); do next+=("$dependency"); done
  done
  echo "$known"
}

# A machine with those packages' files alone, where dpkg installs ours.
machine() {
  local wanted
  wanted=$(for package in "$program" "$controller"; do dpkg-deb -f "$package" Depends; done | sed 's/([^)]*)//g; s/[,|]/ /g')
  # shellcheck disable=SC2086
  installed=$(closure $(dpkg-query -W -f '${Package} ${Essential}\n' | sed -n 's/ yes$//p') $wanted)  # the essential ones are everywhere
  mkdir -p "$folder/machine"/{usr/bin,usr/sbin,usr/lib,usr/lib64,proc,run,tmp,dev,etc,var/lib/dpkg/info,var/lib/dpkg/updates}
  for name in bin sbin lib lib64; do ln -s "usr/$name" "$folder/machine/$name"; done
  # shellcheck disable=SC2086
  dpkg -L $installed | sort -u | while read -r file; do [ -d "$file" ] && [ ! -L "$file" ] || [ ! -e "$file" ] || echo "${file#/}"; done |
    grep -v '^usr/share/\(doc\|man\|locale\|i18n\)/' |
    tar -C / --no-recursion -cf - -T - | tar -C "$folder/machine" --keep-directory-symlink -xf -
  for package in $installed; do
    dpkg-query -s "$package"
    echo
  done >"$folder/machine/var/lib/dpkg/status"
  for package in $installed; do cp "/var/lib/dpkg/info/$package".list "/var/lib/dpkg/info/$package":*.list "$folder/machine/var/lib/dpkg/info/" 2>/dev/null || true; done
  printf 'root:x:0:0:root:/root:/bin/sh\n' >"$folder/machine/etc/passwd"
  printf 'root:x:0:\n' >"$folder/machine/etc/group"
  : >"$folder/machine/etc/shadow"
  : >"$folder/machine/etc/gshadow"
  mknod -m 666 "$folder/machine/dev/null" c 1 3
}

cat >"$folder/inside.sh" <<'END'
set -e
for tool in g++ cc clang cmake; do
  if command -v $tool >/dev/null; then echo "$tool is there"; exit 1; fi
done
mkdir /tmp/tour && cd /tmp/tour
rigtwin --version
rigtwin fmu --rig /usr/share/rigtwin/rigs/paper_linear.toml --out rig.fmu
rigtwin fmu --rig /usr/share/rigtwin/rigs/paper_linear.toml --out rig3.fmu --fmi 3
sh -e /usr/share/doc/rigtwin/tour.sh
END
if [ "$(id -u)" -eq 0 ] && command -v unshare >/dev/null; then
  machine
  dpkg --root="$folder/machine" --install "$program" "$controller" >"$folder/log" 2>&1 || { cat "$folder/log"; complain "dpkg does not install the packages"; }
  cp "$folder/inside.sh" "$folder/machine/tmp/"
    grep -E '^Setting up' "$folder/log" || true
  echo "a machine of $(wc -w <<<"$installed") packages, $(du -sm "$folder/machine" | cut -f1) MB"
  unshare --mount --propagation private -- sh -c 'mount -t proc proc "$0/proc" && exec chroot "$0" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp LANG=C.UTF-8 sh /tmp/inside.sh' \
    "$folder/machine" >"$folder/tour" 2>&1 || complain "the tour ends with an error"
else
  echo "no root: the tour runs on this machine"
  mkdir "$folder/tour.d"
  (cd "$folder/tour.d" && PATH="$folder/root/usr/bin:$PATH" RIGS="$folder/root/usr/share/rigtwin/rigs" sh -e "$folder/root/usr/share/doc/rigtwin/tour.sh") \
    >"$folder/tour" 2>&1 || complain "the tour ends with an error"
fi
tail -n 12 "$folder/tour"
grep -q '^The model lacks' "$folder/tour" || complain "  ^ the tour names no effect"
exit $status
