#!/bin/bash
# report.bash RIGTWIN -- what rigtwin writes as pages is opened in a browser: every figure drawn, no error, nothing fetched;
# on a laptop, on a phone, on paper.
. "$(dirname "$0")/common.bash"
rigtwin=$1
need chromium

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$rigtwin" paper --out "$folder" >"$folder/paper.txt"
"$rigtwin" stability --rig host_sim/rigs/paper_hil_fdva.toml --map tau=0:0.03:60,virtual_damping=0:2000:60 \
  --sweep virtual_damping=0:2000:41 --sweep tau=0:0.02:21 --amplitude 0.02 \
  --report "$folder/stability.html" >"$folder/stability.txt"
sed '/^\[effects.coulomb_friction\]/,/^$/d' host_sim/rigs/paper_bench_fdva.toml >"$folder/bench.toml"
"$rigtwin" simulate --rig host_sim/rigs/paper_bench_fdva.toml --duration 8 --out "$folder/bench.csv" >"$folder/bench.txt"
"$rigtwin" diagnose --rig "$folder/bench.toml" --data "$folder/bench.csv" --out "$folder/diagnosis" >"$folder/diagnosis.txt"
mv "$folder/diagnosis/report.html" "$folder/diagnosis.html"
"$rigtwin" show "$folder/bench.csv" --rig "$folder/bench.toml" --report "$folder/show.html" >"$folder/show.txt"
"$rigtwin" compare --rig "$folder/bench.toml" --data "$folder/bench.csv" --report "$folder/compare.html" >"$folder/compare.txt"

# browse PAGE WIDTH,HEIGHT OPTION… -- opens a page; what the browser prints is in out and err.
browse() {
  local page=$1 size=$2
  shift 2
  timeout 120 chromium --headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
    --disable-component-update --disable-sync --user-data-dir="$folder/profile" --window-size="$size" --enable-logging=stderr \
    --virtual-time-budget=20000 "$@" "file://$folder/$page" >"$folder/out" 2>"$folder/err" ||
    { tail -n 20 "$folder/err"; echo "chromium fails"; exit 1; }
}

status=0
complain() {
  echo "$*"
  status=1
}

# attribute NAME -- of the page's body, as the page left it
attribute() {
  grep -o '<body [^>]*>' "$folder/out" | head -n 1 | sed -n "s/.* data-$1=\"\([0-9]*\)\".*/\1/p"
}

# examine PAGE WIDTH,HEIGHT [FEWEST FIGURES, default 5]
examine() {
  browse "$1" "$2" --dump-dom
  local figures svgs
  figures=$(attribute figures)
  svgs=$(grep -o 'class="main-svg"' "$folder/out" | wc -l)
  echo "$1 at $2: $figures figures, $(attribute drawn) drawn, $(attribute traces) with something in them, $svgs drawings," \
    "$(attribute requests) requests, $(attribute errors) errors"
  [ "${figures:-0}" -ge "${3:-5}" ] || complain "  too few figures"
  [ "$(attribute drawn)" = "$figures" ] || complain "  not every figure is drawn"
  [ "$(attribute traces)" = "$figures" ] || complain "  a figure is empty"
  [ "$svgs" -ge "$figures" ] || complain "  fewer drawings than figures"
  [ "$(attribute errors)" = 0 ] || complain "  an error, or words to the console that say so"
  [ "$(attribute requests)" = 0 ] || complain "  something was fetched"
  if grep 'CONSOLE' "$folder/err"; then complain "  ^ the browser's console"; fi
  # What the page names elsewhere: links within it and pictures in it, nothing else. (Plotly's own text holds templates.)
  if sed '/^<script>\/\*\*/,/<\/script>/d' "$folder/$1" | grep -oE '(src|href|action|poster)="[^"]*"' | grep -vE '^href="(#|data:,)'; then
    complain "  ^ asks for something from elsewhere"
  fi
  if sed -n '/<style>/,/<\/style>/p' "$folder/$1" | grep -E '@import|url\('; then complain "  ^ so does its style"; fi
}

examine report.html 1366,768
examine stability.html 390,844
examine diagnosis.html 1366,768
examine show.html 820,1180 2
examine compare.html 1280,800 4

# print_out PAGE -- figures stay whole, so there are pages; two fit on one, so there are not many.
print_out() {
  browse "$1" 1366,768 --no-pdf-header-footer --print-to-pdf="$folder/paper.pdf"
  if grep 'CONSOLE' "$folder/err"; then complain "  ^ the browser's console while printing"; fi
  local pages figures
  pages=$(grep -aoE '/Type ?/Page( |/|>|$)' "$folder/paper.pdf" | wc -l)
  figures=$(grep -c '<figure ' "$folder/$1")
  echo "$1 on paper: $pages pages with $figures figures"
  [ "$((2 * pages))" -ge "$figures" ] || complain "  too few pages"
  [ "$pages" -le "$((figures + 4))" ] || complain "  too many pages"
}
print_out report.html
print_out stability.html
print_out diagnosis.html
exit $status
