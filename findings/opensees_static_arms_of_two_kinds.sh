#!/usr/bin/env bash
# OpenSees: pressed in a Static analysis, two of three Maxwell arms carry nothing, and one relaxes.
#
# Expected: a spring and a dashpot in series are one arm, whether written as the material Maxwell, as
#   ViscousDamper, or as Elastic and Viscous round a node. A static analysis driven by a time series
#   knows either no rates, and no arm carries a force, or the time of its series, and all relax.
# Happens: Maxwell takes the pseudo-time for time and relaxes as in a Transient analysis, to the last
#   digit. The velocity that the other two ask for is zero in a Static analysis: they carry nothing,
#   neither in the ramp nor in the hold. Exit status 0, no message. In Transient the three agree.
# Matters: a seal is pressed statically before a door is struck. With two forms of one arm the force
#   at the end of the ramp differs by a fifth, and the dynamic step begins from another state. Press
#   in a Transient analysis, slowly, if the relaxation is meant.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "openseespy==3.7.1.2" "numpy==2.2.6"
cd "$folder"
venv/bin/python - 2>/dev/null <<'PYTHON'
from importlib.metadata import version

import numpy as np
import openseespy.opensees as ops

K_INF, K, TAU, DEPTH, STEP = 200.0, 100.0, 0.5, 0.008, 0.01  # N/m, N/m, s, m, s; ramp of 1 s


def press(form, analysis):
    """Force at 1 and 2 s."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    for node in (1, 2, 3) if form == "network" else (1, 2):
        ops.node(node, 0.0)
    ops.fix(1, 1)
    ops.uniaxialMaterial("Elastic", 1, K_INF)
    ops.element("zeroLength", 1, 1, 2, "-mat", 1, "-dir", 1)
    if form == "network":
        ops.uniaxialMaterial("Elastic", 2, K)
        ops.uniaxialMaterial("Viscous", 3, K * TAU, 1.0)
        ops.element("zeroLength", 2, 1, 3, "-mat", 2, "-dir", 1)
        ops.element("zeroLength", 3, 3, 2, "-mat", 3, "-dir", 1)
    else:
        ops.uniaxialMaterial(form, 2, K, K * TAU, 1.0, *([1.0] if form == "Maxwell" else []))
        ops.element("zeroLength", 2, 1, 2, "-mat", 2, "-dir", 1)
    ops.timeSeries("Path", 1, "-time", 0.0, 1.0, 1e9, "-values", 0.0, DEPTH, DEPTH)
    ops.pattern("Plain", 1, 1)
    ops.sp(2, 1, 1.0)
    ops.constraints("Lagrange")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("NormDispIncr", 1e-12, 30)
    ops.algorithm("Newton")
    ops.integrator(*(("LoadControl", STEP) if analysis == "Static" else ("Newmark", 0.5, 0.25)))
    ops.analysis(analysis)
    forces = []
    for _ in range(200):
        assert ops.analyze(*((1,) if analysis == "Static" else (1, STEP))) == 0
        ops.reactions()
        forces.append(-ops.nodeReaction(1, 1))
    return forces[99], forces[199]


print("openseespy", version("openseespy"))
arm = DEPTH * K * TAU * (1 - np.exp(-1 / TAU))
right = np.array([DEPTH * K_INF + arm, DEPTH * K_INF + arm * np.exp(-1 / TAU)])
print(f"equations                 {right[0]:.3f} N at 1 s, {right[1]:.3f} N at 2 s")
for analysis in ("Transient", "Static"):
    for form in ("Maxwell", "ViscousDamper", "network"):
        found = press(form, analysis)
        print(f"{analysis:10} {form:14} {found[0]:.3f} N at 1 s, {found[1]:.3f} N at 2 s")
        carries = analysis == "Transient" or form == "Maxwell"
        assert np.allclose(found, right if carries else DEPTH * K_INF, rtol=2e-3)
PYTHON
