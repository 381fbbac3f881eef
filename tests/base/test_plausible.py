"""The table of plausible sizes: its lower and upper limits, and real tests inside them."""

from __future__ import annotations

from dataclasses import fields

import pytest

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.base.value_ranges import SIZES, format_quantity_short
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.materials.indentation.indenter import Indenter
from dashpot.planning.plan_options import HammerPlan, PlannedRamp

ENDS = {
    "travel": (1e-9, 0.5), "force": (1e-13, 2e5), "stiffness": (0.05, 1e9), "ramp": (1e-4, 900),
    "record": (1e-3, 3e7), "amplitude": (1e-12, 0.2), "modulus": (10, 2e9),
    "contact pressure": (0, 2e8), "radius": (1e-9, 1), "part": (1e-4, 30), "door": (0.02, 30),
    "seal length": (1e-4, 5), "seal height": (1e-4, 0.5), "sag": (0, 0.2), "resonance": (0.2, 2e4),
    "acceleration": (0, 1e7), "mass": (1e-9, 1e3), "density": (5, 2e4), "shear": (0, 3),
    "delay": (0, 10),
}  # fmt: skip


def test_plausible_sizes_match_the_typed_limits():
    assert {name: row.hard for name, row in SIZES.items()} == ENDS


@pytest.mark.parametrize("name", SIZES)
def test_each_end_is_the_last_that_passes(name):
    row = SIZES[name]
    for low, high, function in ((*row.hard, row.absurd), (*row.soft, row.unusual)):
        for inside in (low * 1.001, high * 0.999, -high * 0.999, 0.0, float("nan")):
            assert not function(inside), inside
        assert function(high * 1.001)
        assert not low or function(low * 0.999)
    assert row.hard[0] <= row.soft[0] < row.soft[1] <= row.hard[1]


def test_real_tests_pass_and_slips_do_not():
    for name, size in (
        ("force", 40e3), ("ramp", 315.0), ("travel", 0.401), ("record", 86400.0),
        ("record", 3.6e6), ("mass", 0.104),
        # of the labs whose stated units were asked about once
        ("force", 8.4e3), ("force", 38.8e3), ("ramp", 236.0), ("ramp", 306.0), ("travel", 0.201),
        # of a cantilever in nN, and of a fibre in uN
        ("force", 2e-9), ("travel", 1e-6), ("force", 5e-4), ("ramp", 0.1), ("ramp", 100.0),
    ):  # fmt: skip
        SIZES[name].refuse(size)
    for name, size in (
        ("travel", 8.0), ("travel", 1.0), ("mass", 5e3), ("modulus", 4e9), ("radius", 5.0),
        ("contact pressure", 649e6), ("door", 2e-3), ("sag", 2.6), ("ramp", 1e3),
        # 20 N for 20 mN of a shaker, kN for N of a cell, Pa for MPa of a rubber
        ("amplitude", 8.71), ("force", 1.57e6), ("modulus", 2.0),
    ):  # fmt: skip
        with pytest.raises(DataError, match=r"expected .* to .*Check"):
            SIZES[name].refuse(size)


def _list_sized_fields() -> list[tuple[type, str]]:
    """Return each dataclass with a field that states its row of the table."""
    return [
        (kind, field.name)
        for kind in (Specimen, Machine, PlannedRamp, HammerPlan, BatchOptions, Indenter)
        for field in fields(kind)
        if "size" in field.metadata
    ]


@pytest.mark.parametrize(("kind", "name"), _list_sized_fields())
def test_field_with_a_size_doubts_a_number_without_unit(kind: type, name: str) -> None:
    """Millimetres, grams or milliseconds that were meant are read as SI, and asked about."""
    field = next(field for field in fields(kind) if field.name == name)
    row = field.metadata["size"]
    several = field.metadata.get("multiple")
    for size in (row.hard[1] * 1.1, row.hard[1] * 1e3):
        with pytest.raises(DataError, match=f"expected .* to .*Check the unit of {name}"):
            kind(**{name: (size,) if several else size})


@pytest.mark.parametrize("millimetres", [8, 20, 50, 100])
def test_length_of_a_specimen_in_millimetres_is_doubted(millimetres: float) -> None:
    for make in (
        lambda: dp.Specimen(length=millimetres),
        lambda: dp.read("seal.csv", specimen={"length": millimetres}),
    ):
        with pytest.raises(DataError, match=r"length of the seal is .* m; expected 100 um to 5 m"):
            make()
    assert dp.Specimen(length=f"{millimetres}mm").length == pytest.approx(millimetres / 1e3)


def test_format_quantity_short_uses_readable_units():
    message = [
        format_quantity_short(8.71, "m"),
        format_quantity_short(2e-3, "m"),
        format_quantity_short(4e9, "Pa"),
        format_quantity_short(3.2e4, "m/s^2"),
    ]
    assert message == ["8.71 m", "2 mm", "4 GPa", "3.2e+04 m/s^2"]
    assert format_quantity_short(7200.0, "s") == "2 h"
    assert format_quantity_short(0.0, "N") == "0 N"
