#!/usr/bin/env bash
# pyvisq: parameters that are set on a model reach its creep compliance, not its relaxation modulus.
#
# Expected: model.params = new makes G(t) and J(t) those of the new parameters, as it does the
#   printed model, and as those of a model that is built from them. G(0) J(0) is 1 of any solid.
# Happens: the arms were built from the first parameters and are not built again, so G(t) and every
#   relaxation test that is run stays that of the old ones, while J(t) reads the new ones. At a time
#   that was asked for before, J(t) is old as well: it is remembered by time.
# Matters: a fit that sets parameters in a loop sees a modulus that does not answer, and stops where
#   it began; a model that is softened by half predicts the creep of one seal and the relaxation of
#   another. Build a new model for each set of parameters.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "pyvisq==1.2.2" "numpy==2.2.6" "scipy==1.15.3" "mpmath==1.3.0"
cd "$folder"
venv/bin/python - <<'PYTHON'
from importlib.metadata import version

from pyvisq.models.elements import DashpotParams, SpringParams
from pyvisq.models.zener import SLS, SLSParams


def solid(k_inf, k, b):
    return SLSParams(dashpot_a=DashpotParams(b), spring_b=SpringParams(k), spring_c=SpringParams(k_inf))


print("pyvisq", version("pyvisq"), "- N/m, N s/m, s")
model = SLS(solid(200.0, 100.0, 50.0))
before = model.J(1.0)
print(f"k_inf 200, k 100, b 50:            G(0) {model.G(0.0):.1f}, 1/J(0) {1 / model.J(0.0):.1f}")
model.params = solid(100.0, 50.0, 25.0)
fresh = SLS(solid(100.0, 50.0, 25.0))
g, j = model.G(1e-9), model.J(1e-9)
print(f"k_inf 100, k 50, b 25, set:        G(0) {g:.1f}, 1/J(0) {1 / j:.1f}")
print(f"k_inf 100, k 50, b 25, built anew: G(0) {fresh.G(1e-9):.1f}, 1/J(0) {1 / fresh.J(1e-9):.1f}")
print(f"J(1 s) before {before:.6f}, set {model.J(1.0):.6f}, built anew {fresh.J(1.0):.6f} m/N")
assert model.params == fresh.params
assert abs(fresh.G(1e-9) * fresh.J(1e-9) - 1) < 1e-6
assert abs(g * j - 2) < 1e-6
assert model.J(1.0) == before != fresh.J(1.0)
PYTHON
