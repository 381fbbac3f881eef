"""Construction of a deck from a solid or fit, or its refusal with the reasons."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import Protocol, TypeAlias

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import ExportError
from dashpot.base.provenance import Source, Step
from dashpot.base.units import format_quantity
from dashpot.base.version import byline
from dashpot.datamodel.fit import Fit, list_arm_values
from dashpot.datamodel.shift_factors import TemperatureShifts
from dashpot.datamodel.specimen import Specimen
from dashpot.export.checks import nominal_in_valid_band, rows_in_valid_band
from dashpot.export.frequency_tables import Damping, Table, round_band_inwards, tabulate
from dashpot.export.unit_systems import UnitSystem, convert_to_printable_ascii, text
from dashpot.registry import find_handler
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.jenkins import Jenkins
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid
from dashpot.solids.nonlinear_springs import Cubic
from dashpot.solids.rate_independent import RateIndependent

# Sliders and cubic springs in deck units.


CARRIERS = MappingProxyType(
    {
        "abaqus": ("arms",),
        "ansys": ("arms",),
        "calculix": ("arms",),
        "lsdyna": ("arms",),
        "opensees": ("network", "network-tcl", "python", "tcl"),
    }
)
"""Forms of each target that can represent nonlinear springs."""

_CUBIC_RANGE = 2.0
"""Range of the table of a cubic spring, relative to the largest tested amplitude."""
_CUBIC_POINTS = 80
_UNTESTED_AMPLITUDE = 0.01
"""Default largest amplitude, m, if none was tested."""
_NODE_DISTANCE_RATIO = 1000
"""Distance of the nodes over the largest amplitude: elements that follow them hardly rotate."""


@dataclass(frozen=True)
class NonlinearElements:
    """Sliders and a cubic spring in parallel with a model; empty if it is linear.

    Attributes
    ----------
    units : UnitSystem
    parts : tuple of Jenkins or Cubic
        SI.
    amplitudes : (float, float)
        Range of displacement amplitudes that the tests cover, m.
    """

    units: UnitSystem
    parts: tuple[RateIndependent, ...] = ()
    amplitudes: tuple[float, float] = (0.0, 0.0)

    @property
    def sliders(self) -> tuple[tuple[float, float, float], ...]:
        """Each slider's stiffness, force at which it slips, and displacement there, deck units."""
        return tuple(
            (
                self.units.stiffness(part.k),
                part.slip / self.units.force,
                part.yields_at / self.units.length,
            )
            for part in self.parts
            if isinstance(part, Jenkins)
        )

    @property
    def k3(self) -> float:
        """Stiffness of the cubic springs, deck units."""
        total = sum(part.k3 for part in self.parts if isinstance(part, Cubic))
        return total * self.units.length**3 / self.units.force

    @property
    def span(self) -> float:
        """Distance of the two nodes, deck units, large against the amplitude."""
        max_compression = (self.amplitudes[1] or _UNTESTED_AMPLITUDE) / self.units.length
        return float(10.0 ** np.ceil(np.log10(_NODE_DISTANCE_RATIO * max_compression)))

    @property
    def node_spacing_remarks(self) -> list[str]:
        """Header lines on the distance of the two nodes, where elements rotate with them."""
        span_text = f"{text(self.span)} {self.units.words[0]}"
        remark = (
            f"keep the two nodes {span_text} apart: at a short distance compression inverts the "
            "elements"
        )
        return [remark]

    def compute_curve(
        self, points: int = _CUBIC_POINTS, *, k: float = 0.0
    ) -> list[tuple[float, float]]:
        r"""Return displacement and force of the cubic spring and a parallel one of `k`, from 0 on.

        At :math:`x_i \propto (i/n)^{2/3}`, where linear interpolation has the same error of force
        in each interval.
        """
        compressions = (np.arange(points + 1) / points) ** (2 / 3)
        x = _CUBIC_RANGE * self.amplitudes[1] / self.units.length * compressions
        return list(zip(x.tolist(), (k * x + self.k3 * x**3).tolist(), strict=True))

    def compute_symmetric_curve(self) -> list[tuple[float, float]]:
        """Return the same curve from compression to tension."""
        positive_half = self.compute_curve()
        return [(-x, -F) for x, F in positive_half[:0:-1]] + positive_half

    @property
    def header_lines(self) -> list[str]:
        """Header lines on sliders and cubic spring."""
        if not self.amplitudes[1]:
            return []
        length, force = self.units.words[0], self.units.words[3]
        low, high = (amplitude / self.units.length for amplitude in self.amplitudes)
        lines = [
            f"  slider {i}: k = {text(k)} {self.units.stiffness_word}, slips at {text(F)} {force} "
            f"({text(x)} {length})"
            for i, (k, F, x) in enumerate(self.sliders, start=1)
        ]
        if self.k3:
            lines.append(
                f"  cubic spring: k3 = {text(self.k3)} {force}/{length}^3, piecewise linear to "
                f"{text(_CUBIC_RANGE * high)} {length} in both directions; not valid beyond"
            )
        tested_text = f"displacement amplitudes tested: {low:.4g} to {high:.4g} {length}"
        return [*lines, f"{tested_text}; other amplitudes are EXTRAPOLATED"]

    def refuse_unsupported(self, target: str, form: str) -> None:
        """Raise where the target's form holds neither friction nor a cubic spring.

        Raises
        ------
        ExportError
        """
        supported = CARRIERS.get(target, ())
        if not self.parts or form in supported:
            return
        slider_count = len(self.sliders)
        name = f"{slider_count} slider{'s' * (slider_count != 1)}" if slider_count else ""
        name += " and " * bool(slider_count and self.k3) + "a cubic spring" * bool(self.k3)
        other = (
            f"use --form {supported[0]} (Python: form='{supported[0]}')"
            if supported
            else f"use a target that supports them: --to {', '.join(CARRIERS)}"
        )
        raise ExportError(
            f"{target} decks of the form '{form}' are linear, but this fit has {name} in "
            f"parallel with the arms; {other}"
        )


