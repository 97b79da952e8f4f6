#!/bin/bash
# notebook.bash BUILD PYTHON [WRITE] -- the manual's notebook runs from its first cell to its last, and its cells show what stands in it.
# WRITE: what they show is written into it.
. "$(dirname "$0")/common.bash"
python=$2
for part in nbconvert ipykernel pandas scipy; do
  "$python" -c "import $part" 2>/dev/null || skip "$part is missing (toolchains/setup checks installs it)"
done
PYTHONPATH=$(realpath "$1")/python
export PYTHONPATH PYDEVD_DISABLE_FILE_VALIDATION=1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export HOME=$folder IPYTHONDIR=$folder
"$python" -m nbconvert --log-level ERROR --to notebook --execute --output-dir "$folder" --output made.ipynb host_sim/manual/tour.ipynb
"$python" - host_sim/manual/tour.ipynb "$folder/made.ipynb" "${3-}" <<'END'
import json, sys

written, made = (json.load(open(file)) for file in sys.argv[1:3])


def shown(cell):
    texts = [o.get("text") or o["data"]["text/plain"] for o in cell["outputs"]]
    return "".join("".join(text) for text in texts).splitlines()


if sys.argv[3:] == ["WRITE"]:
    for cell, new in zip(written["cells"], made["cells"]):
        if cell["cell_type"] == "code":
            cell["outputs"] = [{"name": "stdout", "output_type": "stream", "text": "\n".join(shown(new))}] if shown(new) else []
    json.dump(written, open(sys.argv[1], "w"), indent=1, ensure_ascii=False)
    sys.exit()
differences = [(old["source"], shown(old), shown(new)) for old, new in zip(written["cells"], made["cells"])
               if old["cell_type"] == "code" and shown(old) != shown(new)]
for source, old, new in differences:
    print("".join(source), "\n  shows", new, "\n  tour.ipynb has", old)
print(f"{len(made['cells'])} cells")
sys.exit(bool(differences) or not any(shown(c) for c in written["cells"] if c["cell_type"] == "code"))
END
