"""Decks of what FRFs at several levels show: sliders and a cubic spring beside the arms.

Two solvers run them; the others are parsed back into the forces that they stand for.
"""

from __future__ import annotations

import itertools
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from kit.levels import ARMS, MASS, SLIDERS, STIFFENS, a_level_fit
from kit.solvers import PULSE, needs_ccx, read_printed, run_ccx, run_opensees

from dashpot import workflow
from dashpot.base.checks import Check
from dashpot.base.errors import ExportError, ReadError
from dashpot.export import FORMS, TARGETS, UNIT_SYSTEMS, deck_for
from dashpot.export.deck import CARRIERS
from dashpot.extensions.amplitude.level_results import LevelFit
from dashpot.solids.jenkins import Jenkins
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.networks import spring
from dashpot.solids.nonlinear_springs import Cubic
from dashpot.solids.rate_independent import InParallel
from dashpot.workflow.json_archive import from_json, to_json

pytestmark = pytest.mark.once
STEP = 1e-4
"""m; every slider yields at a multiple of it, so that no loop's corner is cut."""
SIZES = (3e-4, 6e-4, 2e-3)
TURNS = [0.0] + [way * size for size in SIZES for way in (1, -1, 1, -1, 1)]
"""Two cycles of each size to and fro, m, from rest."""
BRANCHES = [round(abs(b - a) / STEP) for a, b in itertools.pairwise(TURNS)]


def cycles() -> np.ndarray:
    """Those, a place every step."""
    pairs = zip(itertools.pairwise(TURNS), BRANCHES, strict=True)
    return np.concatenate([np.linspace(a, b, n + 1)[1:] for (a, b), n in pairs])


def held_to_the_elements(x: np.ndarray, force: np.ndarray) -> None:
    """Energy, J, and secant, N/m, of the second cycle of each size, against the closed forms."""
    turn = np.cumsum(BRANCHES) - 1
    for i, size in enumerate(SIZES):
        first, low, last = turn[5 * i + 2 : 5 * i + 5]
        at = slice(first, last + 1)
        energy = np.trapezoid(force[at], x[at])
        secant = (force[last] - force[low]) / (x[last] - x[low])
        lost = sum(slider.energy(size) for slider in SLIDERS)
        ends = ARMS.k_inf + sum(item.secant(size) for item in (*SLIDERS, STIFFENS))
        print(f"{size:g} m: energy {energy / lost - 1:+.1e}, secant {secant / ends - 1:+.1e}")
        assert energy == pytest.approx(lost, rel=1e-3)
        assert secant == pytest.approx(ends, rel=1e-3)


def opensees_path(fit, x, dt, units="mm-t-s", form="python"):
    """Force, N, along displacements, m, one each dt, s."""
    unit = UNIT_SYSTEMS[units]
    task = {
        **material(fit, units, form), "dt": dt / unit.time, "steps": len(x),
        "path_time": (dt / unit.time * np.arange(len(x) + 2)).tolist(),
        "path_value": [0.0, *(x / unit.length).tolist(), 0.0],
    }  # fmt: skip
    return run_opensees(task) * unit.force


def material(fit, units, form="python"):
    """The commands, and the tag of what they end in: 0 of a network."""
    deck = TARGETS["opensees"](fit, units=units, form=form)
    (tag,) = re.findall(r"'Parallel', (\d+)", deck) or [0]
    return {"deck": deck, "material": int(tag)}


@pytest.mark.parametrize(("units", "form"), [("SI", "network"), ("mm-kg-ms", "python")])
def test_opensees_follows_the_loops(units, form):
    x = cycles()
    held_to_the_elements(x, opensees_path(a_level_fit(spring(ARMS.k_inf)), x, 1e-3, units, form))


def march(fit, t, x):
    """Our own force, N, from rest."""
    whole = InParallel((fit.solid, *fit.rate_independent))
    return whole.path_force(np.r_[0.0, t], np.r_[0.0, x])[1:]


