"""Cards of hyperelastic laws: read back into the law, and run by CalculiX on one element."""

from __future__ import annotations

import re
import shutil
import subprocess
from functools import cache

import numpy as np
import pytest
from kit.rubber import RELAXATION, simulate_loading

from dashpot.base.errors import ExportError
from dashpot.export import deck_for
from dashpot.extensions.materials.hyperelastic.fit import fit_hyperelastic
from dashpot.extensions.materials.hyperelastic.material_cards import hyperelastic_card
from dashpot.extensions.materials.hyperelastic.strain_energy import SHEARING, Hyperelastic

pytestmark = pytest.mark.once

LAWS = {
    "neo-hooke": Hyperelastic("neo-hooke", (0.2e6,)),
    "mooney-rivlin": Hyperelastic("mooney-rivlin", (0.15e6, 0.05e6)),
    "yeoh": Hyperelastic("yeoh", (0.2e6, -0.01e6, 0.002e6)),
    "ogden": Hyperelastic("ogden", (0.4e6, 0.03e6), (1.3, -2.0)),
    "ogden of three": Hyperelastic("ogden", (0.4e6, 0.01e6, 0.0012e6), (1.3, -2.0, 5.0)),
    "hyperfoam": Hyperelastic("hyperfoam", (0.2e6, 0.05e6), (8.0, -3.0), 0.2),
}
K = 2e9


@cache
def fit_law(name):
    law = LAWS[name]
    foam = law.kind == "hyperfoam"
    span = (0.5, 1) if foam else (1, 3)
    tests = [simulate_loading(law, mode, span) for mode in SHEARING]
    words = {"law": law.kind, "temperature": 296.15}
    return fit_hyperelastic(tests, **words, terms=len(law.exponents) or "auto")


def card(target, name, fit=None, **words):
    bulk = {} if name == "hyperfoam" else {"bulk_modulus": K}
    density = {"density": 1200.0} if target == "lsdyna" else {}
    return deck_for(
        target, fit or fit_law(name), units="mm-t-s", **bulk, **density, **words
    )  # fmt: skip


def numbers(deck, after, before="\n*"):
    text = deck[deck.index(after) + len(after) :]
    _, _, text = text.partition("\n")
    text = (text + "\n*").split(before)[0]
    return [float(word) for word in re.split(r"[,\s]+", text.strip()) if word]


def terms(values, count):
    return tuple(values[0 : 2 * count : 2]), tuple(values[1 : 2 * count : 2])


def read_ansys_table(deck):
    rows = re.findall(r"TB,HYPER.*\n((?:TBDATA.*\n)+)", deck)[0]
    return [float(w) for row in rows.splitlines() for w in row.split(",")[2:]]


def read_back(target, name, deck):
    """The law that the solver's manual makes of the card, MPa, and its D1 or d."""
    law = LAWS[name]
    count = len(law.exponents)
    if target == "lsdyna":
        rows = [row for row in deck.splitlines() if row and row[0] not in "$*"]
        fields = [[float(row[i : i + 10]) for i in range(0, len(row), 10)] for row in rows]
        if not count:
            C = dict(zip(("C10", "C01", "C11", "C20", "C02", "C30"), fields[1], strict=False))
            return Hyperelastic(law.kind, tuple(C[item] for item in law.constant_names)), None
        mu = tuple(m * a / 2 for m, a in zip(fields[1], fields[2], strict=True))[:count]
        alpha = tuple(fields[2][:count])
        v = fields[0][3] / (1 + 2 * fields[0][3]) if law.kind == "hyperfoam" else 0.5
        return Hyperelastic(law.kind, mu, alpha, v), None
    if target == "ansys":
        values = read_ansys_table(deck)
        if law.kind == "neo-hooke":
            values[0] /= 2
        if not count:
            size = len(law.constants)
            return Hyperelastic(law.kind, tuple(values[:size])), values[size]
        m, alpha = terms(values, count)
        mu = tuple(value * a / 2 for value, a in zip(m, alpha, strict=True))
        beta = values[2 * count]
        v = beta / (1 + 2 * beta) if law.kind == "hyperfoam" else 0.5
        return Hyperelastic(law.kind, mu, alpha, v), beta
    values = numbers(deck, "*HYPER")
    if not count:
        size = len(law.constants)
        return Hyperelastic(law.kind, tuple(values[:size])), values[size]
    v = values[2 * count] if law.kind == "hyperfoam" else 0.5
    return Hyperelastic(law.kind, *terms(values, count), v), values[2 * count]


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("target", ["abaqus", "calculix", "ansys", "lsdyna"])
def test_a_card_says_the_law(target, name):
    result, volume = read_back(target, name, card(target, name))
    x, law = np.linspace(0.5, 2, 20), fit_law(name).law
    for mode in SHEARING:
        np.testing.assert_allclose(1e6 * result.nominal(mode, x), law.nominal(mode, x), rtol=2e-5,
                                   atol=20)  # fmt: skip
    if volume is not None and name != "hyperfoam":
        assert volume == pytest.approx(2 / 2000)


