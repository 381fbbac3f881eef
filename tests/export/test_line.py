"""A seal line in the decks of five solvers: read back as the manuals lay the cards out.

Whatever a deck says is summed to the stiffness of the door's six motions, in three systems of
units, and compared with the integrals along the line, which were computed apart.
"""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from kit.bulkdata import read_cards, real
from kit.doors import (
    ACROSS,
    ALONG,
    CENTRE,
    FREE,
    INERTIA,
    MASS,
    NORMAL_ONLY,
    SHEARED,
    close_outline,
    compute_largest_difference,
    leaning,
    parse_matrix,
    six_by_six,
)
from kit.solvers import needs_ccx, run_ccx

from dashpot.base.errors import ExportError
from dashpot.datamodel.seal_line import Shear
from dashpot.datamodel.specimen import Specimen
from dashpot.export import TARGETS
from dashpot.export.seal_line_springs import LineStation, SpringRow, make_springs
from dashpot.extensions.systems.door.seal_line import SealLine
from dashpot.solids.demo_seals import PAPER
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell

HERTZ = 12.71
SHEAR = Shear(ACROSS, ALONG)
# metres and N/m in a deck's unit of length and of stiffness, and Hz in its unit of frequency
UNITS = {"SI": (1.0, 1.0, 1.0), "mm-t-s": (1e-3, 1e3, 1.0), "mm-kg-ms": (1e-3, 1e6, 1e3)}
AT = {
    "nastran": {"nominal": HERTZ, "frequency_range": (12.0, 13.5)},
    "abaqus": {"frequency_range": (12.0, 13.5)},
    "ansys": {"frequency_range": (12.0, 13.5)},
    "calculix": {"nominal": HERTZ},
    "lsdyna": {},
}


def deck(target: str, units: str, shear: Shear | None = SHEAR, pitch=0.05, **more) -> str:
    stations = SealLine(close_outline(), normal=leaning()).stations(pitch)
    return TARGETS[target](
        PAPER, units=units, specimen=Specimen(length=0.05), line=stations, shear=shear,
        **(AT[target] if more.get("form") != "arms" else {}) | more,
    )  # fmt: skip


# -- readers: place, direction and complex stiffness of each spring, deck units -------------------


def cards_of(text: str, comment: str) -> list[tuple[str, dict[str, str], list[list[str]]]]:
    """Keyword cards: each its name, parameters and lines of data."""
    result = []
    for line in text.splitlines():
        if line.startswith(comment) or not line:
            continue
        if line.startswith("*"):
            name, *words = [word.strip() for word in line[1:].split(",")]
            result.append((name, dict(word.split("=") for word in words if "=" in word), []))
        else:
            result[-1][2].append([word.strip() for word in line.split(",")])
    return result


def nodes_and_frames(cards):
    nodes, frames = {}, {}
    for name, entry, rows in cards:
        if name == "NODE":
            nodes |= {row[0]: np.array(row[1:4], dtype=float) for row in rows}
        elif name == "ORIENTATION":
            assert entry["SYSTEM"] == "RECTANGULAR"
            a, b = np.array(rows[0], dtype=float).reshape(2, 3)
            x = a / np.linalg.norm(a)
            z = np.cross(x, b)
            z /= np.linalg.norm(z)
            frames[entry["NAME"]] = np.array([x, np.cross(z, x), z])
    return nodes, frames


def sum_calculix(text: str, hertz: float):
    cards = cards_of(text, "**")
    nodes, frames = nodes_and_frames(cards)
    elements = {entry["ELSET"]: rows for name, entry, rows in cards if name == "ELEMENT"}
    for name, message, rows in cards:
        if name == "SPRING":
            (way, same), (k,) = rows[0], rows[1]
            assert way == same
            assert "." in k  # without it ccx reads a degree of freedom
            for _, a, b in elements[message["ELSET"]]:
                assert (nodes[a] == nodes[b]).all()
                yield nodes[a], frames[message["ORIENTATION"]][int(way) - 1], float(k)


