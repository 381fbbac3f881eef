"""Prediction of a drop test on a fitted specimen: dynamic load deflection."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import EqualByValue, FloatArray
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import HasVerdict
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import Quantity, convert_to_si, format_quantity
from dashpot.base.value_ranges import require_positive
from dashpot.datamodel.fit import Fit
from dashpot.extensions.materials.drop import checks
from dashpot.extensions.materials.drop.approach import Approach
from dashpot.extensions.materials.drop.motion import ImpactMotion, simulate_impacts
from dashpot.fitting.prediction_bounds import off_by_error
from dashpot.solids.elastic import ElasticLaw

_DEFAULT_DEPTH = 1e-3
"""Depth of the linear law of a model without one, m; any value will do."""


@dataclass(frozen=True, eq=False, repr=False)
class DropPrediction(EqualByValue, HasVerdict, Serialisable):
    """Predicted drop test: a mass hits a specimen.

    Attributes
    ----------
    approach : Approach
    mass : float
        kg.
    seals : float
        Number of specimens in parallel.
    answers : tuple of ReportedValue
    motion : ImpactMotion
        By time steps.
    checks : tuple of Check
    sources : tuple of Source
        Sources of the fit.
    """

    schema = "dashpot/slammed@2"
    _keys = (
        "verdict",
        Key("approach", flatten=True),
        "mass",
        "seals",
        Key("values", "answers"),
        "time",
        "compression",
        "force",
        "checks",
    )
    _is_loadable = False

    approach: Approach
    mass: float
    seals: float
    answers: tuple[ReportedValue, ...]
    motion: ImpactMotion
    checks: tuple[Check, ...]
    sources: tuple[Source, ...] = ()

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """The predicted numbers."""
        return self.answers

    @property
    def verdict(self) -> Verdict:
        """Verdict, with peak force and absorbed energy."""
        force, loss_percent = (
            self.answers[0].cells,
            100 * self.motion.absorbed_energy / self.motion.energy,
        )
        return verdict(
            self.checks,
            headline=f"the peak force is {force.with_unit} at "
            f"{format_quantity(self.motion.peak.compression, 'mm', '.3g')}, and {loss_percent:.2g} "
            "% of the energy "
            "is absorbed",
        )

    @property
    def time(self) -> FloatArray:
        """Times of some hundred instants, s."""
        return self.motion.time[:: self._sample_stride]

    @property
    def compression(self) -> FloatArray:
        """Compression at these times, m."""
        return self.motion.compression[:: self._sample_stride]

    @property
    def force(self) -> FloatArray:
        """Force at these times, N."""
        return self.motion.force[:: self._sample_stride]

    @property
    def _sample_stride(self) -> int:
        return max(len(self.motion.time) // 300, 1)


def predict_drop(
    fit: Fit,
    *,
    drop: Quantity | Sequence[str],
    mass: Quantity | None = None,
    seals: float = 1.0,
) -> DropPrediction:
    """Predict the impact of a mass dropped on a specimen at rest.

    Parameters
    ----------
    fit : Fit
        Elastic law and relaxation of a specimen.
    drop : float or str
        Impact speed, m/s or ``"0.6m/s"``; or drop height, ``"18mm"``, with gravity acting on.
    mass : float or str
        kg, or ``"200g"``.
    seals : float
        Number of specimens in parallel: 2 of 50 mm for 100 mm under the mass.

    Raises
    ------
    DataError
        If the fit is of a material, a number is missing, or the mass does not rebound.
    """
    if mass is None:
        raise DataError("an impact needs the mass of what moves. Add it: --mass 200g")
    single_drop = drop if isinstance(drop, str | float | int) else _require_single_drop(drop)
    approach, kg = Approach.from_quantity(single_drop), convert_to_si(mass, "mass")
    require_positive(mass=kg, seals=seals)
    if fit.unit != "N/m":
        raise DataError(
            "the fit is of a material, and an impact is of a specimen. Fit a test of the "
            "specimen, in N and mm"
        )
    parallel_fit = fit if seals == 1 else fit.in_parallel(seals)
    elastic_law = parallel_fit.elastic_law
    law = elastic_law or ElasticLaw.linear(max(parallel_fit.model.k_inf, 1e-9), _DEFAULT_DEPTH)
    models = [parallel_fit.model, *(model.maxwell for model in off_by_error(parallel_fit))]
    motions = simulate_impacts(
        models, law, mass=kg, speed=approach.speed, acceleration=approach.gravity
    )
    motion = motions[0]
    checked = (
        checks.impact_within_measured_depth(
            motion.max_compression.compression, None if elastic_law is None else elastic_law.depth
        ),
        checks.impact_in_valid_band(motion.frequency, fit.band[1]),
        checks.air_escapes(approach.speed),
        checks.specimen_length_stated(is_given=parallel_fit.specimen.length is not None),
    )
    return DropPrediction(
        approach, kg, seals, _collect_answers(motions), motion,
        (*checked, *(check for check in fit.checks if check.grade == "stop")), fit.source,
    )  # fmt: skip


def _require_single_drop(stated_speeds: Sequence[str]) -> str:
    if len(stated_speeds) != 1:
        raise DataError(
            f"--drop was given {len(stated_speeds)} times, and one impact is predicted at a time. "
            "Give it once"
        )
    return stated_speeds[0]


_NAMED = (
    ("peak_force", "N", "", "peak force"),
    ("peak_time", "s", "ms", "time to the peak force"),
    ("compression", "m", "mm", "largest compression"),
    ("compression_time", "s", "ms", "time to the largest compression"),
    ("contact", "s", "ms", "contact"),
    ("residual_compression", "m", "mm", "compression when it is let go"),
    ("rebound", "1", "%", "rebound speed"),
    ("taken", "J", "mJ", "energy to the largest compression"),
    ("lost", "J", "mJ", "energy absorbed"),
    ("lost_part", "1", "%", "energy absorbed, of the kinetic energy"),
    ("force_ratio", "1", "", "peak force over the relaxed force there"),
    ("energy_ratio", "1", "", "energy over that of the relaxed force"),
)
"""Name, unit, unit that people read, and words of every number."""


def _collect_answers(motions: Sequence[ImpactMotion]) -> tuple[ReportedValue, ...]:
    """Return the numbers of the first motion, with errors by the other motions."""
    first, *other_numbers = map(_list_numbers, motions)
    differences = np.array([np.subtract(other, first) for other in other_numbers])
    # the energy of a speed has no error by the fit
    size = np.linalg.norm(differences, axis=0) if other_numbers else np.zeros(len(first))
    errors = [value or None for value in size.tolist()]
    return tuple(
        ReportedValue.from_error(name, value, error, unit=unit, read=read, words=words)
        for (name, unit, read, words), value, error in zip(_NAMED, first, errors, strict=True)
    )


def _list_numbers(item: ImpactMotion) -> list[float]:
    """Return the numbers in the order of ``_NAMED``."""
    peak, max_compression, release = item.peak, item.max_compression, item.release
    return [
        peak.force,
        peak.time,
        max_compression.compression,
        max_compression.time,
        release.time,
        release.compression,
        item.rebound,
        item.loading_work,
        item.absorbed_energy,
        item.absorbed_energy / item.energy,
        peak.force / max_compression.elastic_force,
        item.loading_work / item.elastic_energy,
    ]