@pytest.mark.parametrize("form", ["network", "python"])
def test_opensees_marches_arms_and_sliders(form):
    dt, fit = 1 / 13 / 800, a_level_fit()
    t = dt * np.arange(1, 2401)
    x = 1e-3 * np.sin(2 * np.pi * 13 * t)
    exact = march(fit, t, x)
    off = np.abs(opensees_path(fit, x, dt, form=form) - exact).max() / exact.max()
    print(f"largest error of the force {off:.1e}")
    assert off < 1e-3


PAPER = GeneralizedMaxwell(393.0, (235.0, 35.6), (0.50212766, 16.4157303))
REFERENCES = {
    # by several harmonics (H = 1, 3, 5); refined marches agree within 0.011 %
    "friction, little": (PAPER, (Jenkins(100.0, 0.05),), 13.5, 0.02, 60, 6.695167e-4),
    "friction, much": (PAPER, (Jenkins(100.0, 0.05),), 13.0, 0.1, 160, 3.284517e-3),
    "with a cubic spring": (ARMS, (Jenkins(100.0, 0.05), Cubic(2e6)), 14.0, 0.5, 40, 1.498670e-3),
}


@pytest.mark.parametrize("name", REFERENCES)
def test_a_mass_shaken_in_opensees_moves_as_harmonic_balance_says(name):
    solid, neighbour, hz, force, count, X = REFERENCES[name]
    fit, steps = a_level_fit(solid, neighbour), 400
    dt = 1 / hz / steps
    t = dt * np.arange(count * steps + 2)
    turn = np.exp(-2j * np.pi * hz * t)
    task = {
        **material(fit, "SI"), "mass": MASS, "dt": dt, "steps": count * steps,
        "path_time": t.tolist(), "path_value": (-force * turn.imag).tolist(),
    }  # fmt: skip
    variant = run_opensees(task, script=PULSE)[-steps:]
    magnitude = abs(2 / steps * np.sum(variant * turn[-steps - 1 : -1]))
    print(f"{name}: amplitude {magnitude:.6e} m, {magnitude / X - 1:+.1e}")
    assert magnitude == pytest.approx(X, rel=1e-3)


def ccx_path(network, units, x, dt, *, procedure, folder):
    """Displacement, m, and force, N, of node 2, pulled along x by a stiff spring."""
    unit = UNIT_SYSTEMS[units]
    span = float(next(row for row in network.splitlines() if row.startswith("2, ")).split(",")[1])
    times = dt / unit.time * np.arange(1, len(x) + 1)
    rows = [
        "*NODE", f"9, {2 * span}, 0., 0.", "*ELEMENT, TYPE=SPRINGA, ELSET=CELL", "6999, 2, 9",
        "*SPRING, ELSET=CELL", "", repr(unit.stiffness(1e7)),
        "*BOUNDARY", "1, 1, 3", "2, 2, 3", "9, 2, 3", "*AMPLITUDE, NAME=PATH", "0., 0.",
        *(f"{at:.10g}, {to:.10g}" for at, to in zip(times, x / unit.length, strict=True)),
        "*NSET, NSET=SHOWN", "2, 9", f"*STEP, INC={10 * len(x)}", procedure,
        f"{dt / unit.time:.12g}, {times[-1]:.12g}", "*BOUNDARY, AMPLITUDE=PATH", "9, 1, 1, 1.",
        "*NODE PRINT, NSET=SHOWN", "U, RF", "*END STEP", "",
    ]  # fmt: skip
    dat = run_ccx(network + "\n".join(rows), folder)
    return read_printed(dat, "disp", 2) * unit.length, read_printed(dat, "forces", 9) * unit.force


@needs_ccx
@pytest.mark.parametrize(("target", "units"), [("calculix", "mm-kg-ms"), ("abaqus", "SI")])
def test_calculix_follows_the_loops(target, units, tmp_path):
    network = TARGETS[target](a_level_fit(spring(ARMS.k_inf)), units=units)
    x = cycles()
    held_to_the_elements(
        *ccx_path(network, units, x, 1e-3, procedure="*STATIC, DIRECT", folder=tmp_path)
    )


