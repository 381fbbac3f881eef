#!/usr/bin/env bash
# pyFRF and pyuff: a receptance that is not known at 0 Hz is 0 in the UFF file, a rigid support.
#
# Expected: an FRF of force and acceleration says nothing of 0 Hz: pyFRF gives nan there. A file
#   either keeps the nan, leaves out the line, or the writer refuses.
# Happens: write_sets() of pyuff turns each nan into 0.0
#   without a word. The file, ASCII or binary, has a receptance of 0 m/N at 0 Hz, which is an
#   infinite stiffness, as a measured value, and so has any line that somebody set to nan because
#   its coherence was bad. The accelerance is 0 there, too, where 0 happens to be right.
# Matters: K' over frequency, 1/H, begins at infinity or, smoothed or interpolated to the first
#   lines, far too high; a dead line is a dip of the FRF. Leave out the lines before you write.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "pyFRF==1.5.0" "pyuff==2.5.8" "numpy==2.2.6" "scipy==1.15.3"
cd "$folder"
venv/bin/python -W ignore - <<'PYTHON'
from importlib.metadata import version

import numpy as np
import pyFRF
import pyuff

RATE, COUNT, MASS = 1000, 4000, 0.06  # Hz, samples, kg
force = np.zeros(COUNT)
force[100:116] = 10 * np.sin(np.pi * np.arange(16) / 16) ** 2
test = pyFRF.FRF(RATE, force, force / MASS)  # a free mass
frequency, receptance = test.get_f_axis(), test.get_FRF(frf_form="receptance")[0, 0]
receptance[8] = np.nan  # 2 Hz, left out by hand
print("pyFRF", pyFRF.__version__, "pyuff", version("pyuff"), "numpy", np.__version__)
print("receptance, m/N, at", frequency[[0, 1, 8]], "Hz:", receptance[[0, 1, 8]])
for binary in (0, 1):
    frf = {
        "type": 58, "func_type": 4, "binary": binary, "id1": "free mass", "rsp_node": 1, "rsp_dir": 3,
        "ref_node": 1, "ref_dir": 3, "abscissa_spacing": 1, "abscissa_spec_data_type": 18,
        "ordinate_spec_data_type": 8, "orddenom_spec_data_type": 13, "x": frequency, "data": receptance,
    }
    pyuff.UFF(f"{binary}.uff").write_sets([frf], "add")
    back = pyuff.UFF(f"{binary}.uff").read_sets()["data"]
    print("in the file,", "binary:" if binary else "ASCII: ", back[[0, 1, 8]])
    assert back[0] == 0 and back[8] == 0
    assert np.allclose(back[1], receptance[1], rtol=1e-9)
assert np.isnan(receptance[[0, 8]]).all()
PYTHON
