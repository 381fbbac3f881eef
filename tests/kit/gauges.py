"""A transducer of six gauge voltages, and its calibration as ATI writes it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dashpot.extensions.formats.ati import AXES

SHIFT = 6.096  # mm along z, a plausible tool face


def cal(
    path: Path, *, version: str, torque: str = "N-mm", distance: str = "mm", turn: str = "0"
) -> np.ndarray:
    """Write a calibration file; return the matrix in N/V and N m/V that it stands for."""
    rng = np.random.default_rng(5)
    inner = rng.normal(size=(6, 6)) * 20.0  # about the transducer's origin, N and N mm
    tool = inner.copy()
    # T' = T - d x F with d along z: (-z Fy, z Fx, 0)
    tool[3] += SHIFT * inner[1]
    tool[4] -= SHIFT * inner[0]
    scale = np.array([5.6, 5.6, 2.9, 0.9, 0.9, 0.78])
    to_file = {"N-mm": 1.0, "N-m": 1e-3}[torque]
    length = {"mm": 1.0, "m": 1e-3}[distance]

    def rows(name: str, matrix: np.ndarray, scales: np.ndarray | None) -> str:
        units = np.repeat([1.0, to_file], 3)
        return "".join(
            f'<{name} Name="{axis}" values="{" ".join(f"{v:.12g}" for v in row)}" max="{limit}"'
            + (f' scale="{s:.12g}"' if scales is not None else "") + "/>"
            for axis, row, limit, s in zip(
                AXES, matrix * (units * (scale if scales is not None else 1))[:, None],
                (50, 50, 70, *(500 * to_file,) * 3), scale, strict=True,
            )
        )  # fmt: skip

    text = (
        '<?xml version="1.0" encoding="utf-8"?>\n<!-- NOTE -->\n'
        f'<FTSensor Serial="FT00001" BodyStyle="Nano17" NumGages="6" CalFileVersion="{version}">'
        f'<Calibration PartNumber="SI-50-0.5" CalDate="1/2/2011" '
        f'ForceUnits="N" TorqueUnits="{torque}" '
        f'DistUnits="{distance}" OutputRange="20">{rows("Axis", inner, scale)}'
        f'<BasicTransform Dx="0" Dy="0" Dz="{SHIFT * length}" Rx="{turn}" Ry="0" Rz="0"/>'
        + (rows("UserAxis", tool, None) if version == "1.1" else "")
        + "</Calibration></FTSensor>"
    )
    path.write_text(text)
    return tool * np.repeat([1.0, 1e-3], 3)[:, None]