def format_temperature_lines(task: str, shifts: TemperatureShifts | None) -> list[str]:
    """Return the lines of ``"deck header"`` or ``"deck remarks"`` on the temperature law."""
    format_lines = None if shifts is None else find_handler(task, shifts)
    return [] if format_lines is None else list(format_lines(shifts))


class NonlinearFit(Protocol):
    """Fit of a linear model with sliders and a cubic spring in parallel."""

    @property
    def solid(self) -> Solid: ...  # noqa: D102
    @property
    def rate_independent(self) -> tuple[RateIndependent, ...]: ...  # noqa: D102
    @property
    def amplitudes(self) -> tuple[float, float]: ...  # noqa: D102
    @property
    def _identity(self) -> str: ...
    @property
    def band(self) -> tuple[float, float]: ...  # noqa: D102
    @property
    def specimen(self) -> Specimen: ...  # noqa: D102
    @property
    def source(self) -> tuple[Source, ...]: ...  # noqa: D102
    @property
    def steps(self) -> tuple[Step, ...]: ...  # noqa: D102
    @property
    def checks(self) -> tuple[Check, ...]: ...  # noqa: D102
    @property
    def verdict(self) -> Verdict: ...  # noqa: D102
    @property
    def _headline(self) -> str: ...


Exportable: TypeAlias = Solid | Fit | NonlinearFit
"""Value that can be exported: a model alone, or a fit, whose deck states files and steps."""

NOT_VERIFIED = "not solver-verified: no solver of this kind runs in dashpot's tests"

_MODEL_STEPS = ("parallel", "compression", "temperature", "aging", "draw")
"""Steps that changed the fitted model."""


class DeckText(str):
    """Text of a deck, with the contents of its header.

    Attributes
    ----------
    verdict : Verdict or None
        Verdict of the fit behind it, over the rows written; None for a bare solid.
    checks : tuple of Check
        Checks of the fit, and whether its valid band includes the rows.
    overrides : tuple of str
        Reasons against the export that were overridden.
    """

    verdict: Verdict | None
    checks: tuple[Check, ...]
    overrides: tuple[str, ...]
    printable = True
    """Whether its file is the text itself, and no archive of it."""

    @property
    def summary(self) -> str:
        """Contents of its file, in a few words."""
        return f"{len(self.splitlines())} lines"

    @property
    def file_content(self) -> str | bytes:
        """Contents of its file: the text, or an archive made from it."""
        return str(self)


