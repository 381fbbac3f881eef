"""Nastran decks, read back by a reader that shares nothing with the writer."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kit.bulkdata import Bush, read_cards, real

from dashpot.base.errors import ExportError
from dashpot.datamodel.specimen import Specimen
from dashpot.export import TARGETS, UNIT_SYSTEMS
from dashpot.export.decks.nastran import BushComponent, format_bush_property
from dashpot.export.frequency_tables import tabulate
from dashpot.export.unit_systems import format_fixed_width
from dashpot.extensions.systems.door.seal_line import SealLine
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.mass_on_seals import predict_frf

GOLDEN = Path(__file__).parent / "golden"
positive = st.floats(-2, 2).map(lambda power: 10.0**power)


@pytest.mark.parametrize("units", list(UNIT_SYSTEMS))
@pytest.mark.parametrize("form", ["table", "viscous-table"])
def test_the_stiffness_read_back_is_the_models(paper_seal, units, form):
    deck = TARGETS["nastran"](paper_seal, units=units, form=form, tolerance=1e-3)
    system = UNIT_SYSTEMS[units]
    f = np.linspace(1, 100, 5001)
    read = Bush(deck).complex_stiffness(f * system.time)
    K = paper_seal.complex_stiffness(omega=2 * np.pi * f)
    assert np.abs(read / system.stiffness(1.0) - K).max() < 1.01e-3 * K.imag.max()
    assert (np.abs(read / system.stiffness(1.0) - K) / K.imag).max() < 1.01e-3


def test_reference_values_at_the_papers_frequency(paper_seal):
    """K = 0.331727 N/mm, GE = 0.0088686, B = 3.68393e-5 N s/mm at 12.71 Hz."""
    table = Bush(TARGETS["nastran"](paper_seal, units="mm-t-s", tolerance=1e-5))
    assert table.table("K", 12.71) == pytest.approx(0.331727, abs=5e-7)
    assert table.table("GE", 12.71) == pytest.approx(0.0088686, abs=1e-7)
    viscous = Bush(
        TARGETS["nastran"](paper_seal, units="mm-t-s", form="viscous-table", tolerance=1e-5)
    )
    assert viscous.table("B", 12.71) == pytest.approx(3.68393e-5, rel=1e-5)


@given(
    st.lists(positive, min_size=1, max_size=4),
    st.lists(positive, min_size=4, max_size=4),
    positive,
    st.sampled_from(["loss_factor", "damping"]),
    st.sampled_from([1e-2, 1e-3]),
)
@settings(max_examples=25, deadline=None)
def test_a_table_keeps_the_tolerance_for_every_mass(k, tau, k_inf, damping, tolerance):
    model = GeneralizedMaxwell(k_inf, tuple(k), tuple(tau[: len(k)]))
    table = tabulate(model, frequency_range=(0.1, 100.0), tolerance=tolerance, damping=damping)
    f = np.geomspace(0.1, 100.0, 3001)
    omega = 2 * np.pi * f
    storage = np.interp(f, table.frequency, table.storage)
    damped = np.interp(f, table.frequency, table.damping)
    tabled = storage + 1j * (storage * damped if damping == "loss_factor" else omega * damped)
    exact = model.complex_stiffness(omega=omega)
    for resonance in (0.5, 3.0, 20.0):
        mass = float(model.storage(omega=2 * np.pi * resonance)) / (2 * np.pi * resonance) ** 2
        error = np.abs((exact - mass * omega**2) / (tabled - mass * omega**2) - 1)
        assert error.max() <= 1.1 * tolerance
    assert table.error <= tolerance
    assert (np.diff(table.frequency) > 0).all()


def test_a_finer_tolerance_costs_points_and_nothing_is_wasted(paper_seal):
    sizes = []
    for tolerance in (1e-2, 1e-3, 1e-4):
        table = tabulate(
            paper_seal, frequency_range=(1.0, 100.0), tolerance=tolerance, damping="loss_factor"
        )
        sizes.append(len(table.frequency))
        assert 0.5 * tolerance < table.error <= tolerance
    # linear interpolation: ten times finer needs sqrt(10) times the points
    assert sizes[1] / sizes[0] == pytest.approx(10**0.5, rel=0.15)
    assert sizes[2] / sizes[1] == pytest.approx(10**0.5, rel=0.1)


def test_loss_factor_needs_fewer_points_than_viscous_damping(paper_seal):
    sizes = {
        damping: len(
            tabulate(
                paper_seal, frequency_range=(1.0, 100.0), tolerance=1e-3, damping=damping
            ).frequency
        )
        for damping in ("loss_factor", "damping")
    }
    assert sizes["loss_factor"] < sizes["damping"]


def test_a_spring_is_two_points():
    table = tabulate(
        GeneralizedMaxwell(5.0), frequency_range=(1.0, 9.0), tolerance=1e-3, damping="loss_factor"
    )
    assert table.storage.tolist() == [5.0, 5.0]
    assert table.error == 0.0


def test_bushver():
    """The public BUSHVER deck: a force of 2 K at each resonance moves the mass by -1.000 j."""
    mass = 0.0253303
    frequency, stiffness = [0.9, 1.0, 1.1], [0.81, 1.0, 1.21]
    damping = [0.2864789, 0.3183099, 0.3501409]
    rows = [BushComponent(1, frequency, stiffness, damping, (1.0, 0.0))]
    cards = format_bush_property(1, rows, label="B")
    deck = "\n".join([*cards, ""])
    assert deck == (GOLDEN / "bushver.bdf").read_text()
    omega = 2 * np.pi * np.array(frequency)
    u = 2 * np.array(stiffness) / (Bush(deck).complex_stiffness(frequency) - mass * omega**2)
    assert u == pytest.approx(np.full(3, -1j), abs=1e-6)


def test_nominal_values_are_those_at_the_stated_frequency(paper_seal):
    bush = Bush(TARGETS["nastran"](paper_seal, units="mm-t-s", nominal=12.71))
    assert bush.nominal["K"] == pytest.approx(0.331727, rel=2e-6)
    assert bush.nominal["GE"] == pytest.approx(0.00886863, rel=1e-4)


def test_arms_rebuild_the_model(paper_seal):
    """CELAS2 and CDAMP2 assembled here, inner points eliminated, against the model."""
    cards = read_cards(
        TARGETS["nastran"](paper_seal + GeneralizedMaxwell(0.0, b=3.0), units="SI", form="arms")
    )
    omega = 2 * np.pi * 7.0
    nodes = sorted(
        {(fields[0], "1") for name, fields in cards if name == "GRID"}
        | {(fields[0], "") for name, fields in cards if name == "SPOINT"}
    )
    D = np.zeros((len(nodes), len(nodes)), dtype=complex)
    for name, fields in cards:
        if name not in ("CELAS2", "CDAMP2"):
            continue
        value = real(fields[1]) * (1j * omega if name == "CDAMP2" else 1.0)
        a, b = nodes.index((fields[2], fields[3])), nodes.index((fields[4], fields[5]))
        D[np.ix_([a, b], [a, b])] += value * np.array([[1, -1], [-1, 1]])
    moving = nodes.index(("2", "1"))
    rest = [i for i, node in enumerate(nodes) if node not in (("1", "1"), ("2", "1"))]
    inner = np.linalg.solve(D[np.ix_(rest, rest)], D[rest, moving])
    K = D[moving, moving] - D[moving, rest] @ inner
    expected = paper_seal.complex_stiffness(omega=omega) + 3j * omega
    assert pytest.approx(expected, rel=1e-9) == K
    assert len({fields[0] for name, fields in cards if name[0] == "C"}) == 6


# -- seal line -------------------------------------------------------------------------------------


def test_a_seal_line_carries_its_whole_length(paper_seal):
    """Sum of the elements' stiffness = stiffness per length x length of the line."""
    corners = np.array([(0, 0, 0), (1.1, 0, 0), (1.1, 1.2, 0), (0, 1.2, 0), (0, 0, 0)])
    line = SealLine(corners)
    stations = line.stations(0.025)
    deck = TARGETS["nastran"](
        paper_seal, units="mm-t-s", specimen=Specimen(length=0.1), line=stations, tolerance=1e-4
    )
    bush = Bush(deck)
    elements = [fields for name, fields in bush.cards if name == "CBUSH"]
    assert len(elements) == len(stations.length) == 184
    assert len({fields[0] for fields in elements}) == 184
    total = 184 * bush.complex_stiffness(12.71)
    expected = paper_seal.complex_stiffness(omega=2 * np.pi * 12.71) * 1e-3 * line.length / 0.1
    assert total == pytest.approx(complex(expected), rel=1e-5)
    grids = {fields[0]: fields[2:5] for name, fields in bush.cards if name == "GRID"}
    assert len(grids) == 2 * 184
    first = [real(value) for value in grids[elements[0][2]]]
    assert first == pytest.approx([25 * (1 - 1 / np.sqrt(3)), 0.0, 0.0])
    assert grids[elements[0][2]] == grids[elements[0][3]]


