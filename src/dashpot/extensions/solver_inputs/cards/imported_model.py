"""Model of a solver card as a fit, with the arms that a test could have determined."""

from __future__ import annotations

from math import inf

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import FitError, ReadError
from dashpot.base.number_format import format_band
from dashpot.base.provenance import Source, Step
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import format_quantity
from dashpot.base.value_ranges import require_positive
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import Evidence, Provenance
from dashpot.datamodel.parameter_estimate import ParameterEstimate, Residual
from dashpot.datamodel.shift_factors import Shift, TemperatureShifts
from dashpot.datamodel.specimen import Specimen
from dashpot.export.unit_systems import UnitSystem
from dashpot.extensions.solver_inputs.cards.card import FrequencyTable, ViscoelasticCard
from dashpot.extensions.solver_inputs.cards.checks import (
    arms_testable,
    table_followed,
    test_behind_model,
)
from dashpot.extensions.solver_inputs.cards.testable_arms import TestableArm, find_testable_arms
from dashpot.fitting.fit_construction import SolidEstimate, build_fit
from dashpot.planning.planned_ramp_hold import Bench
from dashpot.registry import list_names, require_handler
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import WLF

METHOD = "card"
"""Method of a fit whose model comes from a card."""


@dataclass(frozen=True)
class ImportedModel(Serialisable):
    """Model of a solver card, and which of its arms a ramp and hold could have determined.

    Attributes
    ----------
    card : str
        Name of the material or property.
    keyword : str
    fit : Fit
        The model as a fit, without errors, because no test of it is known.
    test : Bench
        The planned ramp and hold.
    arms : tuple of TestableArm
    testable_band : (float, float) or None
        Band in which that test would determine |K| to 10 % and the loss factor to 30 %, Hz.
    notes : tuple of str
        Unread parts of the card, and assumptions.
    """

    schema = "dashpot/imported@1"
    _keys = (
        "card",
        "keyword",
        "fit.model",
        "fit.unit",
        Key("test", "_test_terms"),
        Key("arms", nonfinite_as_null=True),
        Key("testable_band_hz", "testable_band"),
        "notes",
        "verdict",
    )
    _is_loadable = False

    card: str
    keyword: str
    fit: Fit
    test: Bench
    arms: tuple[TestableArm, ...]
    testable_band: tuple[float, float] | None
    notes: tuple[str, ...]
    checks: tuple[Check, ...]

    @property
    def _test_terms(self) -> dict[str, float]:
        test = self.test
        return {"depth": test.depth, "ramp_time": test.ramp_time, "hold_time": test.hold_time,
                "rate": test.rate, "noise": test.noise, "baseline": test.baseline}  # fmt: skip

    @property
    def _headline(self) -> str:
        """The band that such a test could have determined."""
        if self.testable_band is None:
            return "Such a test could have determined the damping nowhere"
        return f"Such a test could have determined the model {format_band(self.testable_band)}"

    @property
    def verdict(self) -> Verdict:
        """Verdict on the imported model."""
        return verdict(self.checks, headline=self._headline)


def import_card(
    card: ViscoelasticCard,
    units: UnitSystem,
    source: Source,
    *,
    test: Bench,
    relative_noise: float | None = None,
    modulus: float | None = None,
    stated_modulus: float | None = None,
    specimen: Specimen | None = None,
) -> ImportedModel:
    """Return the model of a card as a fit, with the arms that a test could have determined.

    Parameters
    ----------
    card : ViscoelasticCard
    units : UnitSystem
    source : Source
    test : Bench
        Its noise is replaced where `relative_noise` is given, in parts of the largest force.
    modulus : float, optional
        Instantaneous Young's modulus, Pa, of a card that has none.
    stated_modulus : float, optional
        The instantaneous modulus in the comments of the file, Pa, used if there is no other.
    specimen : Specimen, optional

    Raises
    ------
    ReadError
        If a modulus is missing, or no springs and dashpots follow the card.
    """
    require_positive(relative_noise=relative_noise, optional=True)
    error = None
    if card.table is None:
        if card.is_material and card.modulus is None and modulus is None and stated_modulus:
            modulus = stated_modulus
            note = f"the modulus of {format_quantity(modulus, 'MPa')} is that of the comments"
            card = replace(card, notes=(*card.notes, note))
        model = card.convert_to_model(units, modulus)
    else:
        model, error = _fit_table(card.table, card.name)
    if model.arms == 0 and model.b == 0:
        raise ReadError(f"{card.keyword} of {card.name} is elastic: it has no relaxation")
    arms: tuple[TestableArm, ...] = ()
    band = None
    bench = replace(test, machine=None)
    if relative_noise is not None:
        time = [bench.ramp_time]
        peak = float(model.ramp_hold_force(time, depth=bench.depth, ramp_time=bench.ramp_time)[0])
        bench = replace(bench, noise=relative_noise * peak)
    if model.arms:
        arms, band = find_testable_arms(model, bench)
    undetermined = sum(not arm.is_determined for arm in arms)
    band_text = (
        "It could have determined damping nowhere"
        if band is None
        else (f"It could have determined the model {format_band(band)}")
    )
    model_check = test_behind_model(card.keyword)
    checks: tuple[Check, ...] = (table_followed(error), model_check)
    fit = _build_fit(card, model, (model_check,), source, specimen or Specimen())
    if arms:
        checks = (arms_testable(undetermined, len(arms), band_text), *checks)
    return ImportedModel(card.name, card.keyword, fit, bench, arms, band, card.notes, checks)


def _build_fit(
    card: ViscoelasticCard,
    model: GeneralizedMaxwell,
    checks: tuple[Check, ...],
    source: Source,
    specimen: Specimen,
) -> Fit:
    shifts = None
    if card.law is not None:
        no_shift = Shift(card.law.reference, 0.0, 0.0)
        names = ("c1", "c2") if isinstance(card.law, WLF) else ("energy",)
        exact = np.zeros((len(names), len(names)))
        shifts = TemperatureShifts(
            card.law, (no_shift,), np.zeros((2, 2)), names, exact, vertical="1"
        )
        specimen = replace(specimen, temperature=card.law.reference)
    step = Step(
        "import", (("keyword", card.keyword), ("card", card.name)), f"model of {card.keyword}"
    )
    unknown = ParameterEstimate((), np.zeros((0, 0)), inf, Residual(0, 1.0, 0.0))
    return build_fit(
        SolidEstimate(model, unknown),
        Evidence((0.0, 0.0), checks=checks),
        Provenance(METHOD, (source,), (step,), specimen),
        unit="Pa" if card.is_material else "N/m",
        temperatures=shifts,
    )


def _fit_table(table: FrequencyTable, name: str) -> tuple[GeneralizedMaxwell, float]:
    """Return springs and dashpots of a frequency table, and their largest relative error.

    Raises
    ------
    ReadError
        If there are too few rows, or none with damping.
    """
    task = "fit complex modulus"
    fit_modulus = require_handler(task, next(iter(list_names(task)), ""))
    try:
        model = fit_modulus(table.frequency, table.stiffness).model
    except FitError as error:
        raise ReadError(
            f"the table of {name} has no model of springs and dashpots: {error}"
        ) from None
    K = model.complex_stiffness(omega=2 * np.pi * table.frequency)
    return model, float(np.abs(K / table.stiffness - 1).max())