def sum_abaqus(text: str, hertz: float):
    cards = cards_of(text, "**")
    nodes, frames = nodes_and_frames(cards)
    elements = {entry["ELSET"]: rows for name, entry, rows in cards if name == "ELEMENT"}
    expected, current = {}, ""
    for name, message, rows in cards:
        if name == "CONNECTOR BEHAVIOR":
            current = message["NAME"]
        elif name.startswith(("CONNECTOR E", "CONNECTOR D")):
            y, x = np.array(rows, dtype=float).T
            expected[current, message["COMPONENT"], name[10]] = np.interp(hertz, x, y)
    for name, message, rows in cards:
        if name == "CONNECTOR SECTION":
            assert rows[0][0] == "CARTESIAN"
            for _, a, b in elements[message["ELSET"]]:
                assert (nodes[a] == nodes[b]).all()
                for way in "123":
                    k = expected.get((message["BEHAVIOR"], way, "E"))
                    if k is not None:
                        eta = expected[message["BEHAVIOR"], way, "D"]
                        yield nodes[a], frames[rows[1][0]][int(way) - 1], k * (1 + 1j * eta)


def sum_nastran(text: str, hertz: float):
    cards = read_cards(text)
    grids = {f[0]: np.array([real(item) for item in f[2:5]]) for name, f in cards if name == "GRID"}
    frames = {"0": np.eye(3)}
    for name, f in cards:
        if name == "CORD2R":
            origin, on_z, in_xz = np.array([real(item) for item in f[2:11]]).reshape(3, 3)
            z = (on_z - origin) / np.linalg.norm(on_z - origin)
            y = np.cross(z, in_xz - origin)
            y /= np.linalg.norm(y)
            frames[f[0]] = np.array([np.cross(y, z), y, z])
    bushes = {f[0]: (f[2:8], f[10:16]) for name, f in cards if name == "PBUSH"}
    tables = {f[0]: (f[2:8], f[10:16]) for name, f in cards if name == "PBUSHT"}
    values = {}
    for name, f in cards:
        if name == "TABLED1":
            pairs = np.array([real(item) for item in f[8:] if item and item != "ENDT"]).reshape(
                -1, 2
            )
            values[f[0]] = np.interp(hertz, *pairs.T)
    for name, f in cards:
        if name != "CBUSH":
            continue
        assert (grids[f[2]] == grids[f[3]]).all()
        K, GE = bushes[f[1]]
        for way, k in enumerate(K):
            if k:
                table = [tables[f[1]][i][way] for i in (0, 1)]
                assert values[table[0]] == pytest.approx(real(k), rel=2e-5)
                loss = values[table[1]]
                assert loss == pytest.approx(real(GE[way]), rel=2e-3)
                yield grids[f[2]], frames[f[7]][way], real(k) * (1 + 1j * loss)


