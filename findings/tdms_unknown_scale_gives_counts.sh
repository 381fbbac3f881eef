#!/usr/bin/env bash
# npTDMS: raw counts under the unit of the scaled value.
#
# Expected: a channel whose scaling the reader does not know cannot be read, for its values are
#   counts of a converter.
# Happens: one line goes to the log of the library. The array holds the counts, unscaled, and
#   unit_string still says N.
# Matters: a program that does not look at that log shows 16384 counts as 16384 N. Ask the
#   properties NI_Scale[i]_Scale_Type yourself, and refuse what is not known.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "npTDMS==1.10.0" "numpy==2.2.6"
cd "$folder"
venv/bin/python - <<'PYTHON'
import nptdms
import numpy as np
from nptdms import ChannelObject, TdmsFile, TdmsWriter

counts = np.array([0, 8192, 16384], dtype=np.int16)
properties = {
    "unit_string": "N",
    "NI_Number_Of_Scales": 1,
    "NI_Scaling_Status": "unscaled",
    "NI_Scale[0]_Scale_Type": "Reciprocal",
    "NI_Scale[0]_Reciprocal_Slope": 2.0,
}
with TdmsWriter("cell.tdms") as writer:
    writer.write_segment([ChannelObject("test", "force", counts, properties)])
channel = TdmsFile.read("cell.tdms")["test"]["force"]
print("npTDMS", nptdms.__version__)
print("written: counts", counts.tolist(), "under a scale of a type that the library does not know")
print("read:", channel[:].tolist(), channel.properties["unit_string"])
assert channel[:].tolist() == counts.tolist()
assert channel.properties["unit_string"] == "N"
PYTHON
