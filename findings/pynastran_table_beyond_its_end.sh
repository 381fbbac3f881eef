#!/usr/bin/env bash
# pyNastran: one frequency beyond the end of a TABLED1 changes the values at all the others.
#
# Expected: TABLED1.interpolate() gives a value for each x by itself: on the line between the two
#   points round it, and beyond the ends, as the card is defined, on the line through the two points
#   at that end.
# Happens: with one x above the last point, every answer of the call is the y of the point below its
#   x: the line becomes stairs, and at a point exactly the y of the point before. One x below the
#   first point lies on the line through the last and the first point. No warning.
# Matters: PBUSHT keeps stiffness and loss of a seal in such tables. Evaluated on a grid up to 100
#   Hz, a table that ends at 50 Hz is wrong at 12 Hz, and right there on a grid up to 50.
#   Interpolate table.x and table.y yourself.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "pyNastran==1.4.1" "numpy==1.26.4"
cd "$folder"
cat > bush.bdf <<'DECK'
CEND
BEGIN BULK
$ K' of a seal, N/m, over the frequency, Hz
PBUSHT  1       K       1
PBUSH   1       K       100.
TABLED1 1
        1.      100.    10.     190.    50.     230.    ENDT
ENDDATA
DECK
venv/bin/python -W ignore - <<'PYTHON'
import numpy as np
import pyNastran
from pyNastran.bdf.bdf import read_bdf

table = read_bdf("bush.bdf", xref=False, debug=None).tables_d[1]
print("pyNastran", pyNastran.__version__, "numpy", np.__version__)
print("points", list(zip(table.x.tolist(), table.y.tolist())))
inside = [5.5, 10.0, 30.0]
alone = table.interpolate(np.array(inside))
with_one_above = table.interpolate(np.array([*inside, 100.0]))
with_one_below = table.interpolate(np.array([0.5, *inside]))
print("at", inside, "        ", alone)
print("at", [*inside, 100.0], "  ", with_one_above, " the last should be 280")
print("at", [0.5, *inside], "    ", with_one_below, " the first should be 95")
assert alone.tolist() == [145.0, 190.0, 210.0]
assert with_one_above.tolist() == [100.0, 100.0, 190.0, 230.0]
assert with_one_below[1:].tolist() == alone.tolist()
assert abs(with_one_below[0] - np.interp(0.5, [1.0, 50.0], [100.0, 230.0])) > 0.1
assert abs(with_one_below[0] - (100.0 - 0.5 * 130.0 / 49.0)) < 1e-9
PYTHON
