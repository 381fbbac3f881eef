"""Decks of a fit with a shift law: the law on the card, the model at a temperature."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kit.fits import a_fit
from kit.shell import ran

import dashpot as dp
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.shift_factors import Shift, TemperatureShifts
from dashpot.datamodel.specimen import Specimen
from dashpot.export import FORMS, NEEDS, TARGETS
from dashpot.solids.demo_seals import BROAD, SHIFT
from dashpot.solids.shift_laws import Arrhenius, FreeShifts, TemperatureLaw
from dashpot.workflow.json_archive import to_json

AMBIENT = SHIFT.reference
TESTED = (273.15, 283.15, AMBIENT)
ENERGY = Arrhenius(9e4, AMBIENT)
FREE = FreeShifts(TESTED, (1.5, 0.77, 0.0), AMBIENT)


def moving(law: TemperatureLaw = SHIFT, vertical: str = "T/T_r", **specimen: object) -> Fit:
    """A fit of three temperatures whose solid follows a law."""
    shifts = tuple(Shift(t, float(law.log10_a_t(t)), 1e-3, t / AMBIENT) for t in TESTED)
    names = {"wlf": ("c1", "c2"), "arrhenius": ("energy",), "free": ()}[law.kind]
    doubt = np.zeros((len(names), len(names)))
    temperature_shifts = TemperatureShifts(law, shifts, np.zeros((6, 6)), names, doubt, vertical)
    expected = Specimen(**({"length": 0.1, "temperature": AMBIENT} | specimen))
    return replace(a_fit(BROAD, specimen=expected), temperatures=temperature_shifts)


def numbers(line: str) -> list[float]:
    return [float(cell) for cell in line.split(",") if cell.replace(".", "").strip("-e ").isdigit()]


def card(deck: str, keyword: str) -> list[str]:
    """The line of a keyword and the one after it."""
    lines = deck.splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith(keyword))
    return lines[at : at + 2]


def prony(target: str, fit: Fit, **more: object) -> str:
    return TARGETS[target](fit, **({"units": "mm-t-s", "form": "prony"} | more))


def test_abaqus_shifts_by_wlf():
    head, row = card(prony("abaqus", moving()), "*TRS")
    assert head == "*TRS, DEFINITION=WLF"
    reference, c1, c2 = numbers(row)
    t = np.array(TESTED)
    # the manual: -log10 A = C1 (theta - theta_0) / (C2 + theta - theta_0)
    by_the_manual = -c1 * (t - reference) / (c2 + t - reference)
    np.testing.assert_allclose(by_the_manual, SHIFT.log10_a_t(t), atol=1e-8)
    deck = prony("abaqus", moving())
    assert deck.index("*VISCOELASTIC, TIME=PRONY") < deck.index("\n*TRS")
    assert deck.rstrip().endswith(row)


def test_abaqus_shifts_by_arrhenius():
    deck = prony("abaqus", moving(ENERGY))
    head, row = card(deck, "*TRS")
    assert head == "*TRS, DEFINITION=ARRHENIUS"
    reference, energy = numbers(row)
    assert "*PHYSICAL CONSTANTS, ABSOLUTE ZERO=0.,\n** UNIVERSAL GAS=8.314462618" in deck
    t = np.array(TESTED)
    by_the_manual = energy / 8.314462618 * (1 / t - 1 / reference)
    np.testing.assert_allclose(by_the_manual / np.log(10), ENERGY.log10_a_t(t), atol=1e-8)


def test_ansys_shifts_by_wlf_and_by_tool_and_narayanaswamy():
    head, row = card(prony("ansys", moving()), "TB,SHIFT")
    assert head == "TB,SHIFT,1,1,3,WLF"
    assert row == "TBDATA,1,296.15,6.943703704,129.6"
    head, row = card(prony("ansys", moving(ENERGY)), "TB,SHIFT")
    assert head == "TB,SHIFT,1,1,2,TN"
    _, reference, over_r = (float(word) for word in row.split(",")[1:])
    t = np.array(TESTED)
    np.testing.assert_allclose(
        over_r * (1 / t - 1 / reference) / np.log(10), ENERGY.log10_a_t(t), atol=1e-8
    )


@pytest.mark.parametrize("target", ["abaqus", "ansys"])
def test_there_is_no_card_without_a_law(target):
    still = a_fit(BROAD, specimen=Specimen(temperature=AMBIENT, length=0.1))
    for fit in (still, moving(FREE)):
        deck = prony(target, fit)
        assert "*TRS" not in deck
        assert "TB,SHIFT" not in deck
    assert "temperature law" not in prony(target, still)
    assert (
        "temperature law: none; log10 a_T is 1.5 at 273.15 K, 0.77 at 283.15 K, 0. at 296.15 K, "
        "straight in 1/T between them"
    ) in prony(target, moving(FREE))


@pytest.mark.parametrize("target", sorted(TARGETS))
def test_every_deck_says_the_law_and_its_constants(target):
    more = dict.fromkeys(NEEDS[target].get(FORMS[target][0], ()), 1e6)
    deck = TARGETS[target](moving(), units="SI", **more)
    assert "temperature law: WLF, log10 a_T = -C1 (T - T_r)/(C2 + T - T_r)" in deck
    assert "C1 = 6.943703704, C2 = 129.6 K, T_r = 296.15 K" in deck
    assert "tested from 0 degC to 23 degC; relaxation times go with a_T, stiffnesses with" in deck
    warm = TARGETS[target](moving().at_temperature(353.15), units="SI", **more)
    assert "tested from 0 degC to 23 degC" in warm
    assert "T_r = 353.15 K" in warm
    energy = TARGETS[target](moving(ENERGY), units="SI", **more)
    assert "E = 90000. J/mol, E/R = 10824.51195 K" in energy


@pytest.mark.parametrize(
    ("vertical", "message"),
    [
        ("T/T_r", "stiffnesses with b_T = T/T_r"),
        ("free", "stiffnesses with b_T = 0.9223 at 0 degC to 1 at 23 degC"),
        ("1", ""),
    ],
)
@pytest.mark.parametrize("target", ["abaqus", "ansys"])
def test_prony_card_states_what_the_shift_cannot_carry(target, vertical, message):
    deck = prony(target, moving(vertical=vertical))
    assert message in deck
    assert ("the stiffness b_T above is not in it" in deck) == bool(message)


@pytest.mark.parametrize("target", sorted(TARGETS))
@pytest.mark.parametrize("law", [SHIFT, ENERGY, FREE])
def test_deck_at_a_temperature_equals_deck_of_the_shifted_fit(target, law):
    more = dict.fromkeys(NEEDS[target].get(FORMS[target][0], ()), 1e6)
    fit = moving(law)
    specimen = Specimen(length=0.1, temperature=278.15)
    deck = TARGETS[target](fit, units="SI", specimen=specimen, **more)
    # byte for byte that of the fit that was moved first, whose temperature no check judges
    variant = TARGETS[target](fit.at_temperature(278.15), units="SI", **more)
    assert deck.replace(" 1 check passed.", "") == variant
    there = fit.at("5degC")
    assert f"model: k_inf = {there.k_inf:.10g} N/m" in deck
    assert all(f"tau = {tau:.10g} s" in deck for tau in there.tau)
    assert "temperature: 278.15 K (5 degC)" in deck
    assert "at 5 degC, a_T = " in deck
    # its law moves along
    assert (" at 278.15 K" if law is FREE else "T_r = 278.15 K") in deck


def test_a_temperature_that_nobody_noted_is_stated():
    unnoted = a_fit(BROAD, specimen=Specimen(length=0.1))
    with pytest.raises(dp.ExportError, match="test temperature is not stated"):
        prony("abaqus", unnoted)
    deck = prony("abaqus", unnoted, specimen=Specimen(length=0.1, temperature=253.15))
    assert "temperature: 253.15 K (-20 degC)" in deck
    assert "a_T" not in deck


@pytest.mark.parametrize(("kelvin", "refused"), [(AMBIENT + 0.5, False), (AMBIENT + 0.501, True)])
def test_deck_of_one_temperature_refuses_another(kelvin, refused):
    fit = a_fit(BROAD, specimen=Specimen(length=0.1, temperature=AMBIENT))
    specimen = Specimen(length=0.1, temperature=kelvin)
    if not refused:
        assert "k_inf = 0.1965 N/mm" in prony("abaqus", fit, specimen=specimen)
        return
    with pytest.raises(dp.ExportError, match="fit tests at several temperatures together; if the"):
        prony("abaqus", fit, specimen=specimen)


@pytest.mark.parametrize(
    ("celsius", "excess"), [(0.0, False), (23.0, False), (-0.01, True), (23.01, True)]
)
def test_deck_outside_the_tested_temperatures_is_to_be_used_with_care(celsius, excess):
    specimen = Specimen(length=0.1, temperature=celsius + 273.15)
    deck = TARGETS["abaqus"](moving(), units="SI", specimen=specimen)
    assert ("CHECK FAILED" in deck) == excess
    assert ("The WLF law is extrapolated" in deck) == excess
    assert deck.verdict.use == ("use with care" if excess else "use")


def test_too_near_the_glass_is_refused():
    specimen = Specimen(length=0.1, temperature=218.15 + 9.99)
    with pytest.raises(dp.ExportError, match="glass transition"):
        prony("abaqus", moving(), specimen=specimen)


def test_the_command_asks_for_a_temperature(tmp_path):
    fit, deck = tmp_path / "fit.json", tmp_path / "a.inp"
    fit.write_text(to_json(moving()))
    words = ["export", fit, "--to", "abaqus", "--unit-system", "SI", "--seals", 2, "-o", deck]
    assert ran(*words, "--temperature", "-20degC").exit_code == 0
    text = deck.read_text()
    assert "temperature: 253.15 K (-20 degC)" in text
    assert "contact length: 0.2 m" in text
    assert f"model: k_inf = {2 * 196.5 * 253.15 / AMBIENT:.10g}" in text
    refused = ran(*words, "--temperature", "-50degC")
    assert refused.exit_code == 2
    assert "glass transition" in refused.output
