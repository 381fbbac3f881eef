#!/usr/bin/env bash
# npTDMS: as_dataframe(time_index=True) puts one instant into two rows, and leaves out start times.
#
# Expected: channels of two rates, joined by their clocks, share the rows of common instants; a
#   channel whose wf_start_time is 100 ms later stands 100 ms later.
# Happens: the axis of each channel is a linspace of floats, and they are joined by equality: 0.7 s
#   of one and 0.7 s of the other differ in the last bit and become two rows, each half empty. The
#   instant 0.9 s is one row. wf_start_time is not used: the late channel stands where the other does.
# Matters: dropna() loses rows without a pattern that one sees, and a displacement that was started
#   100 ms after the force is paired with the wrong force. Interpolate on clocks built from start
#   time, offset and increment.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "npTDMS==1.10.0" "numpy==2.2.6" "pandas==2.2.3"
cd "$folder"
venv/bin/python - <<'PYTHON'
import nptdms
import numpy as np
from nptdms import ChannelObject, TdmsFile, TdmsWriter

start = np.datetime64("2026-01-05T10:00:00.000")
force = {"wf_increment": 0.1, "wf_start_offset": 0.0, "wf_start_time": start}
travel = {
    "wf_increment": 0.2,
    "wf_start_offset": 0.5,
    "wf_start_time": start + np.timedelta64(100, "ms"),
}
with TdmsWriter("two.tdms") as writer:
    writer.write_segment(
        [
            ChannelObject("test", "force", np.arange(10.0), force),
            ChannelObject("test", "travel", np.arange(3.0), travel),
        ]
    )
frame = TdmsFile.read("two.tdms")["test"].as_dataframe(time_index=True)
print("npTDMS", nptdms.__version__)
print(frame.loc[0.45:])
near = [time for time in frame.index if abs(time - 0.7) < 1e-9]
assert len(near) == 2, near
assert len([time for time in frame.index if abs(time - 0.9) < 1e-9]) == 1
assert frame["travel"].first_valid_index() == 0.5  # 0.6 s after the start of the force
PYTHON