def test_the_bushing_points_along_the_normal(paper_seal):
    normal = np.array([0.3, -0.5, 0.8])
    line = SealLine([(0, 0, 0), (1, 0, 0)], normal=normal).stations(0.5)
    bush = Bush(
        TARGETS["nastran"](
            paper_seal, units="SI", specimen=Specimen(length=0.1), line=line, first_id=7
        )
    )
    (system,) = [fields for name, fields in bush.cards if name == "CORD2R"]
    origin, on_z, in_xz = (
        np.array([real(value) for value in system[i : i + 3]]) for i in (2, 5, 8)
    )
    z = (on_z - origin) / np.linalg.norm(on_z - origin)
    x = in_xz - origin - ((in_xz - origin) @ z) * z
    assert x / np.linalg.norm(x) == pytest.approx(normal / np.linalg.norm(normal))
    assert all(f[7] == system[0] for name, f in bush.cards if name == "CBUSH")


def test_a_seal_line_needs_the_tested_length(paper_seal):
    line = SealLine([(0, 0, 0), (1, 0, 0)]).stations(0.1)
    with pytest.raises(ExportError, match="contact length that the model stands for"):
        TARGETS["nastran"](paper_seal, units="SI", line=line)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"frequency_range": (0.0, 10.0)}, "expected 0 < low < high"),
        ({"frequency_range": (10.0, 1.0)}, "expected 0 < low < high"),
        ({"tolerance": 0.0}, "tolerance = 0.0"),
        ({"tolerance": 1e-8}, "more than 5000 points"),
        ({"form": "cards"}, "nastran has no form 'cards'; expected one of table"),
    ],
)
def test_what_a_table_cannot_be(paper_seal, arguments, sentence):
    with pytest.raises(ExportError, match=sentence):
        TARGETS["nastran"](paper_seal, units="SI", **arguments)


