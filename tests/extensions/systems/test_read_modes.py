"""Modes from a table and from dataset 55: the same shapes, whatever their units."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dashpot.base.errors import ReadError
from dashpot.extensions.systems.door.read_modes import read_modes

PLACE = np.array([(0, 0, 0), (1100, 0, 0), (1100, 1200, 0), (0, 1200, 5.0)])
FREQUENCY = [0.0, 30.0, 55.0]
SHAPE = np.random.default_rng(0).standard_normal((3, 4, 3))
HEAD = "mode,frequency [Hz],x [mm],y [mm],z [mm],ux,uy,uz"


def rows() -> list[str]:
    return [
        ",".join(f"{v:.9g}" for v in (r + 1, FREQUENCY[r], *PLACE[p], *SHAPE[r, p]))
        for r in range(3)
        for p in range(4)
    ]


def modes_of(folder: Path, lines: list[str], head: str = HEAD, **words):
    path = folder / "modes.csv"
    path.write_text("\n".join([head, *lines, ""]))
    return read_modes(path, **words)


def test_a_table_of_modes(tmp_path):
    modes = modes_of(tmp_path, rows())
    assert modes.frequency.tolist() == FREQUENCY
    assert modes.place == pytest.approx(PLACE / 1e3)
    assert modes.shapes == pytest.approx(SHAPE, rel=1e-8)
    assert modes.damping_ratio.tolist() == [0, 0, 0]
    in_tonnes = modes_of(tmp_path, rows(), modal_mass="1t", damping=0.02)
    assert in_tonnes.shapes == pytest.approx(SHAPE / np.sqrt(1000), rel=1e-8)
    assert in_tonnes.damping_ratio.tolist() == [0.02] * 3
    weighed = modes_of(tmp_path, [f"{row},4" for row in rows()], HEAD + ",modal mass [kg]")
    assert weighed.shapes == pytest.approx(SHAPE / 2, rel=1e-8)
    plain = HEAD.replace(" [mm]", "")
    assert modes_of(tmp_path, rows(), plain, unit="mm").place == pytest.approx(PLACE / 1e3)
    only_z = modes_of(tmp_path, [r.replace(",", ",", 1) for r in rows()], HEAD.replace("ux", "a"))
    assert only_z.shapes[:, :, 0].tolist() == [[0] * 4] * 3


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda lines: lines[:-1], "the modes have 3 to 4 points"),
        (lambda lines: [*lines[:-1], lines[-1].replace("55", "56", 1)], "one mode has two freq"),
        (lambda lines: [*lines[:4], lines[5], lines[4], *lines[6:]], "differ in their points"),
        (lambda lines: [*lines[:-1], lines[-1].rpartition(",")[0] + ","], "line 13 lacks a number"),
    ],
)
def test_modes_that_do_not_fit_together_are_refused(tmp_path, change, sentence):
    with pytest.raises(ReadError, match=sentence):
        modes_of(tmp_path, change(rows()))


@pytest.mark.parametrize(
    ("head", "sentence"),
    [
        (HEAD.replace("mode", "number"), "no column is named mode"),
        (HEAD.replace("ux,uy,uz", "a,b,c"), "no column is named ux, uy or uz"),
        (HEAD.replace(" [mm]", ""), r"column x has no unit; write x \[mm\]"),
        (HEAD.replace("uz", "modal mass"), "the modal masses have no unit"),
        (HEAD.replace("uz", "modal mass [kg]"), "a modal mass is -"),
    ],
)
def test_what_a_table_of_modes_must_say(tmp_path, head, sentence):
    with pytest.raises(ReadError, match=sentence):
        modes_of(tmp_path, rows(), head)


@pytest.mark.parametrize("nodes", [15, 2411])
def test_dataset_55_in_mm_t_s_is_the_same(tmp_path, nodes):
    """A modal mass in t, and coordinates in mm, as dataset 164 says."""
    pyuff = pytest.importorskip("pyuff")
    labels = np.arange(1, 5)
    axes = dict(zip("xyz", PLACE.T, strict=True))
    plain = {name: np.zeros(4, dtype=int) for name in ("def_cs", "disp_cs", "color")}
    sets = [
        {"type": 164, "units_code": 9, "units_description": "mm-t-s", "temp_mode": 1,
         "length": 1000.0, "force": 1.0, "temp": 1.0, "temp_offset": 0.0},
        {"type": nodes, "node_nums": labels, **plain, **axes},
        *({"type": 55, "analysis_type": 2, "data_ch": 2, "spec_data_type": 8, "load_case": 0,
           "mode_n": r + 1, "freq": FREQUENCY[r], "modal_m": 4e-3, "modal_damp_vis": 0.0,
           "modal_damp_his": 0.03, "node_nums": labels,
           **{f"r{i + 1}": SHAPE[r, :, i] for i in range(3)}} for r in range(3)),
    ]  # fmt: skip
    path = tmp_path / "door.unv"
    pyuff.UFF(str(path)).write_sets(sets, "add")
    modes = read_modes(path)
    assert modes.frequency.tolist() == FREQUENCY
    assert modes.place == pytest.approx(PLACE / 1e3)
    assert modes.shapes == pytest.approx(SHAPE / 2, rel=1e-5)
    assert modes.damping_ratio == pytest.approx(0.015)
    bare = tmp_path / "bare.unv"
    pyuff.UFF(str(bare)).write_sets(sets[1:], "add")
    with pytest.raises(ReadError, match="modal masses have no unit"):
        read_modes(bare)
    message = read_modes(bare, unit="mm", modal_mass="4kg")
    assert (message.shapes == modes.shapes).all()
    pyuff.UFF(str(tmp_path / "shapes.unv")).write_sets(sets[2:], "add")
    with pytest.raises(ReadError, match="node 1 of mode 1 has no coordinates"):
        read_modes(tmp_path / "shapes.unv")
