#!/bin/bash
# win64.bash TRACE RIGTWIN WALK -- on Windows, that is under Wine: the trace program prints what TRACE prints here, and an FMU's library, led
# by tests/fmu_walk, gives the rows of `rigtwin simulate` bit for bit. WALK is that program for this machine, whose library is led as well.
. "$(dirname "$0")/common.bash"
trace=$1
rigtwin=$2
walk=$3

need x86_64-w64-mingw32-g++-posix
wine=
for name in wine64 wine /usr/lib/wine/wine64; do  # Debian's wine64 is on no path without the package wine
  if command -v "$name" >/dev/null; then
    wine=$name
    break
  fi
done
[ -n "$wine" ] || skip "wine64 is missing (toolchains/setup checks installs it)"

build win64 rigtwin_trace rigtwin_fmu rigtwin_fmu_walk
folder=$(mktemp -d)
# No fonts, browser, .NET or menus; a folder of its own as the Windows disk.
export WINEPREFIX=$folder/wine WINEDEBUG=-all WINEDLLOVERRIDES="mscoree,mshtml,winemenubuilder.exe="
finish() {
  local server
  for server in wineserver /usr/lib/wine/wineserver64 /usr/lib/wine/wineserver; do
    if command -v "$server" >/dev/null; then
      "$server" -k 2>/dev/null || true  # ends what runs in WINEPREFIX
      break
    fi
  done
  rm -rf "$folder"
}
trap finish EXIT
windows=$builds/win64/bin

expected=$("$trace")
actual=$("$wine" "$windows/rigtwin_trace.exe" 2>"$folder/log" | tr -d '\r') || { cat "$folder/log"; echo "$wine cannot run rigtwin_trace.exe"; exit 1; }
[ -n "$expected" ] || { echo "$trace prints nothing"; exit 1; }
if [ "$actual" != "$expected" ]; then
  echo "The trace differs between Linux (<) and Windows (>):"
  diff <(echo "$expected") <(echo "$actual") || exit 1
fi
echo "$actual"

# led LIBRARY PROGRAM… -- walks through the FMU in $folder/fmu.
led() {
  local library=$1
  shift
  "$@" "$folder/un packed" "$library" "$folder/run.csv" "$version"
}
status=0
for case in paper_hil_fdva:2 paper_rig_fdva:2 paper_bench_fdva:2 paper_hil_fdva:3; do
  rig=${case%:*}
  version=${case#*:}
  "$rigtwin" simulate --rig "host_sim/rigs/$rig.toml" --duration 2 --out "$folder/run.csv" >"$folder/log"
  "$rigtwin" fmu --rig "host_sim/rigs/$rig.toml" --fmi "$version" --out "$folder/rig.fmu" >>"$folder/log"
  rm -rf "$folder/un packed"
  mkdir "$folder/un packed"
  (cd "$folder/un packed" && cmake -E tar xf ../rig.fmu)
  linux=linux64/rigtwin.so
  dll=win64/rigtwin.dll
  if [ "$version" = 3 ]; then
    linux=x86_64-linux/rigtwin.so
    dll=x86_64-windows/rigtwin.dll
  fi
  echo -n "$rig, "
  led $linux "$walk" || status=1
  echo -n "$rig, "
  led $dll "$wine" "$windows/rigtwin_fmu_walk.exe" 2>>"$folder/log" | tr -d '\r' || status=1
done
exit $status
