#!/usr/bin/env bash
# pyFRF: the two windows of a hammer test, force and exponential, multiply the FRF by a constant.
#
# Expected: a force window that keeps the whole pulse changes nothing; an exponential window on the
#   response of a structure adds damping, so resonances become wider and lower. Far above a
#   resonance, where the response follows the pulse, |acceleration / force| stays 1/m.
# Happens: each signal is normalised by the mean of its window, as for a sine that fills the record,
#   and the mean of the force window is taken for 1. With window=("force:0.05", "exponential:0.01")
#   the FRF is 4.65 times too large at every line, the inverse of the mean of the exponential
#   window; ("exponential:0.01", "exponential:0.01") has the right mass line. Coherence, frequency
#   and shape look as they should.
# Matters: the mass line of a hammer test is its calibration: a mass of 60 g shows as 13 g, and so
#   do the stiffness and the damping coefficient of the seal under it. Give both channels the same
#   window.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "pyFRF==1.5.0" "numpy==2.2.6" "scipy==1.15.3"
cd "$folder"
venv/bin/python - <<'PYTHON'
import numpy as np
import pyFRF
from scipy.signal import StateSpace, dlsim

RATE, COUNT = 1000, 8000  # Hz, samples
MASS, STIFFNESS, DAMPING = 0.06, 400.0, 0.2  # kg, N/m, N s/m: 13 Hz, 2 %

force = np.zeros(COUNT)
force[:16] = 10 * np.sin(np.pi * np.arange(16) / 16) ** 2
system = StateSpace(
    [[0, 1], [-STIFFNESS / MASS, -DAMPING / MASS]], [[0], [1 / MASS]],
    [[-STIFFNESS / MASS, -DAMPING / MASS]], [[1 / MASS]],
)
_, acceleration, _ = dlsim(system.to_discrete(1 / RATE, method="foh"), force)
acceleration = acceleration[:, 0]
print("pyFRF", pyFRF.__version__, "numpy", np.__version__)
mean = np.exp(np.log(0.01) * np.arange(COUNT) / (COUNT - 1)).mean()
print(f"1 / mean of exponential:0.01 = {1 / mean:.3f}")
gains = {}
for window in (
    "none",
    ("exponential:0.01", "exponential:0.01"),
    ("force:0.05", "none"),
    ("force:0.05", "exponential:0.01"),
):
    test = pyFRF.FRF(RATE, force, acceleration, window=window)
    frequency = test.get_f_axis()
    line = np.argmin(abs(frequency - 45.0))
    omega = 2 * np.pi * frequency[line]
    right = omega**2 / abs(STIFFNESS + 1j * omega * DAMPING - MASS * omega**2)
    found = abs(test.get_FRF(frf_form="accelerance")[0, 0, line])
    gains[str(window)] = gain = found / right
    print(f"{window!s:44} |A| at {frequency[line]:g} Hz: {found:6.2f} /kg, {gain:.3f} of the right one")
*same, both = gains.values()
assert all(abs(gain - 1) < 0.01 for gain in same)
assert abs(both * mean - 1) < 0.01
PYTHON
