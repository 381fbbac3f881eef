r"""Fit of a piece's loss factor, and of the arm too fast for a ramp, to recorded slams.

All slams of a piece are followed by one motion each
(``dashpot.extensions.materials.slam.motion``), of one law and one memory, with the speed at the
touch, the touch and the zero of each slam free:

.. math:: F_i(t) = F(t - t_i;\, c, g, \tau, v_i) + b_i + \text{noise}

What is known before is a row as any other: the law of a load deflection test, the arms of a
relaxation test with their covariance, the speeds. So the tests are of one likelihood.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import DataError, FitError
from dashpot.base.number_format import format_count
from dashpot.base.provenance import Step, sources_of
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.checks import caution_checks
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import Evidence, Provenance
from dashpot.datamodel.parameter_estimate import ParameterEstimate, Residual, parameter_names
from dashpot.extensions.materials.slam import checks
from dashpot.extensions.materials.slam.approach import Approach
from dashpot.extensions.materials.slam.datamodel import SlamFit, SlamHit, SlamTest
from dashpot.extensions.materials.slam.elastic_law import POWERS, SlamLaw
from dashpot.extensions.materials.slam.least_squares_problem import Memory, Slams
from dashpot.extensions.materials.slam.motion import SlamMotion
from dashpot.extensions.materials.slam.preprocess import slams_of
from dashpot.extensions.materials.slam.residual_shapes import compute_residual_shapes
from dashpot.fitting.fit_construction import SolidEstimate, build_fit
from dashpot.numerics.inference.covariance_estimate import DerivedQuantity, Estimate, estimate
from dashpot.solids.maxwell import GeneralizedMaxwell

SPEED_SD = 0.05
"""How well a speed is known that was said, as a part of it: by a light barrier, or by a ruler."""


def fit_slams(
    records: Sequence[SlamTest],
    *,
    mass: Quantity | None = None,
    slam: Quantity | Sequence[Quantity] = (),
    memory: Fit | Sequence[Fit] = (),
    law: SlamLaw | None = None,
    speed_sd: float = SPEED_SD,
) -> SlamFit:
    """Find the loss factor of a piece, and the arm that a ramp is too slow for, from slams on it.

    Parameters
    ----------
    records : sequence of SlamTest
        Of one piece.
    mass : float or str
        kg, or ``"200g"``.
    slam : sequence of float or str
        Of the slams in their order the speed at the touch, ``"0.6m/s"``, or the height of the fall,
        ``"18mm"``. Where fewer are given, the speeds of the rest are free.
    memory : Fit, optional
        Of a relaxation test, or of a load deflection test with such a memory: its arms are known to
        their covariance, and its law, where it bends, to its errors.
    law : SlamLaw, optional
        What is known of the law, by default what `memory` holds of it.
    speed_sd : float
        Standard deviation of a speed that is given, as a part of it.

    Raises
    ------
    DataError, FitError
        If the mass is missing, no slam stands out, or no motion follows them.
    """
    if mass is None:
        raise DataError("impacts need the mass of what moves. Add it: --mass 200g")
    fits = (memory,) if isinstance(memory, Fit) else tuple(memory)
    if len(fits) > 1:
        raise DataError(
            f"--relaxation was given {len(fits)} times, and impacts take one. Give it once"
        )
    kg, fit = convert_to_si(mass, "mass"), fits[0] if fits else None
    hits = tuple(
        recorded_slam
        for place, test in enumerate(records, 1)
        for recorded_slam in slams_of(
            test, kg, test.source.file if test.source else f"record {place}"
        )
    )
    speeds, pulls = _approaches(slam, len(hits))
    longer = _longer(records, fit)
    if law is None:
        law = SlamLaw.free() if fit is None else SlamLaw.from_fit(fit, longer)
    slams = Slams(hits, kg, pulls, speeds, speed_sd, law, Memory.from_fit(fit))
    best = slams.find_optimum()
    if best is None:
        raise FitError(
            "no motion of the mass follows the slams. Check the mass and the speeds, or look at "
            "the record with dashpot inspect"
        )
    uncertainty = estimate(best, parts=[len(hit.time) for hit in hits], prior_variance=1.0)
    return _SlamsSolved(tuple(records), slams, uncertainty, fit).slam_fit


def _approaches(slam: Quantity | Sequence[Quantity], count: int) -> tuple[FloatArray, FloatArray]:
    """Speed, NaN where it is free, and pull of so many slams; those not given are pulled alike."""
    stated = [slam] if isinstance(slam, str | float | int) else list(slam)
    if len(stated) > count:
        raise DataError(
            f"--drop was given {len(stated)} times, and the record has "
            f"{format_count(count, 'impact')}. Give the speed of each impact, in their order"
        )
    approaches = [Approach.from_quantity(item) for item in stated]
    pulls, free = [approach.pull for approach in approaches], count - len(approaches)
    pulls += [pulls[-1] if pulls else 0.0] * free
    return np.array([*(approach.speed for approach in approaches), *[np.nan] * free]), np.array(
        pulls
    )


def _longer(records: Sequence[SlamTest], fit: Fit | None) -> float:
    """Length of the piece slammed on over that of the one whose law is known."""
    value = next((record.specimen.length for record in records if record.specimen.length), None)
    other = None if fit is None else fit.specimen.length
    return value / other if value and other else 1.0


@dataclass(frozen=True, eq=False)
class _SlamsSolved:
    """What the slams say, at their optimum."""

    records: tuple[SlamTest, ...]
    slams: Slams
    known: Estimate
    fit: Fit | None

    @property
    def slam_fit(self) -> SlamFit:
        """All of it, judged."""
        uncertainty, slams, frequency = self.known, self.slams, self.frequency
        arm = uncertainty.derive_quantity(
            lambda values: values[slams.shared_parameter_count - 2 : slams.shared_parameter_count]
        )
        facts = [
            self._fact("loss_factor", self.loss, 0, f"loss factor at {frequency:.3g} Hz"),
            self._fact("arm", arm, 0, "fast arm, over the relaxed force"),
            self._fact("arm_time", arm, 1, "its relaxation time"),
        ]
        if len(slams.memory.g):
            before = uncertainty.derive_quantity(lambda values: self._loss(values, arm=False))
            facts.insert(1, self._fact("loss_before", before, 0, "the same without the fast arm"))
        checks = self._run_checks()
        return SlamFit(
            frequency, tuple(facts), self.hits, slams.mass, self._piece(checks), checks,
            sources_of(self.records),
        )  # fmt: skip

    @property
    def theta(self) -> FloatArray:
        return self.known.optimum.theta

    def _fact(self, name: str, of: DerivedQuantity, place: int, words: str) -> ReportedValue:
        """One of several numbers with its interval; of a time, by its logarithm."""
        value, error = float(of.values[place]), float(of.standard_error[place])
        times = self.known.quantile()
        if name != "arm_time":
            return ReportedValue.from_error(name, value, error, times, words=words)
        time = float(np.exp(value))
        return ReportedValue.from_error(
            name, time, error, times, of_log=True, unit="s", read="ms", words=words
        )

    @cached_property
    def motions(self) -> tuple[SlamMotion, ...]:
        """Of every slam, to its release."""
        slams = self.slams
        rows = np.repeat(self.theta[None, :], len(slams.hits), axis=0)
        x, v, force, relaxed = slams.integrate_motion(rows, slams.speeds(self.theta), slams.pulls)
        ends = np.minimum((force > 0).cumsum(axis=0).argmax(axis=0) + 2, len(force))
        time = slams.step * np.arange(float(len(force)))
        return tuple(
            SlamMotion(
                time[:end], x[:end, i], v[:end, i], force[:end, i], relaxed[:end, i], slams.mass,
                float(slams.pulls[i]),
            )
            for i, end in enumerate(ends.tolist())
        )  # fmt: skip

    @cached_property
    def frequency(self) -> float:
        """Of the cycle that a contact is half of, Hz."""
        return float(np.median([motion.frequency for motion in self.motions]))

    @property
    def depth(self) -> float:
        """To which the piece was pressed, m."""
        return max(motion.deepest.compression for motion in self.motions)

    def _loss(self, values: FloatArray, *, arm: bool = True) -> FloatArray:
        """Return loss factor of the memory, whatever the compression."""
        g, tau = self.slams.arms(values[: self.slams.shared_parameter_count])
        g, tau = (g, tau) if arm else (g[:-1], tau[:-1])
        turn = 2j * np.pi * self.frequency * tau
        K = 1 + (g * turn / (1 + turn)).sum()
        return np.array([K.imag / K.real])

    @cached_property
    def loss(self) -> DerivedQuantity:
        """That, with its error."""
        return self.known.derive_quantity(self._loss)

    @cached_property
    def hits(self) -> tuple[SlamHit, ...]:
        """Every slam as it was fitted."""
        errors, zeros = self.known.standard_error, self.known.optimum.beta
        reach, slam_hits = self.known.quantile(), []
        modelled = self.slams.forces(self.theta)
        for i, (slam, motion) in enumerate(zip(self.slams.hits, self.motions, strict=True)):
            place = self.slams.shared_parameter_count + 2 * i
            speed, error = float(self.theta[place]), float(errors[place])
            fact = ReportedValue.from_error("speed", speed, error, reach, unit="m/s", read="m/s")
            time = slam.time - self.theta[place + 1]
            hit = SlamHit(
                slam.name, fact, motion.peak.force, motion.deepest.compression,
                motion.release.time, motion.rebound, motion.absorbed_energy / motion.energy, time,
                slam.force - zeros[i], modelled[i],
            )  # fmt: skip
            slam_hits.append(hit)
        return tuple(slam_hits)

    def _run_checks(self) -> tuple[Check, ...]:
        """Return every check."""
        slams, hits, elastic_law = self.slams, self.hits, self.slams.law.known
        value, sd = float(self.loss.values[0]), float(self.loss.standard_error[0])
        sizes = np.cumsum([len(hit.time) for hit in slams.hits])[:-1]
        residuals = np.split(self.known.optimum.residual, sizes)
        misfit = max(
            float(np.sqrt(np.mean(residual[hit.modelled > 0] ** 2)))
            for residual, hit in zip(residuals, hits, strict=True)
        )
        speeds = np.array([hit.speed.value for hit in hits])
        finite = np.isfinite(slams.said)
        off = np.abs(speeds / slams.said - 1)[finite] / slams.said_sd
        differences = [hit.rest / hit.contact for hit in slams.hits if hit.rest is not None]
        ratios = [hit.ratio for hit in slams.hits if hit.ratio is not None]
        samples = min(hit.contact / float(hit.time[1] - hit.time[0]) for hit in hits)
        return (
            checks.loss_determined(sd / max(value, 1e-300), self.frequency),
            checks.slams_residual_small(misfit),
            checks.slam_residual_structureless(compute_residual_shapes(slams, self.known.optimum)),
            checks.slams_sampled(samples),
            checks.slow_arms_determined(provided=self.fit is not None),
            checks.slam_speeds_spread(None if elastic_law else float(speeds.max() / speeds.min())),
            checks.slam_speeds_agree(float(off.max()) if len(off) else None),
            checks.slams_separated(min(differences, default=None)),
            checks.slam_mass_agrees(max(ratios, key=lambda number: abs(number - 1), default=None)),
            *self._check_memory_agreement(value, sd),
            *(
                []
                if elastic_law is None
                else [checks.slam_within_measured_depth(self.depth, elastic_law.depth)]
            ),
            checks.air_escapes(float(speeds.max())),
            checks.piece_length_given(provided=self.records[0].specimen.length is not None),
            *caution_checks(sources_of(self.records)),
        )

    def _check_memory_agreement(self, value: float, sd: float) -> list[Check]:
        """Return what the slams and the test of the memory say of one another."""
        memory, fit = self.slams.memory, self.fit
        if fit is None or not len(memory.g):
            return []
        change, about = None, np.concatenate((memory.g, np.log(memory.tau)))
        if memory.free:
            here = self.theta[len(POWERS) : len(POWERS) + self.slams.memory_parameter_count]
            change = float(np.abs(memory.precision @ (here - about)).max())
        turn = 2j * np.pi * self.frequency * memory.tau
        K = 1 + (memory.g * turn / (1 + turn)).sum()
        before = float(K.imag / K.real)
        gap = (value - before) / sd if np.isfinite(sd) and sd > 0 else None
        # beyond its band a relaxation test says what there is at least
        seen = self.frequency <= fit.band[1]
        if gap is not None and not seen:
            gap = min(gap, 0.0)
        return [
            checks.arms_agree_with_relaxation_test(change),
            checks.spectrum_has_gaps(len(memory.g)),
            checks.loss_factors_agree(gap, value, before, within=seen),
        ]

    def _piece(self, checks: tuple[Check, ...]) -> Fit:
        """Return the piece as a solid: the law, the memory that was known, and the arm."""
        slams, depth, cubic = self.slams, self.depth, slice(0, len(POWERS))
        g, tau = slams.arms(self.theta[: slams.shared_parameter_count])
        order = [i for i in np.argsort(tau).tolist() if g[i] > 0]
        arms = len(order)

        def seal(values: FloatArray) -> FloatArray:
            own_g, own_tau = slams.arms(values[: slams.shared_parameter_count])
            k_inf = slams.law.compute_knot_tangents(values[cubic], depth)[2]
            return np.concatenate(([k_inf], k_inf * own_g[order], np.log(own_tau[order])))

        quantity = self.known.derive_quantity(seal)
        ratio = self.known.derive_quantity(
            lambda values: slams.law.compute_knot_tangents(values[cubic], depth)[1]
        )
        ratio_se = np.nan_to_num(ratio.standard_error, posinf=0.0)
        k_inf, *rest = quantity.values.tolist()
        taus = np.exp(rest[arms:]).tolist()
        law = slams.law.piecewise(self.theta[cubic], depth)
        n, sse = len(self.known.optimum.residual), self.known.optimum.sse
        residual = Residual(n, sse, float(np.sqrt(sse / n)), self.known.kappa, unit="sd")
        estimated = ParameterEstimate(
            parameter_names(arms), quantity.covariance, self.known.dof, residual
        )
        contact = [hit.contact for hit in self.hits]
        low = 1 / (np.pi * max(contact)) if self.fit is None else self.fit.band[0]
        step = Step(
            "fit",
            (("slams", str(len(contact))), ("mass_kg", repr(slams.mass))),
            f"fitted {format_count(len(contact), 'impact')} of {slams.mass:.4g} kg",
        )
        model = GeneralizedMaxwell(k_inf, tuple(rest[:arms]), tuple(taus))
        return build_fit(
            SolidEstimate(model, estimated),
            Evidence((low, 2 / (np.pi * min(contact))), checks=checks),
            Provenance("slam", sources_of(self.records), (step,), self.records[0].specimen),
            elastic_law=replace(law, ratio_se=tuple(ratio_se.tolist())),
        )