@needs_ccx
def test_calculix_marches_arms_and_sliders(tmp_path):
    dt, fit = 1 / 13 / 100, a_level_fit()
    t = dt * np.arange(1, 126)
    x = 1e-3 * np.sin(2 * np.pi * 13 * t)
    network = TARGETS["calculix"](fit, units="mm-t-s")
    went, force = ccx_path(network, "mm-t-s", x, dt, procedure="*DYNAMIC, DIRECT", folder=tmp_path)
    exact = march(fit, t, went)
    off = np.abs(force - exact)[25:].max() / exact.max()  # it starts with a kick
    print(f"largest error of the force {off:.1e}")
    assert off < 1e-3


# -- read back from the text -----------------------------------------------------------------------

Sliders = list[tuple[float, float]]
Curve = list[tuple[float, float]]


def from_opensees(deck: str) -> tuple[Sliders, Curve]:
    rows = [re.sub(r"[(),']", " ", row).split() for row in deck.splitlines()]
    sliders = [(float(row[3]), float(row[3]) * float(row[4])) for row in rows if "ElasticPP" in row]
    curve = next(row for row in rows if "ElasticMultiLinear" in row)
    half = curve.index("-stress")
    x, force = (list(map(float, part)) for part in (curve[5:half], curve[half + 1 :]))
    assert curve[3:5] == ["0.", "-strain"]
    return sliders, list(zip(x, force, strict=True))


def from_lsdyna(deck: str) -> tuple[Sliders, Curve]:
    rows = deck.splitlines()
    numbers = [
        list(map(float, rows[i + 1].split()))
        for i, row in enumerate(rows)
        if row == "*MAT_SPRING_ELASTOPLASTIC"
    ]
    assert all(kt == 0 for _, _, kt, _ in numbers)
    elastic = rows[rows.index("*MAT_SPRING_NONLINEAR_ELASTIC") + 1]
    start = rows.index("*DEFINE_CURVE")
    assert elastic.split()[1] == rows[start + 1].split()[0]
    curve = [(float(row[:20]), float(row[20:])) for row in rows[start + 2 : -1]]
    return [(k, slip) for _, k, _, slip in numbers], curve


def from_ansys(deck: str) -> tuple[Sliders, Curve]:
    kind, sliders, curve = "", [], []
    for row in deck.splitlines():
        head, *cells = row.split(",")
        if head == "ET":
            kind = cells[1]
        elif head == "R" and kind == "COMBIN40":
            k, c, mass, gap, slip, neighbour = map(float, cells[1:])
            assert (c, mass, gap, neighbour) == (0, 0, 0, 0)
            sliders.append((k, slip))
        elif head in ("R", "RMORE") and kind == "COMBIN39":
            curve += list(map(float, cells[1 if head == "R" else 0 :]))
    assert len(curve) == 40
    return sliders, list(zip(curve[::2], curve[1::2], strict=True))


def from_abaqus(deck: str) -> tuple[Sliders, Curve]:
    rows = deck.splitlines()
    sliders = []
    for i, row in enumerate(rows):
        if row.startswith("*ELEMENT, TYPE=C3D8"):
            first = int(rows[i + 1].split(",")[0])
            nodes = {
                int(r.split(",")[0]): list(map(float, r.split(",")[1:])) for r in rows[i - 8 : i]
            }
            edge, height = nodes[first + 2][0], nodes[first + 5][2]
            assert rows[i + 3 : i + 7 : 2] == ["*ELASTIC", "*PLASTIC"]
            E, stress = (float(rows[i + j].split(",")[0]) for j in (4, 6))
            sliders.append((E / 2 * edge**2 / height, stress / np.sqrt(3) * edge**2))
    start = rows.index("*SPRING, ELSET=SEAL_CUBIC, NONLINEAR") + 2
    curve = []
    while not rows[start].startswith("*"):
        force, x = map(float, rows[start].split(","))
        curve.append((x, force))
        start += 1
    return sliders, curve


