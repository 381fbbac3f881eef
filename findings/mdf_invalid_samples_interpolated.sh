#!/usr/bin/env bash
# asammdf: samples that the file marks as invalid come back as plausible numbers.
#
# Expected: ASAM MDF 4 carries an invalidation bit for each sample (an overload, a lost message). In
#   a data frame such samples are missing.
# Happens: MDF.get() leaves them out. to_dataframe() puts numbers there, interpolated between the
#   valid neighbours, and beyond the last sample of a slower channel it holds the last value: no
#   cell of the frame is missing, and nothing tells measured from made.
# Matters: an overload during the ramp becomes a straight line of force. Use get() for each channel
#   with its own time stamps.
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

time = np.arange(10) * 0.1
force = np.array([0.0, 1, 2, 99, 99, 5, 6, 7, 8, 9])
invalid = force == 99
with MDF() as file:
    file.append([Signal(force, time, unit="N", name="force", invalidation_bits=invalid)])
    file.append([Signal(np.arange(3.0), np.arange(3) * 0.2, unit="mm", name="travel")])
    file.save("test.mf4")
with MDF("test.mf4") as file:
    valid = file.get("force")
    frame = file.to_dataframe()
print("asammdf", asammdf.__version__)
print("written: force", force.tolist(), "the two 99 marked as invalid; travel ends at 0.4 s")
print("get():", valid.samples.tolist())
print(frame)
assert valid.samples.tolist() == force[~invalid].tolist()
assert np.allclose(frame["force"].iloc[3:5], [3, 4])
assert not frame.isna().any().any()
assert (frame["travel"].iloc[4:] == 2).all()
PYTHON
