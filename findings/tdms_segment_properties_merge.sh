#!/usr/bin/env bash
# npTDMS: one time axis for a channel whose segments were sampled at two rates.
#
# Expected: TDMS keeps properties by segment. A file whose second segment states another
#   wf_increment (a test that goes on slower in the hold) is refused, warned of, or each segment
#   keeps its own clock.
# Happens: properties are merged, the last one wins for the whole channel, without a warning. The
#   first ten samples, taken every 10 ms, come back 100 ms apart; a unit that changes does likewise.
# Matters: a ramp of 0.1 s becomes one of 1 s, and every relaxation time of the first segment is
#   ten times too long. Compare the properties segment by segment before you trust time_track().
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

with TdmsWriter("hold.tdms") as writer:
    for step, unit in ((0.01, "N"), (0.1, "kN")):
        properties = {"wf_increment": step, "wf_start_offset": 0.0, "unit_string": unit}
        writer.write_segment([ChannelObject("test", "force", np.arange(10.0), properties)])
channel = TdmsFile.read("hold.tdms")["test"]["force"]
steps = np.diff(channel.time_track())
print("npTDMS", nptdms.__version__)
print("written: 10 samples 0.01 s apart in N, then 10 samples 0.1 s apart in kN")
print("read: steps of", sorted(set(steps.round(6))), "s; unit", channel.properties["unit_string"])
assert np.allclose(steps, 0.1)
assert channel.properties["unit_string"] == "kN"
PYTHON