def test_card_holds_relaxation_of_the_law():
    from dataclasses import replace

    fit = replace(fit_law("mooney-rivlin"), relaxation=RELAXATION)
    k_0 = RELAXATION.k_0
    abaqus = card("abaqus", "mooney-rivlin", fit)
    assert "MOONEY-RIVLIN, MODULI=LONG TERM" in abaqus
    prony = np.array(numbers(abaqus, "TIME=PRONY")).reshape(-1, 3)
    np.testing.assert_allclose(prony[:, 0], np.array(RELAXATION.k) / k_0, rtol=1e-9)
    np.testing.assert_allclose(prony[:, 2], RELAXATION.tau, rtol=1e-9)
    assert not prony[:, 1].any()
    ansys = card("ansys", "mooney-rivlin", fit)
    # the constants of an Ansys law are those at once, its d too
    np.testing.assert_allclose(
        read_ansys_table(ansys), [0.15 * k_0, 0.05 * k_0, 2 / (2000 * k_0)], rtol=1e-6
    )
    assert "TB,PRONY,1,1,2,SHEAR" in ansys
    dyna = [row for row in card("lsdyna", "mooney-rivlin", fit).splitlines() if row[:1] == " "]
    G, beta = np.array([[float(row[:10]), float(row[10:20])] for row in dyna[2:]]).T
    np.testing.assert_allclose(G, 0.4 * np.array(RELAXATION.k), rtol=1e-5)
    np.testing.assert_allclose(beta, 1 / np.array(RELAXATION.tau), rtol=1e-5)
    assert "no relaxation for these" in card("calculix", "mooney-rivlin", fit)
    foam = replace(fit_law("hyperfoam"), relaxation=RELAXATION)
    prony = np.array(numbers(card("abaqus", "hyperfoam", foam), "TIME=PRONY")).reshape(-1, 3)
    np.testing.assert_array_equal(prony[:, 0], prony[:, 1])


def test_a_foam_without_swelling_is_no_division_by_zero():
    open_cell = fit_hyperelastic(
        [simulate_loading(Hyperelastic("hyperfoam", (0.2e6,), (8.0,), 0.0), "uniaxial", (0.5, 1))],
        poisson=0.0, temperature=296.15,
    )  # fmt: skip
    deck = card("lsdyna", "hyperfoam", open_cell)
    assert "n = 1e-06 stands for 0" in deck


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"units": None, "bulk_modulus": K}, "--unit-system"),
        ({}, "--bulk-modulus"),
        ({"bulk_modulus": K, "temperature": None, "cold": True}, "--temperature 23degC"),
        ({"bulk_modulus": K, "seals": 2.0}, "no --seals"),
        ({"bulk_modulus": K, "pitch": 1.0}, "take no --pitch"),
        ({"bulk_modulus": K, "frequency_range": (1.0, 9.0)}, "take no --band"),
    ],
)
def test_export_asks_for_missing_options_of_a_material_card(words, message):
    from dataclasses import replace

    fit = fit_law("mooney-rivlin")
    fit = replace(fit, temperature=None) if words.pop("cold", False) else fit
    with pytest.raises(ExportError, match=message):
        deck_for("abaqus", fit, **{"units": "SI", **words})


