"""From an optimum to what a reader needs: a Fit with its errors, its nuisances, what moved."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.provenance import Step, sources_of, steps_of
from dashpot.fitting.assembly import FoundSolid, assembled
from dashpot.fitting.checks.solid import optimum_found
from dashpot.fitting.identification import checks
from dashpot.fitting.identification.explanations import Disagreement, agreement
from dashpot.fitting.identification.families import Rival, edged, family_checks
from dashpot.fitting.identification.likelihood import DELAY_UNIT, UNCHANGED, Candidate
from dashpot.fitting.identification.parametrisation import Arms
from dashpot.records.estimate import Nuisance, ParameterEstimate, Residual
from dashpot.records.fit import Evidence, Fit, Moved, OrderScore, Provenance
from dashpot.records.frf import FRF
from dashpot.records.relaxation import RampHold
from dashpot.records.specimen import Specimen
from dashpot.records.temperature import TemperatureShifts
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import Solid

NOUNS = {
    "stiffness": "another stiffness of the seals",
    "k_inf": "another stiffness of the seals at rest",
    "mass": "another mass",
    "gain": "another gain of the channels",
}
# arms nearer than this in ln tau are the same arm
SAME = 1.0


def identified(
    best: Candidate,
    orders: Sequence[Candidate],
    *,
    frf: FRF,
    tests: Sequence[RampHold],
    before: Fit | None,
    own: Fit | None,
    asked: int | str,
    most: int,
    apart: Disagreement | None,
    rival: Rival | None,
    dashpot: tuple[Check, ...],
) -> Fit:
    """The fit of one seal, with everything needed to judge it.

    `before` is what was known of the seal before the hammer, `own` that of the same family.
    """
    point, covariance = best.point, best.covariance
    names, values, physical = _physical(best)
    if apart is not None:
        # which of the two solids is right is a doubt of its own
        physical = physical + np.outer(*[values - _physical(best, apart.model)[1]] * 2)
    residual, samples = _residual(best)
    band = _band(best, before)
    other = None if rival is None else rival.alternative(band)
    answers = (
        *_checks(best, covariance, before, apart), *family_checks(best, rival, other), *dashpot
    )  # fmt: skip
    estimate = ParameterEstimate(
        names,
        physical,
        dof=max(samples - len(best.theta), 1.0),
        residual=residual,
        nuisance=_nuisance(best, covariance),
    )
    law = None if before is None else before.elastic_law
    return assembled(
        FoundSolid(
            point.model,
            estimate,
            fewer=asked != "auto" and most > point.model.maxwell.arms,
            at_bound=edged(best),
        ),
        Evidence(
            band,
            orders=tuple(_score(candidate) for candidate in orders),
            checks=answers,
            moved=() if own is None else _moved(own, point.model, names, physical),
            explanations=() if apart is None else apart.explanations,
            alternative=other,
        ),
        Provenance(
            "joint" if tests or before is not None else "frf",
            (*frf.source, *sources_of(tests)),
            (*frf.steps, *steps_of(tests), _step(best)),
            _specimen(tests, before),
        ),
        elastic_law=None if law is None else replace(law, stiffness=point.model.k_inf),
        temperatures=None if before is None else _shifts(before),
    )


def _shifts(before: Fit) -> TemperatureShifts | None:
    """How the solid of the relaxation tests moves with temperature; the hammer is of one."""
    moved = before.temperatures
    return None if moved is None else replace(moved, cross=moved.cross[-1:])


def _specimen(tests: Sequence[RampHold], before: Fit | None) -> Specimen:
    """The piece that the relaxation tests were made on."""
    if before is not None and before.temperatures is not None:
        return before.specimen
    if tests:
        return max(tests, key=lambda test: test.depth).specimen
    return Specimen() if before is None else before.specimen


def _physical(
    best: Candidate, model: Solid | None = None
) -> tuple[tuple[str, ...], FloatArray, FloatArray]:
    """Names, values and covariance of the solid's parameters; values of another model, if given."""
    problem, sought = best.problem, best.problem.sought

    def physical(theta: FloatArray) -> FloatArray:
        b = [np.exp(theta[problem.at["ln_b"]])] if problem.dashpot else []
        return np.append(sought.physical(theta[: sought.size])[1], b)

    names = sought.physical(best.theta[: sought.size])[0] + ("b",) * problem.dashpot
    told = best.estimate.derived(physical)
    if model is None:
        return names, told.values, told.covariance
    b = [model.maxwell.b] if problem.dashpot else []
    return names, np.append(sought.physical(sought.pack(model))[1], b), told.covariance


def _residual(best: Candidate) -> tuple[Residual, float]:
    lines, relaxations = 2 * len(best.problem.frf_data.lines.s), best.problem.relaxations
    effective = lines + sum(relaxation.samples for relaxation in relaxations)
    n = lines + sum(relaxation.block.samples for relaxation in relaxations)
    rms = float(np.sqrt(best.chi2 / effective))
    kappa = float(n / effective)
    return Residual(n=n, sse=best.chi2, rms=rms, kappa=kappa, unit="sd"), float(effective)


def _score(candidate: Candidate) -> OrderScore:
    return OrderScore(
        candidate.point.model.maxwell.arms,
        candidate.chi2,
        candidate.bic,
        candidate.significant,
        candidate.point.model.maxwell,
    )


def _band(best: Candidate, before: Fit | None) -> tuple[float, float]:
    """Where the tests inform the solid: an octave about the peak, and what relaxation sees."""
    frf_data = best.problem.frf_data
    low = max(frf_data.peak_hz / 2, float(frf_data.lines.frequency[0]))
    high = min(frf_data.peak_hz * 2, float(frf_data.lines.frequency[-1]))
    return (low, high) if before is None else (min(low, before.band[0]), max(high, before.band[1]))