READERS = {
    "opensees": from_opensees, "lsdyna": from_lsdyna, "ansys": from_ansys,
    "abaqus": from_abaqus, "calculix": from_abaqus,
}  # fmt: skip


@pytest.mark.parametrize("units", UNIT_SYSTEMS)
@pytest.mark.parametrize("target", READERS)
def test_a_deck_says_the_sliders_and_the_spring(target, units):
    unit = UNIT_SYSTEMS[units]
    sliders, curve = READERS[target](TARGETS[target](a_level_fit(), units=units))
    exact = [(unit.stiffness(slider.k), slider.slip / unit.force) for slider in SLIDERS]
    assert np.array(sliders) == pytest.approx(np.array(exact), rel=1e-4)
    x, force = np.array(curve).T * [[unit.length], [unit.force]]
    linear = ARMS.k_inf * x if target == "ansys" else 0.0
    assert force == pytest.approx(STIFFENS.unloading(x, np.abs(x)) + linear, rel=1e-8, abs=1e-12)
    assert x[-1] == pytest.approx(4e-3)
    assert (x[0], len(x)) == ((0, 20) if target == "ansys" else (-x[-1], 161))


def test_every_carrier_is_read_back():
    assert set(READERS) == set(CARRIERS)
    for target, forms in CARRIERS.items():
        assert set(forms) <= set(FORMS[target])


# -- what is said, and refused ---------------------------------------------------------------------

LINEAR = [
    (target, form)
    for target, forms in FORMS.items()
    for form in forms
    if form not in CARRIERS.get(target, ())
]


@pytest.mark.parametrize(("target", "form"), LINEAR)
def test_a_form_that_holds_no_friction_says_who_does(target, form):
    write, fit = TARGETS[target], a_level_fit()
    with pytest.raises(ExportError, match="3 sliders and a cubic spring in parallel") as no:
        write(fit, units="SI", form=form, allow=("all",))
    message = str(no.value)
    if target in CARRIERS:
        assert f"use --form {CARRIERS[target][0]}" in message
    else:
        assert f"--to {', '.join(CARRIERS)}" in message
    # arms alone are linear: any deck takes them
    extra = (
        {"modulus": 1e6}
        if form == "prony" and target in ("lsdyna", "radioss", "felupe", "comsol")
        else {}
    )
    extra |= {"bulk_modulus": 1e8, "density": 700.0} if target == "lsdyna" else {}
    assert "slider" not in write(a_level_fit(neighbour=()), units="SI", form=form, **extra)


@pytest.mark.parametrize("target", CARRIERS)
def test_a_deck_of_levels_says_where_it_comes_from(target):
    deck = TARGETS[target](a_level_fit(), units="mm-t-s")
    for words in (
        "slider 2: k = 0.06 N/mm, slips at 0.012 N (0.2 mm)",
        "cubic spring: k3 = 0.02 N/mm^3, piecewise linear to 4. mm in both directions",
        "displacement amplitudes tested: 0.1 to 2 mm; other amplitudes are EXTRA",
        "at the amplitudes 0.02, 0.5 (N, or m/s^2 of a base), which leaves 1 % of F/X",
        f"source: low.csv sha256 {'0' * 64}",
        "valid band: 8 to 20 Hz",
        "temperature: 296.15 K (23 degC)",
        "contact length: 100 mm",
    ):
        assert words in deck, words
    # elements that follow their nodes
    follow = target in ("abaqus", "calculix")
    assert ("keep the two nodes 10000. mm apart" in deck) == follow
    solver = "not solver-verified" not in deck
    assert solver == (target in ("opensees", "calculix"))


