"""Fit of a relaxation test in strain and stress: its ramp and hold, moduli in Pa."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

from dashpot.base.checks import Check, Remedy
from dashpot.base.provenance import Step
from dashpot.datamodel.fit import Fit, scale_stiffness
from dashpot.datamodel.parameter_estimate import Nuisance
from dashpot.extensions.curves.datamodel.stress_relaxation import (
    UNIT_AREA,
    UNIT_LENGTH,
    StressRelaxationTest,
)
from dashpot.fitting.relaxation import fit as fit_relaxation
from dashpot.preprocessing.prepare import prepare

_STRESS_UNITS = {"µN": "Pa", "mN": "kPa", "N": "MPa", "kN": "GPa"}
"""Unit of a stress by that of a force on 1 mm²."""
_STRAIN_FACTORS = {"nm": 1e-4, "µm": 1e-1, "mm": 1e2}
"""Strain of a length of 1 mm, %, by the unit of the change."""
_FORCE_UNIT = re.compile(r"(?<=\d )(µN|mN|N|kN)(?=\b)")
_DISPLACEMENT = re.compile(r"(?<![\w.])(\d[\d,]*(?:\.\d+)?(?:e[+-]?\d+)?) (nm|µm|mm)\b")
_MACHINE = "machine"
_WORDS = {"displacement": "strain", "force": "stress", "stiffness": "modulus"}
_QUANTITIES = re.compile(rf"\b({'|'.join(_WORDS)})\b")


def fit_stress_relaxation(
    test: StressRelaxationTest, preparation_options: Any, **choices: Any
) -> Fit:
    r"""Fit a generalized Maxwell model to strain and stress over time.

    .. math:: \sigma(t) = E_\infty \varepsilon(t)
              + \sum_j E_j \int_0^t e^{-(t-u)/\tau_j} \dot\varepsilon(u)\,du

    It is the fit of a ramp and hold, of a specimen of length L and area A: k = E A/L, with all of
    its checks.

    Parameters
    ----------
    test : StressRelaxationTest
    preparation_options : mapping
        Arguments of `prepare`: filter, machine, onset, hold end, cycle.
    choices
        Of :func:`~dashpot.fitting.relaxation.fit`.

    Raises
    ------
    DataError, FitError
        As that of a relaxation test.
    """
    fit = fit_relaxation(prepare(test.make_unit_specimen_test(), **preparation_options), **choices)
    return convert_to_material(fit)


def convert_to_material(fit: Fit) -> Fit:
    """Return the fit of a specimen of 1 mm by 1 mm² as that of its material: Pa for N/m."""
    step = Step(
        "material",
        (("length_m", repr(UNIT_LENGTH)), ("area_m2", repr(UNIT_AREA))),
        "strain and stress fitted as the test of a specimen of 1 mm by 1 mm²: MPa are its N/mm",
    )
    material_fit = scale_stiffness(fit, UNIT_LENGTH / UNIT_AREA, step)
    residual = fit.estimate.residual
    return replace(
        material_fit,
        unit="Pa",
        elastic_law=None,
        estimate=replace(
            material_fit.estimate,
            residual=replace(
                residual, sse=residual.sse / UNIT_AREA**2, rms=residual.rms / UNIT_AREA, unit="Pa"
            ),
            nuisance=tuple(map(_convert_nuisance, fit.estimate.nuisance)),
        ),
        evidence=replace(
            fit.evidence,
            checks=tuple(map(_convert_check, fit.checks)),
            orders=tuple(
                replace(order, sse=order.sse / UNIT_AREA**2) for order in fit.evidence.orders
            ),
            end_of_hold=material_fit.evidence.end_of_hold,
            alternative=material_fit.evidence.alternative,
        ),
    )


def _convert_nuisance(nuisance: Nuisance) -> Nuisance:
    """Return an offset or a drift of the stress."""
    if not nuisance.unit.startswith("N"):
        return nuisance
    prior = nuisance.prior_sd
    return replace(
        nuisance,
        value=nuisance.value / UNIT_AREA,
        standard_error=nuisance.standard_error / UNIT_AREA,
        unit=nuisance.unit.replace("N", "Pa", 1),
        prior_sd=None if prior is None else prior / UNIT_AREA,
    )


def _convert_check(check: Check) -> Check:
    """Return a check with sentences on strain and stress instead of a machine's force."""
    remedy = check.remedy
    if remedy and remedy.option == _MACHINE:
        remedy = Remedy(remedy.words)
    return replace(
        check,
        message=convert_sentence(check.message),
        remedy=remedy and replace(remedy, words=convert_sentence(remedy.words)),
    )


def convert_sentence(text: str) -> str:
    """Return a sentence on a specimen of 1 mm by 1 mm² as one on its material.

    >>> convert_sentence("The force falls by 12 mN at 0.05 mm; stiffness 2 N/mm.")
    'The stress falls by 12 kPa at 5 %; modulus 2 MPa.'
    """
    text = re.sub(r"(?<=\d )N/mm\b", "MPa", text)
    text = _FORCE_UNIT.sub(lambda match: _STRESS_UNITS[match[1]], text)
    text = _DISPLACEMENT.sub(_format_strain, text)
    return _QUANTITIES.sub(lambda match: _WORDS[match[1]], text)


def _format_strain(match: re.Match[str]) -> str:
    return f"{float(match[1].replace(',', '')) * _STRAIN_FACTORS[match[2]]:.4g} %"
