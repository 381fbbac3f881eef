"""UFF data set 58 of an FRF."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from dashpot.base.errors import DataError
from dashpot.base.version import byline
from dashpot.datamodel.frf import FRF, Kind
from dashpot.reading.raw_file import import_extra

_FRF, _COHERENCE = 4, 6
"""Function types of UFF's dataset 58."""
_NUMERATOR = {
    Kind.RECEPTANCE: (8, "m"),
    Kind.MOBILITY: (11, "m/s"),
    Kind.ACCELERANCE: (12, "m/s^2"),
}
_ID = 80


def frf_uff(frf: FRF, *, title: str = "dashpot FRF") -> bytes:
    """Return an FRF as UFF: 151 (header), 164 (SI units), 58 (function type 4).

    A dynamic stiffness is written as its inverse, the receptance; the coherence follows as a second
    dataset 58 (function type 6). The window's shift, the record and the number of averages are in
    the identification lines.
    """
    if frf.quantity.over_base:
        raise DataError(
            "UFF 58 is written of a motion and a force; write a transmissibility as text"
        )
    pyuff = import_extra("pyuff", "pyuff", "UFF files")
    motion = frf.to(Kind.RECEPTANCE) if frf.quantity is Kind.DYNAMIC_STIFFNESS else frf
    origin = "simulated" if any(source.simulated for source in frf.source) else "NONE"
    number, unit = _NUMERATOR[motion.quantity]
    identification = {
        "id1": title[:_ID],
        "id2": origin,
        "id3": f"shift: {float(motion.shift)!r}"[:_ID],
        "id4": "NONE" if motion.record is None else f"record: {float(motion.record)!r}"[:_ID],
        "id5": f"averages: {motion.averages}",
    }
    steps = np.diff(motion.frequency)
    is_even = bool(len(steps)) and bool(np.allclose(steps, steps[0], rtol=1e-9))
    common = {
        "type": 58, "binary": 0, **identification, "rsp_node": 1, "rsp_dir": 3, "ref_node": 1,
        "ref_dir": 3, "x": motion.frequency, "num_pts": len(motion.frequency),
        "abscissa_spacing": int(is_even), "abscissa_min": float(motion.frequency[0]),
        "abscissa_inc": float(steps[0]) if is_even else 0.0,
        "orddenom_spec_data_type": 0, "orddenom_axis_lab": "NONE",
        "orddenom_axis_units_lab": "NONE", "ordinate_spec_data_type": 0,
        "z_axis_spec_data_type": 0, "z_axis_axis_lab": "NONE", "z_axis_axis_units_lab": "NONE",
        "abscissa_spec_data_type": 18, "abscissa_axis_lab": "Frequency",
        "abscissa_axis_units_lab": "Hz",
    }  # fmt: skip
    sets = [
        pyuff.prepare_151(model_name="dashpot", description=byline(title)[:_ID], db_app="dashpot",
                          program="dashpot"),
        pyuff.prepare_164(units_code=1, units_description="SI: m, N, K", temp_mode=1, length=1.0,
                          force=1.0, temp=1.0, temp_offset=0.0),
        {**common, "func_type": _FRF, "ord_data_type": 6, "data": motion.value,
         "ordinate_spec_data_type": number, "ordinate_axis_lab": motion.quantity.value,
         "ordinate_axis_units_lab": unit, "orddenom_spec_data_type": 13,
         "orddenom_axis_lab": "force", "orddenom_axis_units_lab": "N"},
    ]  # fmt: skip
    if motion.coherence is not None:
        sets.append(
            {**common, "func_type": _COHERENCE, "ord_data_type": 4, "data": motion.coherence,
             "ordinate_axis_lab": "coherence", "ordinate_axis_units_lab": "NONE"}
        )  # fmt: skip
    with TemporaryDirectory() as folder:  # pyuff writes to a path only
        path = Path(folder, "frf.uff")
        pyuff.UFF(str(path)).write_sets(sets, mode="overwrite")
        return path.read_bytes()
