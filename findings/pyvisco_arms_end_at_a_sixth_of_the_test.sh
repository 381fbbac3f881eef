#!/usr/bin/env bash
# pyvisco: a relaxation test of 40 s is fitted with arms up to 1 s.
#
# Expected: relaxation times are spread over the time of the test; an arm of 16 s in a hold of 40 s
#   is found, as it has relaxed to a tenth at its end.
# Happens: time is turned into a frequency, f = 1/t, and that into a relaxation time, 1/(2 pi f), so
#   the slowest arm is at the end of the test over 6.28; window="round" (the default) goes on to the
#   power of ten below, 1 s. "exact" ends at 6.4 s, and so does "min", which moves the times. What an arm of 16.4 s gave goes into the equilibrium modulus and into the fast arms;
#   nothing is said of it.
# Matters: the long end is what decides the force of a seal after hours. Write longer times into the
#   column tau_i of what discretize() returns, before the fit.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "pyvisco==2.1.3" "numpy==2.2.6" "pandas==2.2.3" "scipy==1.15.3"
cd "$folder"
MPLBACKEND=Agg venv/bin/python -W ignore - <<'PYTHON'
from importlib.metadata import version

import numpy as np
import pyvisco as visco

E_INF, ARMS = 0.2, {0.5: 0.12, 16.4: 0.018}  # MPa; s: MPa
time = np.geomspace(0.01, 40.0, 200)
modulus = E_INF + sum(e * np.exp(-time / tau) for tau, e in ARMS.items())
table = "t,E_relax\ns,MPa\n" + "".join(f"{t},{e}\n" for t, e in zip(time, modulus))
print("pyvisco", version("pyvisco"))
print(f"a hold from 0.01 to 40 s; E_inf {E_INF}, arms of", list(ARMS), "s")
slowest = {}
for window in ("round", "exact", "min", "by hand"):
    curve, _ = visco.load.user_master(table.encode(), "time", 23, "E")
    curve = visco.master.smooth(curve, 1)
    points = visco.prony.discretize(curve, "exact" if window == "by hand" else window, 4)
    if window == "round":
        points = visco.prony.discretize(curve)
    if window == "by hand":
        points["tau_i"] = [16.4, 3.0, 0.5, 0.1]
    series, _ = visco.prony.fit(points, curve, opt=window == "min")
    terms = series["df_terms"]
    fitted = series["E_0"] * (1 - terms["alpha_i"].sum())
    slowest[window] = terms["tau_i"].max()
    print(f"{window}: relaxation times {terms['tau_i'].round(4).tolist()} s, E_inf {fitted:.4f}")
assert abs(slowest["round"] - 1.0) < 1e-9
assert slowest["min"] < 40 / (2 * np.pi) + 1e-3
assert abs(slowest["exact"] - 40 / (2 * np.pi)) < 1e-3
PYTHON
