#!/bin/bash
# manual.bash RIGTWIN-MANUAL RIGTWIN -- the manual: each of its commands ends well, without measured data too, and the page is sound in a
# browser and on paper.
. "$(dirname "$0")/common.bash"
maker=$1
programs=$(dirname "$2")
need chromium

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
status=0
complain() {
  echo "$*"
  status=1
}
"$maker" --chapters host_sim/manual/chapters --rigs host_sim/rigs --programs "$programs" --measured ../shared/real --script "$folder/tour.sh" \
  --out "$folder/manual.html"
# Without measured data and without a controller the tour is another text: made here, too.
mkdir "$folder/programs"
ln -s "$(realpath "$programs/rigtwin")" "$folder/programs/rigtwin"
mkdir "$folder/chapters"
cp host_sim/manual/chapters/1_tour.md "$folder/chapters"
"$maker" --chapters "$folder/chapters" --rigs host_sim/rigs --programs "$folder/programs" --out "$folder/simulated.html"
! grep -q '^rig_controller' "$folder/simulated.html" || complain "a controller that is not there was run"
grep -q 'the record is simulated' "$folder/simulated.html" || complain "the manual does not say that its record is simulated"
sh -n "$folder/tour.sh"

blocks=$(grep -c '<pre class="run">' "$folder/manual.html")
effects=$(grep -c '<section class="effect"' "$folder/manual.html")
listed=$(grep -cE '^(using UsualEffects = |using SensorEffects = | +).*<S>(,|>)' model/effects/catalogue.hpp)
echo "$blocks blocks of commands, $effects effects"
[ "$blocks" -ge 15 ] || complain "  too few commands"
[ "$effects" -ge 30 ] && [ "$effects" -le "$listed" ] || complain "  not every effect of the list ($listed) has a picture"

browse() {
  timeout 120 chromium --headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
    --disable-component-update --disable-sync --user-data-dir="$folder/profile" --window-size=1280,800 --enable-logging=stderr \
    --virtual-time-budget=10000 "$@" "file://$folder/manual.html" >"$folder/out" 2>"$folder/err" ||
    { tail -n 20 "$folder/err"; echo "chromium fails"; exit 1; }
}
browse --dump-dom
if grep 'CONSOLE' "$folder/err"; then complain "  ^ the browser's console"; fi
if grep -oE '(src|href|action|poster)="[^"]*"' "$folder/manual.html" | grep -vE '^href="(#|data:,)'; then complain "  ^ asks for something from elsewhere"; fi
grep -q 'data-errors="0"' "$folder/out" || complain "  an error in the page"
browse --no-pdf-header-footer --print-to-pdf="$folder/manual.pdf"
pages=$(grep -aoE '/Type ?/Page( |/|>|$)' "$folder/manual.pdf" | wc -l)
echo "manual.html on paper: $pages pages"
[ "$pages" -ge 15 ] || complain "  too few pages"
exit $status