def _nuisance(best: Candidate, covariance: FloatArray) -> tuple[Nuisance, ...]:
    problem, point = best.problem, best.point

    def se(name: str, scale: float) -> float:
        if name not in problem.at:
            return 0.0
        i = problem.at[name]
        return float(np.sqrt(covariance[i, i])) * scale

    return (
        Nuisance("mass", point.mass, se("ln_mass", point.mass), "kg"),
        Nuisance("gain", point.gain, se("ln_gain", point.gain), "1"),
        Nuisance("delay", point.delay, se("delay", DELAY_UNIT), "s"),
        *(
            [Nuisance("stiffness_factor", point.factor, se("ln_factor", point.factor), "1")]
            if problem.priors.factor != UNCHANGED
            else []
        ),
    )


def _step(best: Candidate) -> Step:
    frf_data, relaxations = best.problem.frf_data, best.problem.relaxations
    return Step(
        "identify",
        (
            ("lines", str(len(frf_data.lines.s))),
            ("band_hz", f"{frf_data.lines.frequency[0]:.6g} {frf_data.lines.frequency[-1]:.6g}"),
            ("seals", f"{frf_data.seals:g}"),
            ("relaxation_tests", str(len(relaxations))),
            ("scatter_scaled_by", f"{best.problem.scale:.6g}"),
        ),
        f"fitted {len(frf_data.lines.s)} lines of the FRF"
        + (f" together with {len(relaxations)} relaxation test(s)" if relaxations else ""),
    )


def _moved(
    before: Fit, solid: Solid, names: tuple[str, ...], covariance: FloatArray
) -> tuple[Moved, ...]:
    """Each parameter before and after; arms are matched by their relaxation times."""
    se = dict(zip(names, np.sqrt(np.diag(covariance)).tolist(), strict=True))
    old = dict(zip(before.parameters, np.sqrt(np.diag(before.covariance)), strict=True))
    if isinstance(solid, FractionalZener):
        return tuple(_moved_element(before, solid, se, old))
    model = solid.maxwell
    rows = [
        Moved("k_inf", before.model.k_inf, _known(old, "k_inf"), model.k_inf, se["k_inf"], "N/m")
    ]
    partner = _partners(before.model.tau, model.tau)
    for j, (k, tau) in enumerate(zip(model.k, model.tau, strict=True), start=1):
        i = partner.get(j - 1)
        k0 = None if i is None else before.model.k[i]
        tau0 = None if i is None else before.model.tau[i]
        k_se = None if i is None else _known(old, f"k_{i + 1}")
        log_se = None if i is None else _known(old, f"ln_tau_{i + 1}")
        tau_se = None if tau0 is None or log_se is None else tau0 * log_se
        rows.append(Moved(f"k_{j}", k0, k_se, k, se[f"k_{j}"], "N/m"))
        rows.append(Moved(f"tau_{j}", tau0, tau_se, tau, tau * se[f"ln_tau_{j}"], "s"))
    if model.b > 0:
        rows.append(Moved("b", before.model.b, None, model.b, se["b"], "N s/m"))
    return tuple(rows)


def _moved_element(
    before: Fit, solid: FractionalZener, se: dict[str, float], old: dict[str, float]
) -> Iterator[Moved]:
    """So too of a fractional solid, whose parameters have one name each."""
    for name, row, unit in (
        ("k_inf", "k_inf", "N/m"), ("k_0", "k_0", "N/m"), ("tau", "ln_tau", "s"),
        ("alpha", "alpha", "1"),
    ):  # fmt: skip
        was, now = getattr(before.solid, name), getattr(solid, name)
        scales = (was, now) if row == "ln_tau" else (1.0, 1.0)
        known = _known(old, row)
        yield Moved(
            name, was, None if known is None else scales[0] * known, now, scales[1] * se[row], unit
        )
    if solid.b > 0:
        yield Moved("b", before.model.b, None, solid.b, se["b"], "N s/m")


def _known(errors: dict[str, float], name: str) -> float | None:
    return None if name not in errors else float(errors[name])


def _partners(old: tuple[float, ...], new: tuple[float, ...]) -> dict[int, int]:
    """New arm -> old arm, nearest pairs first, none farther apart than a factor e."""
    pairs = sorted((abs(np.log(a / b)), i, j) for i, a in enumerate(old) for j, b in enumerate(new))
    found: dict[int, int] = {}
    for distance, i, j in pairs:
        if distance < SAME and j not in found and i not in found.values():
            found[j] = i
    return found


def _checks(
    best: Candidate, covariance: FloatArray, before: Fit | None, apart: Disagreement | None
) -> tuple[Check, ...]:
    lead = None if apart is None else apart.explanations[0]
    why = f"{NOUNS[lead.name]} explains both tests" if lead and lead.explains else ""
    answers = [optimum_found(stationary=best.optimum.stationary)]
    if before is not None:
        # before what follows from it
        answers.append(checks.tests_agree(lead))
    answers += agreement(best, why)
    if isinstance(best.problem.sought, Arms):
        arms = best.problem.sought.count
        worst = float(max(np.sqrt(np.diag(covariance))[1 : 1 + 2 * arms], default=0.0))
        new = 0 if before is None else arms - before.model.arms
        known = checks.arms_identified(arms, worst, significant=best.significant, new=new)
        answers.append(known)
    return tuple(answers)
