#!/usr/bin/env bash
# pyFRF: the correction of a late response channel makes it later still.
#
# Expected: resp_delay is documented as the delay of the response behind the excitation, in seconds,
#   and corrects the FRF: a response that was recorded 2 ms late, with resp_delay=0.002, gives the
#   FRF of the response in time.
# Happens: the FRF is that of a response 4 ms late; resp_delay=-0.002 gives the right one. Amplitude
#   and coherence are the same in all cases.
# Matters: channels of two modules, or a filter in one of them, are a reason to use it. At 12.5 Hz
#   2 ms are 9 degrees of phase, and doubled 18, which is more than the loss angle of most seals.
#   Check the phase of a mass, 0 degrees well above its resonance, before and after a correction.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "pyFRF==1.5.0" "numpy==2.2.6" "scipy==1.15.3"
cd "$folder"
venv/bin/python - <<'PYTHON'
import numpy as np
import pyFRF

RATE, COUNT, LATE, MASS = 1000, 4000, 2, 0.06  # Hz, samples, samples late, kg

force = np.zeros(COUNT)
force[100:116] = 10 * np.sin(np.pi * np.arange(16) / 16) ** 2
response = np.roll(force / MASS, LATE)  # a free mass: phase 0 at every frequency
print("pyFRF", pyFRF.__version__, "numpy", np.__version__)
print("a free mass, its acceleration recorded", LATE / RATE, "s late")
phases = {}
for delay in (0.0, LATE / RATE, -LATE / RATE):
    test = pyFRF.FRF(RATE, force, response, resp_delay=delay)
    frequency = test.get_f_axis()
    line = np.argmin(abs(frequency - 12.5))
    phases[delay] = np.degrees(np.angle(test.get_FRF(frf_form="accelerance")[0, 0, line]))
    print(f"resp_delay={delay:g}: phase at {frequency[line]:g} Hz {phases[delay]:.2f} degrees")
late = -360 * 12.5 * LATE / RATE
assert np.allclose(list(phases.values()), [late, 2 * late, 0.0], atol=1e-6)
PYTHON
