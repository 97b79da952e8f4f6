# For the checks: they build and inspect the tree in other ways than the unit tests do, and are run by ctest from the
# root of the tree. Status 77 says "skipped"; the last line then says what is missing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
builds=${RIGTWIN_BUILDS:-build}
jobs=${RIGTWIN_JOBS:-$(nproc)}  # 1 where other tests run beside this one

skip() {
  echo "skipped: $*"
  exit 77
}

# need TOOL… -- on the path, or skipped.
need() {
  local tool
  for tool; do
    command -v "$tool" >/dev/null || skip "$tool is missing (toolchains/setup checks installs it)"
  done
}

# need_version TOOL MAJOR -- what it accepts depends on its version: another one would judge by other rules.
need_version() {
  need "$1"
  local found
  found=$("$1" --version | grep -o 'version [0-9]*' | head -n 1)
  [ "$found" = "version $2" ] || skip "$1 $2 is missing, here is $found"
}

configure() {
  cmake --preset "$1" -B "$builds/$1"
}

# build PRESET [TARGET…] -- one at a time in each build folder, whatever checks run beside each other.
build() {
  local preset=$1
  shift
  mkdir -p "$builds"
  (
    flock 9
    configure "$preset"
    cmake --build "$builds/$preset" --parallel "$jobs" ${1+--target "$@"}
  ) 9>"$builds/$preset.lock"
}

# Our own sources. Names with spaces are not among them.
sources() {
  find model hal firmware host_sim tests -name '*.[ch]pp'
}