def turn(axis: int, degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = ((1, 2), (2, 0), (0, 1))[axis]
    R = np.eye(3)
    R[i, i] = R[j, j] = c
    R[i, j], R[j, i] = -s, s
    return R


def sum_ansys(text: str, hertz: float):
    rows = [line.split(",") for line in text.splitlines() if line and line[0] != "!"]
    places, axes, tables, constants, ways = {}, {}, {}, {}, {}
    kind = constant = ""
    for word, *f in rows:
        if word == "N":
            x = np.array(f[1:], dtype=float)
            places[f[0]] = x[:3]
            axes[f[0]] = (turn(2, x[3]) @ turn(0, x[4]) @ turn(1, x[5])).T
        elif word == "KEYOPT":
            assert f[1] == "2"
            ways[f[0]] = int(f[2]) - 1
        elif word == "*DIM":
            assert f[1:2] + f[3:] == ["TABLE", "1", "1", "FREQ"]
            tables[f[0]] = np.full((2, int(f[2])), np.nan)
        elif word in {"*TAXIS", "*SET"}:
            name, _, first = f[0].partition("(")
            values = np.array(f[2:], dtype=float)
            assert len(values) <= 10
            at = int(first.rstrip(")")) - 1
            tables[name][int(word == "*SET"), at : at + len(values)] = values
        elif word == "R":
            constants[f[0]] = [np.interp(hertz, *tables[text.strip("%")]) for text in f[1:]]
        elif word == "TYPE":
            kind = f[0]
        elif word == "REAL":
            constant = f[0]
        elif word == "E":
            a, b = f
            assert (places[a] == places[b]).all()
            assert (axes[a] == axes[b]).all()
            k, c = constants[constant]
            yield places[a], axes[a][ways[kind]], k + 2j * np.pi * hertz * c
    assert all(np.isfinite(table).all() for table in tables.values())


def sum_lsdyna(text: str, hertz: float):
    blocks: list[tuple[str, list[str]]] = []
    for line in text.splitlines():
        if line.startswith("*"):
            blocks.append((line, []))
        elif not line.startswith("$"):
            blocks[-1][1].append(line)
    tens = lambda line: [line[i : i + 10].strip() for i in range(0, len(line), 10)]  # noqa: E731
    places, vectors, materials, parts = {}, {}, {}, {}
    s = 2j * np.pi * hertz
    for name, rows in blocks:
        if name == "*NODE":
            for row in rows:
                at = [float(row[i : i + 16]) for i in (8, 24, 40)]
                places[row[:8].strip()] = np.array(at)
        elif name == "*DEFINE_SD_ORIENTATION":
            for f in map(tens, rows):
                way = np.array(f[2:5], dtype=float)
                vectors[f[0]] = way / np.linalg.norm(way)
        elif name == "*MAT_SPRING_ELASTIC":
            f = tens(rows[0])
            materials[f[0]] = float(f[1])
        elif name == "*MAT_SPRING_MAXWELL":
            f = tens(rows[0])
            k, ki, beta = map(float, f[1:4])
            assert ki == 0
            materials[f[0]] = k * s / (s + beta)
        elif name == "*PART":
            f = tens(rows[1])
            parts[f[0]] = f[2]
    for name, rows in blocks:
        if name == "*ELEMENT_DISCRETE":
            for row in rows:
                _, part, a, b, way = (row[i : i + 8].strip() for i in range(0, 40, 8))
                assert (places[a] == places[b]).all()
                yield places[a], vectors[way], materials[parts[part]]


READERS = {
    "nastran": sum_nastran, "abaqus": sum_abaqus, "ansys": sum_ansys, "calculix": sum_calculix,
    "lsdyna": sum_lsdyna,
}  # fmt: skip


def sum_deck(target: str, text: str, units: str) -> np.ndarray:
    metre, stiffness, hertz = UNITS[units]
    place, way, k = zip(*READERS[target](text, HERTZ / hertz), strict=True)
    return six_by_six(metre * np.array(place), np.array(way), stiffness * np.array(k))


# -- the decks ------------------------------------------------------------------------------------


@pytest.mark.parametrize("units", list(UNITS))
@pytest.mark.parametrize("target", list(READERS))
def test_a_deck_says_the_stiffness_of_the_line(target, units):
    K = sum_deck(target, deck(target, units), units)
    assert compute_largest_difference(K.real, parse_matrix(SHEARED)) < 1e-5
    if target != "calculix":  # which knows no loss
        eta = complex(PAPER.complex_stiffness(omega=2 * np.pi * HERTZ))
        assert np.diag(K.imag / K.real) == pytest.approx(eta.imag / eta.real, rel=2e-3)


@pytest.mark.parametrize("target", list(READERS))
def test_without_shear_a_deck_says_that_nothing_holds_sideways(target):
    text = deck(target, "mm-t-s", None, pitch=0.5)
    assert (
        compute_largest_difference(sum_deck(target, text, "mm-t-s").real, parse_matrix(NORMAL_ONLY))
        < 1e-5
    )
    assert "no shear is given: the line holds nothing sideways" in text
    assert "across it: 0.35 of it; along it: 0.15 of it" in deck(target, "SI", pitch=0.5)


@pytest.mark.parametrize("target", list(READERS))
def test_line_deck_accepts_a_separate_lateral_stiffness(target):
    """Half as stiff again in its arms: a third of the whole at 12.71 Hz, and other tables."""
    model = GeneralizedMaxwell(PAPER.k_inf, tuple(1.5 * k for k in PAPER.k), PAPER.tau)
    omega = 2 * np.pi * HERTZ
    ratio = complex(model.complex_stiffness(omega=omega)) / complex(
        PAPER.complex_stiffness(omega=omega)
    )
    text = deck(target, "SI", Shear(20 * ACROSS * model, ALONG), pitch=0.5)
    K, plain = (sum_deck(target, item, "SI") for item in (text, deck(target, "SI", pitch=0.5)))
    single = sum_deck(target, deck(target, "SI", Shear(0.0, ALONG), pitch=0.5), "SI")
    assert (K - single).real == pytest.approx((plain - single).real * ratio.real, rel=2e-3, abs=0.5)
    assert "across it: a stiffness of its own" in text


@pytest.mark.parametrize("target", list(READERS))
def test_line_deck_numbers_from_the_first_id(target):
    """Nodes, elements and whatever else has a number stay out of the way of the user's own."""
    text = deck(target, "SI", pitch=0.5, first_id=90001)
    assert "nodes 90001 to 90020" in text or target == "nastran"
    assert (
        compute_largest_difference(sum_deck(target, text, "SI").real, parse_matrix(SHEARED)) < 1e-5
    )
    for line in text.splitlines():
        way = re.fullmatch(r"([123]), \1", line)  # of a spring of CalculiX
        number = None if way else re.match(r"\s*(\d+)(?=[\s,]|$)", line)
        assert number is None or int(number[1]) >= 90001, line


@pytest.mark.parametrize(
    ("target", "form"), [("abaqus", "arms"), ("ansys", "arms"), ("calculix", "arms"),
                         ("lsdyna", "prony")]
)  # fmt: skip
def test_line_deck_names_the_supported_form(target, form):
    line = {"abaqus": "connector", "ansys": "table", "calculix": "springs", "lsdyna": "arms"}
    with pytest.raises(ExportError, match=f"hold a seal line in the form {line[target]}; found"):
        deck(target, "SI", form=form)


def test_nastran_line_uses_a_local_frame_for_each_arm():
    """Nastran's network: the grids' own systems turn its components."""
    cards = read_cards(deck("nastran", "SI", pitch=0.5, form="arms"))
    systems = {f[0] for name, f in cards if name == "CORD2R"}
    grids = [f for name, f in cards if name == "GRID"]
    assert {f[5] for f in grids} == systems
    springs = [f for name, f in cards if name == "CELAS2"]
    assert len(springs) == len(grids) // 2 * 3 * 3
    by_grid = {f[0]: f[5] for f in grids}
    rest = {way: sum(real(f[1]) for f in springs if f[2] in by_grid and f[3] == way and f[4] in
                     by_grid) for way in "123"}  # fmt: skip
    whole = 4.0 * PAPER.k_inf / 0.05
    assert list(rest.values()) == pytest.approx([whole, ACROSS * whole, ALONG * whole], rel=1e-8)
    numbers = [f[0] for name, f in cards if name in {"GRID", "SPOINT"}]
    assert len(set(numbers)) == len(numbers)


# -- CalculiX -------------------------------------------------------------------------------------


def door_of(text: str, units: str) -> str:
    """A deck that runs: the door as point masses in one rigid body, and dummies for the solver."""
    metre, stiffness, _ = UNITS[units]
    kilogram = stiffness if units != "mm-kg-ms" else 1.0  # of a second's unit of mass
    arm = 0.5
    pairs = (sum(INERTIA) / 2 - np.array(INERTIA)) / (2 * arm**2)
    masses = [(np.array(CENTRE), MASS - 2 * pairs.sum())]
    masses += [(CENTRE + sign * arm * np.eye(3)[i], pairs[i]) for i in range(3) for sign in (1, -1)]
    lines, n = [], 800_000
    for i, (place, mass) in enumerate(masses):
        at = ", ".join(f"{value / metre:.12g}" for value in place)
        lines += [
            "*NODE, NSET=SEAL_MOVING", f"{n + i}, {at}",
            f"*ELEMENT, TYPE=MASS, ELSET=M{i}", f"{n + i}, {n + i}",
            f"*MASS, ELSET=M{i}", f"{mass / kilogram:.12e}",
        ]  # fmt: skip
    centre = ", ".join(f"{value / metre:.12g}" for value in CENTRE)
    lines += ["*NODE", f"{n + 50}, {centre}", f"{n + 51}, {centre}"]
    dummies = range(n + 100, n + 140)
    lines += [
        "*NODE, NSET=DUMMIES", *(f"{value}, {value - n}., 1., 0." for value in dummies),
        "*NODE, NSET=HELD", *(f"{value + 100}, {value - n}., 2., 0." for value in dummies),
        "*ELEMENT, TYPE=SPRINGA, ELSET=DUMMY_K",
        *(f"{value}, {value}, {value + 100}" for value in dummies),
        "*SPRING, ELSET=DUMMY_K", "", f"{1e8 / stiffness:.6e}",
        "*ELEMENT, TYPE=MASS, ELSET=DUMMY_M", *(f"{value + 100}, {value}" for value in dummies),
        "*MASS, ELSET=DUMMY_M", f"{1e-2 / kilogram:.6e}",
        "*BOUNDARY", "HELD, 1, 3", "DUMMIES, 1, 1", "DUMMIES, 3, 3",
        f"*RIGID BODY, NSET=SEAL_MOVING, REF NODE={n + 50}, ROT NODE={n + 51}",
        "*STEP", "*FREQUENCY", "6", "*END STEP", "",
    ]  # fmt: skip
    return text + "\n".join(lines)


@needs_ccx
def test_ccx_computes_the_modes_of_a_door_on_its_seal_only(tmp_path):
    """The seal holds all of it: the sharpest test of a line that there is."""
    dat = run_ccx(door_of(deck("calculix", "mm-t-s", pitch=0.5), "mm-t-s"), tmp_path)
    rows = re.findall(r"^\s+\d+\s+\S+\s+\S+\s+(\S+)\s+\S+\s*$", dat, re.MULTILINE)
    result = [float(row) for row in rows[:6]]
    assert result == pytest.approx(FREE, rel=1e-6)
    assert all(a <= b for a, b in pairwise(result))


def test_a_frame_along_the_x_axis_is_needed_where_something_acts_sideways():
    line_station = LineStation()
    assert SpringRow((PAPER,) * 3, (line_station,)).frames == {}
    sheared = replace(line_station, shares=(1.0, 0.5, 0.0))
    assert SpringRow((PAPER,) * 3, (sheared,)).frames == {line_station.frame: 0}


def test_what_is_not_pressed_as_stated_is_the_secant_of_the_test():
    stations = SealLine(close_outline(), normal=leaning()).stations(0.05)
    unstated = replace(stations, compression=None)
    law = ElasticLaw((0.0, 4e-3, 8e-3), (0.5, 0.9, 1.7), PAPER.k_inf)
    bent, straight = (
        SimpleNamespace(
            solid=PAPER, specimen=Specimen(length=0.05), elastic_law=item,
            units=SimpleNamespace(length=1e-3, words=("mm",)),
        )
        for item in (law, None)
    )  # fmt: skip
    assert make_springs(bent, unstated).stations == make_springs(straight, unstated).stations
