#!/usr/bin/env bash
# asammdf: joining two files gives the second one the units and the scale of the first.
#
# Expected: MDF.concatenate puts files with the same groups and channels one after the other. Two files
#   of one logger, the measuring range switched between them, hold the same channel with another
#   factor, or in kN after N. Joined, each sample keeps its physical value, or the call refuses.
# Happens: the raw numbers of the second file go under the conversion of the first, 3 N become 3000 N,
#   and numbers in kN go under N. No exception; the unit of the result is that of the first file.
# Matters: an auto-ranging amplifier makes such files. Read each file with get(), convert, and join
#   the arrays.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "asammdf==8.8.28" "numpy==2.2.6" "pandas==2.2.3"
cd "$folder"
venv/bin/python - <<'PYTHON'
import asammdf
import numpy as np
from asammdf import MDF, Signal

time = np.arange(4.0)


def write(path, samples, unit, factor=None):
    conversion = None if factor is None else {"a": factor, "b": 0.0}
    with MDF() as file:
        file.append([Signal(samples, time, unit=unit, name="force", conversion=conversion)])
        file.save(path, overwrite=True)
    with MDF(path) as file:
        alone = file.get("force")
    print(path, alone.samples.tolist(), alone.unit)
    return alone


def join(*paths):
    with MDF.concatenate(list(paths)) as file:
        joined = file.get("force")
        print("joined", *paths, joined.samples.tolist(), joined.unit)
        return joined


print("asammdf", asammdf.__version__, "numpy", np.__version__)
counts = np.array([0, 1000, 2000, 3000], dtype=np.int16)
coarse = write("coarse.mf4", counts, "N", 1.0)
fine = write("fine.mf4", counts, "N", 0.001)
joined = join("coarse.mf4", "fine.mf4")
assert np.allclose(fine.samples, [0, 1, 2, 3])
assert joined.samples.tolist() == [0, 1000, 2000, 3000, 0, 1000, 2000, 3000]

newton = write("newton.mf4", np.array([100.0, 200, 300, 400]), "N")
kilo = write("kilo.mf4", np.array([0.1, 0.2, 0.3, 0.4]), "kN")
joined = join("newton.mf4", "kilo.mf4")
assert (newton.unit, kilo.unit, joined.unit) == ("N", "kN", "N")
assert joined.samples.tolist() == [100, 200, 300, 400, 0.1, 0.2, 0.3, 0.4]
PYTHON