def test_a_dashpot_has_no_table():
    with pytest.raises(ExportError, match="no storage stiffness"):
        TARGETS["nastran"](GeneralizedMaxwell(0.0, b=1.0), units="SI")


@given(st.floats(allow_nan=False, allow_infinity=False, min_value=-1e30, max_value=1e30))
def test_small_fields_hold_what_fits(value):
    if 0 < abs(value) < 1e-30:
        value = 0.0
    for width in (8, 10, 16):
        field = format_fixed_width(value, width)
        assert len(field) <= width
        assert "." in field
        # a minus and an exponent of three signs leave width - 6 columns for digits and the point
        assert float(field) == pytest.approx(value, rel=0.51 * 10.0 ** -(width - 7), abs=0)


# -- another reader --------------------------------------------------------------------------------


def test_pynastran_reads_the_same_tables(paper_seal, tmp_path):
    """pyNastran in an environment of its own; name its Python in DASHPOT_PYNASTRAN."""
    python = os.environ.get("DASHPOT_PYNASTRAN", sys.executable)
    script = Path(__file__).parent / "read_with_pynastran.py"
    line = SealLine([(0, 0, 0), (1, 0, 0)], normal=(0.0, 1.0, 0.0)).stations(0.25)
    deck = tmp_path / "seal.bdf"
    deck.write_text(
        TARGETS["nastran"](paper_seal, units="mm-t-s", specimen=Specimen(length=0.1), line=line)
    )
    run = subprocess.run(
        [python, str(script), str(deck)], capture_output=True, text=True, check=False, timeout=300
    )
    if "No module named 'pyNastran'" in run.stderr:
        pytest.skip("pyNastran is not installed: set DASHPOT_PYNASTRAN to a Python that has it")
    assert run.returncode == 0, run.stderr
    tables: dict[str, list[tuple[float, float]]] = {}
    for row in run.stdout.splitlines():
        if row.startswith("TABLE "):
            _, number, x, y = row.split()
            tables.setdefault(number, []).append((float(x), float(y)))
    ours = Bush(deck.read_text())
    assert set(tables) == set(ours.tables)
    for number, (x, y) in ours.tables.items():
        assert np.array(tables[number]).tolist() == np.stack([x, y], axis=1).tolist()
    assert "PBUSHT 1 K 1 GE 2" in run.stdout
    assert "CBUSH 4" in run.stdout


def test_the_deck_gives_the_frf_of_the_model(paper_seal):
    """FRF of 52.02 g from the parsed table: within the printed error everywhere."""
    deck = TARGETS["nastran"](
        paper_seal, units="mm-t-s", tolerance=1e-3, frequency_range=(1.0, 30.0)
    )
    f = np.linspace(1, 30, 4001)
    K = Bush(deck).complex_stiffness(f) * 1e3
    exact = predict_frf(paper_seal, mass=0.05202, frequency=f, kind="receptance").value
    error = np.abs(1 / (K - 0.05202 * (2 * np.pi * f) ** 2) / exact - 1)
    assert error.max() < 1e-3
