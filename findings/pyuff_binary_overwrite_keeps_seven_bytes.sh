#!/usr/bin/env bash
# pyuff: a binary data set 58 that is written with mode "overwrite" is gone.
#
# Expected: write_sets(sets, "overwrite") makes a new file with these sets, ASCII or binary as each
#   set says; mode "add" into a new file gives the same file.
# Happens: to write the binary part the file is opened a second time for overwriting, which empties
#   it, and a third time for the line that closes the set. What stays is that line, 7 bytes: no
#   header, no value, no exception, and get_set_types() of it is an empty list. ASCII sets are
#   right, and so is mode "add".
# Matters: FRFs of a hammer test are written binary because they are large, and "overwrite" is the
#   mode of a script that runs twice. Remove the file and use "add", and read back what was written.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "pyuff==2.5.8" "numpy==2.2.6"
cd "$folder"
venv/bin/python - <<'PYTHON'
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pyuff

frequency = np.arange(1.0, 101.0)
accelerance = frequency**2 / (170.0 - frequency**2 + 3j * frequency)


def frf(binary):
    return {
        "type": 58, "func_type": 4, "binary": binary, "id1": "hammer test", "rsp_node": 1, "rsp_dir": 3,
        "ref_node": 2, "ref_dir": 3, "abscissa_spacing": 1, "abscissa_spec_data_type": 18,
        "ordinate_spec_data_type": 12, "orddenom_spec_data_type": 13, "x": frequency, "data": accelerance,
    }


print("pyuff", version("pyuff"), "numpy", np.__version__)
sizes = {}
for binary in (0, 1):
    for mode in ("add", "overwrite"):
        path = Path(f"{binary}{mode}.uff")
        pyuff.UFF(str(path)).write_sets([frf(binary)], mode)
        sizes[binary, mode] = path.stat().st_size
        found = pyuff.UFF(str(path)).get_set_types()
        print(f"binary={binary} mode={mode!r}: {sizes[binary, mode]} bytes, sets read back: {list(found)}")
assert sizes[0, "add"] == sizes[0, "overwrite"]
assert sizes[1, "add"] > 1600 and sizes[1, "overwrite"] == 7
assert Path("1overwrite.uff").read_text() == "    -1\n"
PYTHON