@dataclass(frozen=True)
class Deck:
    """Model to export, with the data for the header of its deck.

    Attributes
    ----------
    solid : Solid
        SI.
    units : UnitSystem
    specimen : Specimen
    form : str
        ``"prony"`` is a material card of relative moduli; every other form is of a part.
    fit : Fit or NonlinearFit or None
        Source of the solid; None for a bare one.
    overrides : tuple of str
        Reasons against the export that were overridden, one sentence each.
    """

    solid: Solid
    units: UnitSystem
    specimen: Specimen
    form: str = ""
    fit: Fit | NonlinearFit | None = None
    overrides: tuple[str, ...] = ()

    def with_solid(self, solid: Solid) -> Deck:
        """Return the same deck of another model."""
        return replace(self, solid=solid)

    # -- the solid in deck units ----------------------------------------------------------------

    @cached_property
    def model(self) -> GeneralizedMaxwell:
        """The generalized Maxwell form of the model, SI."""
        return self.solid.maxwell

    @property
    def material(self) -> bool:
        """Whether it is a material, with moduli, Pa, in place of stiffnesses."""
        return self.linear_fit is not None and self.linear_fit.unit == "Pa"

    @property
    def k_inf(self) -> float:
        """Equilibrium stiffness, or modulus, deck units."""
        return self._stiffness(self.model.k_inf)

    @property
    def b(self) -> float:
        """Parallel dashpot, or viscosity, deck units."""
        return self._stiffness(self.model.b) / self.units.time

    @property
    def arms(self) -> tuple[tuple[float, float, float], ...]:
        """Each arm's k, tau, b = k tau, deck units."""
        time = self.units.time
        return tuple(
            (self._stiffness(k), tau / time, self._stiffness(b) / time)
            for k, tau, b in zip(self.model.k, self.model.tau, self.model.arm_b, strict=True)
        )

    def _stiffness(self, si: float) -> float:
        return self.units.stress(si) if self.material else self.units.stiffness(si)

    @cached_property
    def nonlinear_elements(self) -> NonlinearElements:
        """Sliders and cubic spring in parallel with the arms, deck units; empty if linear."""
        if self.fit is None or isinstance(self.fit, Fit):
            return NonlinearElements(self.units)
        return NonlinearElements(self.units, self.fit.rate_independent, self.fit.amplitudes)

    @property
    def prony(self) -> list[tuple[float, float]]:
        """Each arm's g_j = k_j / k_0 and tau_j, deck units."""
        return [
            (k / self.model.k_0, tau / self.units.time)
            for k, tau in zip(self.model.k, self.model.tau, strict=True)
        ]

    def shear(self, modulus: float | None, target: str) -> tuple[float, list[tuple[float, float]]]:
        """G_inf, and G_j = G_0 k_j / k_0 and beta_j = 1 / tau_j of each arm, deck units.

        Raises
        ------
        ExportError
            If the instantaneous modulus G_0, Pa, is not given: a part's stiffness shows none, and
            a material's fit does not say whether its modulus is of shear.
        """
        if modulus is None or not modulus > 0:
            advice = (
                "which the stiffness of a part does not determine (found modulus = "
                f"{modulus!r}); give it, e.g. --modulus 1MPa"
            )
            if self.material:
                modulus_mpa, shear_modulus_mpa = self.model.k_0 / 1e6, self.model.k_0 / 3e6
                advice = (
                    f"and the fit does not state the kind of its modulus of {modulus_mpa:.4g} MPa; "
                    f"give --modulus {modulus_mpa:.4g}MPa if it was measured in shear, a third of "
                    f"it, --modulus {shear_modulus_mpa:.4g}MPa, if in tension or compression"
                )
            raise ExportError(
                f"a {target} material needs the instantaneous shear modulus of the rubber, "
                f"{advice} (Python: modulus=, Pa)"
            )
        G_0 = self.units.stress(modulus)
        terms = [(g * G_0, 1 / tau) for g, tau in self.prony]
        return G_0 * self.model.k_inf / self.model.k_0, terms

    def table(
        self,
        frequency_range: tuple[float, float],
        tolerance: float,
        *,
        solid: Solid | None = None,
        damping: Damping = "loss_factor",
        format_number: Callable[[float], str] = text,
    ) -> Table:
        """Return the frequency table of the model, or of another, SI, with the printed digits."""
        return tabulate(
            solid or self.solid,
            frequency_range=frequency_range,
            tolerance=tolerance,
            damping=damping,
            edges=self.band or (),
            rounded=lambda value: float(format_number(value)),
        )

    # -- header ----------------------------------------------------------------------------------

    @property
    def linear_fit(self) -> Fit | None:
        """The fit behind the deck, if it is linear."""
        return self.fit if isinstance(self.fit, Fit) else None

    @property
    def temperatures(self) -> TemperatureShifts | None:
        """Shift factors of the fit."""
        return self.linear_fit.temperatures if self.linear_fit else None

    @property
    def elastic_law(self) -> ElasticLaw | None:
        """Elastic law of the fit."""
        return self.linear_fit.elastic_law if self.linear_fit else None

    @property
    def band(self) -> tuple[float, float] | None:
        """Valid band of the fit, Hz; None of a model without a fit."""
        return self.fit.band if self.fit else None

    @property
    def default_band(self) -> tuple[float, float] | None:
        """Range of a table, Hz, where none is given: the valid band of a fit that has one."""
        low, high = self.band or (0.0, 0.0)
        return round_band_inwards((low, high)) if 0 < low < high < math.inf else None

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of the fit behind the deck; none of a model without a fit."""
        return self.fit.checks if self.fit else ()

    def is_extrapolated(self, frequency: float) -> bool:
        """Return whether a frequency, Hz, lies outside the valid band; False without a band."""
        return self.band is not None and not self.band[0] <= frequency <= self.band[1]

    def format_text(
        self,
        comment: str,
        title: str,
        body: Sequence[str],
        *,
        verified: str = NOT_VERIFIED,
        remarks: Sequence[str] = (),
        table: Table | None = None,
        nominal: float | None = None,
        function: Callable[[str], str] = convert_to_printable_ascii,
    ) -> DeckText:
        """Return the text of the deck: its header as comments of the target, then its cards.

        The header describes a `table` and its rows outside the valid band, and states if the
        `nominal` frequency, Hz, of the stiffness is outside it. `function` converts a line of the
        header to characters that the target accepts.
        """
        band_checks = self._check_valid_band(table, nominal)
        verdict = self._verdict(band_checks)
        header = [
            byline(title),
            *(() if verdict is None else (f"{verdict.use.upper()}: {verdict.message}",)),
            *self._format_header_lines(),
            verified,
            *remarks,
            *(() if table is None else (table.sentence,)),
            *(f"EXTRAPOLATED: {check.message}" for check in band_checks if check.failed),
        ]
        lines = [*(f"{comment} {function(line)}" for line in header), *body, ""]
        deck_text = DeckText("\n".join(lines))
        deck_text.verdict, deck_text.overrides = verdict, self.overrides
        deck_text.checks = (*self.checks, *band_checks)
        return deck_text

    def _check_valid_band(self, table: Table | None, nominal: float | None) -> tuple[Check, ...]:
        """Return the checks that the rows of a table and a nominal frequency are in the band."""
        checks: list[Check] = []
        if nominal is not None and self.band is not None:
            checks.append(nominal_in_valid_band(self.is_extrapolated(nominal), nominal))
        if table is not None and self.band is not None:
            f = table.frequency.tolist()
            outside_frequencies = [item for item in f if self.is_extrapolated(item)]
            checks.append(
                rows_in_valid_band(
                    len(outside_frequencies),
                    len(f),
                    *((outside_frequencies or f)[i] for i in (0, -1)),
                )
            )
        return tuple(checks)

    def _verdict(self, band_checks: tuple[Check, ...]) -> Verdict | None:
        if self.fit is None:
            return None
        # the fit's own checks are counted, as its text counts them
        failed_checks = tuple(check for check in band_checks if check.failed)
        return verdict((*self.fit.checks, *failed_checks), headline=self.fit._headline)

    def _format_header_lines(self) -> list[str]:
        units, specimen = self.units, self.specimen
        length, mass, time, force, stress = units.words
        stiffness, damping = units.stiffness_word, units.damping_word
        if self.material:
            stiffness, damping = stress, f"{stress} {time}"
        kelvin, metres = specimen.temperature, specimen.length
        length_text = "not stated" if metres is None else f"{metres / units.length:.6g} {length}"
        words = f"{length}, {mass}, {time}, {force}, {stress}"
        parallel = f", b = {text(self.b)} {damping}" if self.b > 0 else ""
        described = [
            f"UNITS: {units.name}: {words}; frequency in {units.frequency_word}",
            f"model: k_inf = {text(self.k_inf)} {stiffness}{parallel}",
            *self._limits(stiffness),
        ]
        for j, (k, tau, b) in enumerate(self.arms, start=1):
            centre = 1 / (2 * math.pi * self.model.tau[j - 1])
            outside = f" [{centre:.4g} Hz lies outside the valid band]"
            described.append(
                f"  arm {j}: k = {text(k)} {stiffness}, tau = {text(tau)} {time}, "
                f"b = {text(b)} {damping}{outside * self.is_extrapolated(centre)}"
            )
        if self.model is not self.solid:
            described.append(
                f"  the arms approximate a {type(self.solid).__name__}; tables are computed from it"
            )
        return [
            *described,
            *self.nonlinear_elements.header_lines,
            "temperature: "
            + (
                "not stated"
                if kelvin is None
                else f"{kelvin:.6g} K ({format_quantity(kelvin, 'degC')})"
            ),
            *([] if self.material else [f"contact length: {length_text}"]),
            *format_temperature_lines("deck header", self.temperatures),
            *self._elastic_law(),
            *self._origin_lines(),
            self._format_valid_band(),
            *(f"OVERRIDE: {sentence}" for sentence in self.overrides),
            *(
                f"{'NOTE' if check.grade == 'note' else 'CHECK FAILED'}: {check.message}"
                for check in self.checks
                if check.failed
            ),
        ]

    def _limits(self, unit: str) -> list[str]:
        """Return the header lines on the upper limit of k_inf."""
        fit = self.linear_fit
        if fit is None or fit.model.k_inf != self.model.k_inf:
            return []
        reported_value = list_arm_values(fit)[0]
        if not reported_value.is_at_most:
            return []
        upper_text = f"{self._stiffness(reported_value.high):.4g} {unit}"
        return [f"  k_inf is at most {upper_text}; the tests give no lower limit"]

    def _elastic_law(self) -> list[str]:
        """Return the header lines on a nonlinear elastic law."""
        law = self.elastic_law
        if law is None or law.kind == "linear":
            return []
        tangents = zip(law.knots, law.tangent(law.knots), strict=True)
        stiffness_texts = ", ".join(
            f"{self.units.stiffness(float(k)):.4g} {self.units.stiffness_word} at "
            f"{x / self.units.length:.4g} {self.units.words[0]}"
            for x, k in tangents
        )
        meaning = (
            "  the stiffnesses above are secants at the largest compression; small vibration about "
            "a compression depends on the tangent there (dashpot export --compression)"
        )
        return [f"elastic law: nonlinear; its tangent k_inf is {stiffness_texts}", meaning]

    def _origin_lines(self) -> list[str]:
        """Return the header lines on the fit and its files."""
        steps = () if self.fit is None else self.fit.steps
        scaled = [step.message for step in steps if step.name in _MODEL_STEPS]
        lines = []
        if self.fit is None or not self.fit.source:
            lines.append("source: a model in memory, without a file")
            lines += scaled
        else:
            lines.append(f"fit: {', '.join([self.fit._identity, *scaled])}")
            lines += [f"source: {source.file} sha256 {source.sha256}" for source in self.fit.source]
            if any(source.simulated for source in self.fit.source):
                lines.append("SIMULATED: the tests of this model were simulated")
        return lines

    def _format_valid_band(self) -> str:
        if self.band is None:
            return "valid band: not stated; extrapolated values are not marked"
        band = f"valid band: {self.band[0]:.4g} to {self.band[1]:.4g} Hz"
        return f"{band}; values outside are EXTRAPOLATED from the fitted arms"
