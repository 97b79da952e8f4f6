#!/bin/bash
# What is known of an effect stands on its card in model/effects: no source of the workbench or the firmware quotes its name.
. "$(dirname "$0")/common.bash"
places=$(sources | grep -E '^(host_sim|firmware)/')
status=0
for card in model/effects/*.hpp; do
  name=$(grep -oE '\.name = "[a-z_]+"' "$card" | head -n 1 | cut -d'"' -f2 || true)
  [ -n "$name" ] || continue
  if grep -nEH "\"$name\"" $places; then
    echo "  ^ nothing asks for an effect by its name: a field of its card says it ($card)"
    status=1
  fi
done
exit $status