def test_export_of_levels_refuses_missing_information():
    bare = a_level_fit(specimen=type(a_level_fit().specimen)())
    with pytest.raises(ExportError, match=r"temperature is not stated.*length is not stated"):
        TARGETS["opensees"](bare, units="SI")
    assert "OVERRIDE: the test temperature" in TARGETS["opensees"](bare, units="SI", allow=("all",))
    stopped = a_level_fit(
        checks=(Check("levels_residual_small", False, "no such seal", grade="stop"),)
    )
    with pytest.raises(ExportError, match="No such seal"):
        TARGETS["opensees"](stopped, units="SI")
    deck = TARGETS["opensees"](stopped, units="SI", allow=("not_identified",))
    assert "DO NOT USE: No such seal" in deck
    careful = a_level_fit(checks=(Check("levels_residual_small", False, "a little off"),))
    deck = TARGETS["opensees"](careful, units="SI")
    assert re.search("^# USE WITH CARE: From 0.1 to 2 mm .* A little off[.]$", deck, re.M)


def test_export_refuses_options_incompatible_with_friction():
    with pytest.raises(ExportError, match="steady-state step, which is linear"):
        TARGETS["calculix"](a_level_fit(), units="SI", mass=0.1)
    with pytest.raises(ExportError, match="of one compression"):
        deck_for("opensees", a_level_fit(), units="SI", compression=1e-3)
    loose = a_level_fit(GeneralizedMaxwell(0.0, (10.0,), (1.0,)), (Cubic(-1e4),))
    with pytest.raises(ExportError, match="COMBIN39 must rise at its origin"):
        TARGETS["ansys"](loose, units="SI", allow=("all",))
    assert "NONLINEAR_ELASTIC" in TARGETS["lsdyna"](loose, units="SI", allow=("all",))
    huge = a_level_fit(neighbour=(Jenkins(1e31, 1.0),))
    with pytest.raises(ExportError, match="a deck holds 0 or numbers from 1e-30"):
        TARGETS["opensees"](huge, units="SI")


def test_seals_in_parallel_are_so_many_of_each():
    sliders, curve = from_opensees(deck_for("opensees", a_level_fit(), units="SI", seals=2))
    assert sliders == [(2 * slider.k, 2 * slider.slip) for slider in SLIDERS]
    x, force = np.array(curve).T
    assert force == pytest.approx(2 * STIFFENS.unloading(x, np.abs(x)))
    deck = deck_for("opensees", a_level_fit(), units="SI", seals=2)
    assert "2 such seals in parallel" in deck
    assert "contact length: 0.2 m" in deck


# -- from the JSON of dashpot level ----------------------------------------------------------------


def archive_fit(fit: LevelFit) -> str:
    return to_json(fit)


def test_what_a_level_document_holds_makes_the_same_deck(tmp_path):
    path = tmp_path / "level.json"
    path.write_text(archive_fit(replace(a_level_fit(), checks=(Check("c", None, "a check"),))))
    again = workflow.read_exported(path)
    assert isinstance(again, LevelFit)
    again = replace(again, specimen=a_level_fit().specimen)
    for target in CARRIERS:
        write = TARGETS[target]
        assert write(again, units="SI") == write(a_level_fit(), units="SI")
    assert np.isnan(again.k3_interval).all()  # chance is not in the file


def test_a_level_document_that_was_changed_is_refused():
    text = archive_fit(a_level_fit())
    with pytest.raises(ReadError, match="was changed by hand"):
        from_json(text.replace('"slip": 0.05', '"slip": 0.06'))
    document = json.loads(text)
    del document["digest"]
    document["sliders"][0]["grip"] = 1.0
    with pytest.raises(ReadError, match='has "grip", which this version'):
        from_json(json.dumps(document))
    document["sliders"][0] = {"k": -1.0, "slip": 0.05}
    with pytest.raises(ReadError, match=r"Jenkins: k = -1.0; expected a number > 0"):
        from_json(json.dumps(document))


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ({"law": "additive"}, "a law of stiffness and loss"),
        ({"hits": 5}, "hits of different height"),
    ],
)
def test_a_law_of_amplitudes_has_no_force_along_a_path(document, message):
    with pytest.raises(ReadError, match=f"holds {message}, which has no force along a path"):
        from_json(json.dumps({"schema": "dashpot/levels@2"} | document))