def test_others_are_refused():
    for target, message in (("nastran", "abaqus, calculix, ansys"), ("lsdyna", "--density")):
        with pytest.raises(ExportError, match=message):
            hyperelastic_card(
                target, fit_law("yeoh"), units="SI", bulk_modulus=K
            )  # fmt: skip
    with pytest.raises(ExportError, match="Poisson's ratio says"):
        hyperelastic_card("abaqus", fit_law("hyperfoam"), units="SI", bulk_modulus=K)


# -- CalculiX -------------------------------------------------------------------------------------

CUBE = "*NODE\n" + "\n".join(
    f"{i + 1}, {x}., {y}., {z}."
    for i, (x, y, z) in enumerate(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    )
)
FACES = {0: (2, 3, 6, 7), 1: (3, 4, 7, 8), 2: (5, 6, 7, 8)}
ZERO = {0: (1, 4, 5, 8), 1: (1, 2, 5, 6), 2: (1, 2, 3, 4)}
STRETCHED_AXES = {"uniaxial": (0,), "equibiaxial": (0, 1), "planar": (0,)}


def cube(deck, mode, stretch):
    """One element, faces plane and free to slide, stretched; a planar one keeps its width."""
    held = [(n, axis, 0.0) for axis, nodes in ZERO.items() for n in nodes]
    pulled = [(n, axis, stretch - 1) for axis in STRETCHED_AXES[mode] for n in FACES[axis]]
    pulled += [(n, 1, 0.0) for n in FACES[1]] if mode == "planar" else []
    ties = [
        (axis, nodes)
        for axis, nodes in FACES.items()
        if not any(axis == variant for _, variant, _ in pulled)
    ]
    lines = [CUBE, "*ELEMENT, TYPE=C3D8, ELSET=E", "1, 1, 2, 3, 4, 5, 6, 7, 8"]
    for axis, (first, *others) in ties:
        for n in others:
            lines += ["*EQUATION", "2", f"{n}, {axis + 1}, 1., {first}, {axis + 1}, -1."]
    lines += [*deck.splitlines(), "*SOLID SECTION, ELSET=E, MATERIAL=RUBBER", "*NSET, NSET=X"]
    lines += [", ".join(map(str, FACES[0]))]
    rows = [f"{n}, {axis + 1}, {axis + 1}, {u}" for n, axis, u in [*held, *pulled]]
    lines += ["*STEP, NLGEOM, INC=200", "*STATIC", "0.1, 1., 1e-5, 0.1", "*BOUNDARY", *rows]
    return "\n".join([*lines, "*NODE PRINT, NSET=X, TOTALS=ONLY", "RF", "*END STEP", ""])


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(("mode", "stretch"),
                         [("uniaxial", 0.7), ("equibiaxial", 1.4), ("planar", 1.5)])  # fmt: skip
def test_ccx_element_has_the_stress_of_the_hyperelastic_law(name, mode, stretch, tmp_path):
    (tmp_path / "deck.inp").write_text(cube(card("calculix", name), mode, stretch))
    run = subprocess.run(
        ["ccx", "-i", "deck"], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False
    )
    dat = (tmp_path / "deck.dat").read_text()
    assert dat, run.stdout[-2000:]
    force = float(re.findall(r"total force .*\n\n +(\S+)", dat)[-1])
    assert "*ERROR" not in run.stdout
    assert force == pytest.approx(1e-6 * float(LAWS[name].nominal(mode, stretch)), rel=1e-3)
