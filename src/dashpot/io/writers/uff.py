"""An FRF to a universal file: datasets 151, 164 and 58."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dashpot.io.formats.uff import COHERENCE, FRF_
from dashpot.io.source import extra
from dashpot.records.frf import FRF, Kind

_NUMERATOR = {
    Kind.RECEPTANCE: (8, "m"),
    Kind.MOBILITY: (11, "m/s"),
    Kind.ACCELERANCE: (12, "m/s^2"),
}
_ID = 80


def write_frf_uff(frf: FRF, path: str | Path, *, title: str = "dashpot FRF") -> None:
    """Write an FRF to `path` as UFF: 151 (header), 164 (SI units), 58 (function type 4).

    A dynamic stiffness is written as its inverse, the receptance; the coherence follows as a
    second dataset 58 (function type 6). The window's shift, the record and the number of averages
    stand in the identification lines.
    """
    pyuff = extra("pyuff", "pyuff", f"{path}: UFF files")
    motion = frf.to(Kind.RECEPTANCE) if frf.kind is Kind.DYNAMIC_STIFFNESS else frf
    stamp = "simulated" if any(source.simulated for source in frf.source) else "NONE"
    number, unit = _NUMERATOR[motion.kind]
    identification = {
        "id1": title[:_ID],
        "id2": stamp,
        "id3": f"shift: {float(motion.shift)!r}"[:_ID],
        "id4": "NONE" if motion.record is None else f"record: {float(motion.record)!r}"[:_ID],
        "id5": f"averages: {motion.averages}",
    }
    steps = np.diff(motion.frequency)
    even = bool(len(steps)) and bool(np.allclose(steps, steps[0], rtol=1e-9))
    common = {
        "type": 58, "binary": 0, **identification, "rsp_node": 1, "rsp_dir": 3, "ref_node": 1,
        "ref_dir": 3, "x": motion.frequency, "num_pts": len(motion.frequency),
        "abscissa_spacing": int(even), "abscissa_min": float(motion.frequency[0]),
        "abscissa_inc": float(steps[0]) if even else 0.0,
        "orddenom_spec_data_type": 0, "orddenom_axis_lab": "NONE",
        "orddenom_axis_units_lab": "NONE", "ordinate_spec_data_type": 0,
        "z_axis_spec_data_type": 0, "z_axis_axis_lab": "NONE", "z_axis_axis_units_lab": "NONE",
        "abscissa_spec_data_type": 18, "abscissa_axis_lab": "Frequency",
        "abscissa_axis_units_lab": "Hz",
    }  # fmt: skip
    sets = [
        pyuff.prepare_151(model_name="dashpot", description=title[:_ID], db_app="dashpot",
                          program="dashpot"),
        pyuff.prepare_164(units_code=1, units_description="SI: m, N, K", temp_mode=1, length=1.0,
                          force=1.0, temp=1.0, temp_offset=0.0),
        {**common, "func_type": FRF_, "ord_data_type": 6, "data": motion.value,
         "ordinate_spec_data_type": number, "ordinate_axis_lab": motion.kind.value,
         "ordinate_axis_units_lab": unit, "orddenom_spec_data_type": 13,
         "orddenom_axis_lab": "force", "orddenom_axis_units_lab": "N"},
    ]  # fmt: skip
    if motion.coherence is not None:
        sets.append(
            {**common, "func_type": COHERENCE, "ord_data_type": 4, "data": motion.coherence,
             "ordinate_axis_lab": "coherence", "ordinate_axis_units_lab": "NONE"}
        )  # fmt: skip
    Path(path).unlink(missing_ok=True)
    file = pyuff.UFF(str(path))
    file.write_sets(sets, mode="overwrite")
