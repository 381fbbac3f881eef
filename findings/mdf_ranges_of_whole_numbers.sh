#!/usr/bin/env bash
# asammdf: a conversion by ranges gives a whole number the value of another range, or of none.
#
# Expected: "value range to value" (conversion type 6 of ASAM MDF 4) gives 0 to 4 the value 7 and 6 to
#   11 the value 9, and anything else the default. How the raw numbers are stored, as u2 or as f8,
#   decides only whether the upper limit belongs to its range.
# Happens: of floats it is so. Of whole numbers get() gives the default to 0, 1, 2 and 3, gives 7 to
#   4 and 5, the default to 6 ... 10, and 9 to 11, 12 and 13: everything inside a range but its upper limit is
#   lost, and what lies above the limit is taken for inside. asammdf wrote the file itself.
# Matters: ranges are how a logger stores the gain or the measuring range that was switched while it
#   ran. Read the raw numbers, get(raw=True), and the limits from the conversion, and apply them.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "asammdf==8.8.28" "numpy==2.2.6" "pandas==2.2.3"
cd "$folder"
venv/bin/python - <<'PYTHON'
import asammdf
import numpy as np
from asammdf import MDF, Signal

ranges = {
    "lower_0": 0.0, "upper_0": 4.0, "phys_0": 7.0,
    "lower_1": 6.0, "upper_1": 11.0, "phys_1": 9.0,
    "default": -1.0,
}
time = np.arange(14.0)
found = {}
for kind in ("u2", "f8"):
    with MDF() as file:
        file.append([Signal(time.astype(kind), time, name="gain", conversion=dict(ranges))])
        file.save("gain.mf4", overwrite=True)
    with MDF("gain.mf4") as file:
        conversion = file.groups[0].channels[1].conversion
        assert conversion.conversion_type == 6
        assert {key: conversion[key] for key in ranges} == ranges
        raw = file.get("gain", raw=True).samples
        found[kind] = file.get("gain").samples.tolist()
    assert raw.tolist() == time.tolist()
print("asammdf", asammdf.__version__, "numpy", np.__version__)
print("raw                ", time.astype(int).tolist())
print("stored as floats   ", [int(value) for value in found["f8"]])
print("stored as whole    ", [int(value) for value in found["u2"]])
print("of whole, expected ", [7] * 5 + [-1] + [9] * 6 + [-1] * 2)
assert found["f8"] == [7] * 4 + [-1] * 2 + [9] * 5 + [-1] * 3
assert found["u2"] == [-1] * 4 + [7] * 2 + [-1] * 5 + [9] * 3
PYTHON
