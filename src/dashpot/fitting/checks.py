"""Each way in which a fit can deceive, as a criterion with a sentence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Finding, criterion
from dashpot.engine.blocks.correlation import fast_length
from dashpot.engine.inference.order import MAX_SE_LN_TAU, MIN_K_OVER_SE, Choice
from dashpot.fitting.repeats import SAME_DEPTH, EndStiffness
from dashpot.preparation.filters import Filter
from dashpot.records.bounds import EndOfHold
from dashpot.records.relaxation import RampHold
from dashpot.solids.maxwell import GeneralizedMaxwell

if TYPE_CHECKING:
    from dashpot.records.dynamic import DynamicTest

# per factor e of time
MAX_FALLING = 0.03
MIN_TAU_RATIO = 1.5
MAX_DRIFT_CORRELATION = 0.9
MAX_METHOD_DIFFERENCE = 0.10
MAX_INCONSISTENT = 0.05
MAX_APART = 3.0
# tests within so many kelvin are of one temperature
SAME_TEMPERATURE = 2.0
# repeats on one seal differ by as much
SAME_STIFFNESS = 0.02
# curves missed by more than this are not followed
FOLLOWED = 0.05
# a force followed to so many times its noise is; beyond the second the solid is another
FOLLOWED_TO_NOISE = 1.75
NOT_FOLLOWED = 10.0
# a k known to this part of it is known, however fast its arm
KNOWN_K = 0.01
# a plate that has moved by less of the depth is at rest
AT_REST = 1e-3
# a misfit below this part of the peak force matters to no use of the solid
FINE_ENOUGH = 1e-3
# scatter so many times as large is another solid
CONTRADICTED = 3.0
# shapes that differ by less are the same for every use of them
ALIKE = 1e-3
# an interval of k_inf wider than this part of the stiffness left says little of it
UNSURE = 0.5
# what is left of zero in a sum of stiffnesses, relative to it
_ROUNDING = 1e-12


# -- the optimum ----------------------------------------------------------------------------------


@criterion(source="the gradient vanishes, or a bound holds the point", grade="stop")
def optimum_found(*, stationary: bool) -> Finding:
    """The optimiser ended at an optimum."""
    return Finding(
        "the optimiser ended at an optimum",
        instead="the optimiser reached its limit of iterations before the gradient vanished: fit "
        "fewer arms, or ask for thorough starts",
        faulted=not stationary,
    )


@criterion(source="by definition")
def uncertainty_estimated(*, made: bool) -> Finding:
    """Intervals and checks were asked for."""
    return Finding(
        "intervals and checks were made",
        instead="this is a point estimate: neither intervals nor checks were made; fit with them "
        "before use (Python: intervals=True)",
        faulted=not made,
    )


# -- several tests ---------------------------------------------------------------------------------


@criterion(
    "difference / its error", "<=", MAX_APART, "3 standard errors, and 2 % of it", grade="stop"
)
def same_specimen(stiffnesses: Sequence[EndStiffness]) -> Finding:
    """Tests of one depth and temperature find one stiffness."""
    pairs = [
        (abs(a.value - b.value) / max(float(np.hypot(a.sd, b.sd)), 1e-300), i, j)
        for (i, a), (j, b) in combinations(enumerate(stiffnesses), 2)
        if _alike(a, b)
    ]
    if not pairs:
        return Finding("no two tests are of one depth and temperature, so lots are not compared")
    apart, i, j = max(pairs)
    first, second = stiffnesses[i], stiffnesses[j]
    each = ", ".join(f"{1e-3 * one.value:.4g} +- {1e-3 * one.sd:.1g}" for one in stiffnesses)
    return Finding(
        f"at the end of the hold the tests find {each} N/mm",
        apart,
        f": tests {i + 1} and {j + 1} are {100 * (second.value / first.value - 1):+.2g} % apart at "
        f"one depth, {apart:.3g} standard errors; they are not one seal: fit each alone",
        excused=abs(second.value / first.value - 1) <= SAME_STIFFNESS,
    )


def _alike(one: EndStiffness, other: EndStiffness) -> bool:
    """True of two tests of one depth at one temperature, as far as it is known."""
    if abs(one.depth / other.depth - 1) > SAME_DEPTH:
        return False
    if one.temperature is None or other.temperature is None:
        return True
    return abs(one.temperature - other.temperature) <= SAME_TEMPERATURE


# -- the solid ------------------------------------------------------------------------------------


@criterion(
    "fall per factor e of time",
    "<=",
    MAX_FALLING,
    "our choice: k_inf is extrapolated by as much",
    grade="note",
)
def hold_long_enough(end: EndOfHold | None) -> Finding:
    """The force had the time to level off: no spectrum that the record allows still falls much."""
    if end is None:
        return Finding("each depth has its own stiffnesses, so the end of the hold is not judged")
    falling = end.falling / max(end.k_end[1], 1e-300)
    return Finding(
        f"when the hold ends, after {end.time:.4g} s, the stiffness falls by at most "
        f"{100 * falling:.2g} % per factor e of time",
        falling,
        ": k_inf rests on extrapolation, and nothing bounds it from below; the stiffness at the "
        "end of the hold is what the test knows. A longer hold would tell more, and the drift of "
        "the load cell (--drift), where it is not known",
    )


@criterion("ratio of neighbouring tau", ">=", MIN_TAU_RATIO)
def arms_distinct(model: GeneralizedMaxwell) -> Finding:
    """Neighbouring relaxation times are far enough apart to be two."""
    ratios = [slow / fast for fast, slow in zip(model.tau, model.tau[1:], strict=False)]
    if not ratios:
        return Finding("there is at most one arm")
    j = int(np.argmin(ratios))
    return Finding(
        f"the closest relaxation times are a factor {ratios[j]:.3g} apart",
        ratios[j],
        f" (arms {j + 1} and {j + 2}); below {MIN_TAU_RATIO} the data cannot tell two arms "
        f"from one: fit {model.arms - 1} arm{'s' * (model.arms > 2)}",
    )


@criterion(
    "k / SE(k)",
    ">",
    MIN_K_OVER_SE,
    "3 SE; and SE(ln tau) < 0.5, a factor 1.6",
    otherwise="note where fewer arms are rejected",
)
def arms_supported(
    model: GeneralizedMaxwell, error: FloatArray, *, unit: str = "N/m", needed: bool = False
) -> Finding:
    """Every arm stands out of the noise.

    `error` as `Fit.parameters`: k_inf, k, ln tau; `needed` if the rules chose their number, for
    then BIC rejects fewer.
    """
    n = model.arms
    each = list(zip(model.k, model.tau, error[1 : 1 + n], error[1 + n : 1 + 2 * n], strict=True))
    weak = " and ".join(
        f"arm {j} (k = {amount(k, unit)}, tau = {tau:.3g} s)"
        for j, (k, tau, sk, st) in enumerate(each, start=1)
        if not (k > MIN_K_OVER_SE * sk and st < MAX_SE_LN_TAU)
    )
    value = float(min((k / sk for k, _, sk, _ in each if sk > 0), default=np.inf))
    doubt = (
        f"k is below {MIN_K_OVER_SE:.0f} standard errors or tau is uncertain by more than a "
        "factor 1.6"
    )
    return Finding(
        "every arm stands out of the noise",
        value if np.isfinite(value) else None,
        excused=n > 0 and not weak,
        instead=f"the record rejects fewer arms, yet hardly tells {weak}: {doubt}; "
        "hold longer, or quieten the slow noise"
        if needed
        else f"{weak} cannot be told from noise: {doubt}; fit fewer arms",
        faulted=bool(weak),
        grade="note" if needed else None,
    )


@criterion("tau outside, s", "<=", source="the ends of what was sampled", grade="note")
def tau_inside_window(
    model: GeneralizedMaxwell,
    window: tuple[float, float],
    of: str,
    *,
    ends: tuple[str, str] = ("", ""),
    within: bool = False,
    advice: str = ": only the tail of this arm was measured, so its k and tau are an "
    "extrapolation; fit fewer arms or measure wider",
) -> Finding:
    """Every relaxation time is one that the data could show.

    `window` is in s; `within` it, an arm at an end of it is outside.
    """
    low, high = window
    holds = np.less if within else np.less_equal
    outside = [tau for tau in model.tau if not (holds(low, tau) and holds(tau, high))]
    span = f"{low:.3g} s{ends[0]} to {high:.3g} s{ends[1]}"
    listed = ", ".join(f"{tau:.3g} s" for tau in outside)
    return Finding(
        f"every relaxation time lies in what {of} can show, {span}",
        min(outside, default=None),
        excused=bool(model.arms) and not outside,
        instead=f"tau = {listed} lies outside what {of} can show, {span}{advice}",
        limit=high,
        faulted=bool(outside),
    )


def record_window(tests: Sequence[RampHold]) -> tuple[float, float]:
    """Return the relaxation times that records could show, s: two samples to the hold."""
    return (
        min(2.0 * float(np.diff(test.time).min()) for test in tests),
        max(test.hold_time for test in tests),
    )


@criterion("k_inf, N/m", ">", source="3 standard errors")
def k_inf_positive(model: GeneralizedMaxwell, se: float) -> Finding:
    """There is an equilibrium stiffness left."""
    return Finding(
        f"k_inf = {1e-3 * model.k_inf:.4g} N/mm with a standard error of {1e-3 * se:.2g}",
        model.k_inf,
        "; it is not told from zero: the hold ended before the force levelled off, or the "
        "seal flows; hold longer",
        limit=3.0 * se,
    )


@criterion(
    "width of its 95 % interval / stiffness at the end of the hold",
    "<=",
    UNSURE,
    otherwise="stop beyond 1",
)
def k_inf_known(model: GeneralizedMaxwell, se: float, tests: Sequence[RampHold]) -> Finding:
    """The equilibrium stiffness is known to a part of what is left at the end of the hold."""
    end = float(model.relaxation(max(test.hold_time for test in tests)))
    low, high = max(model.k_inf - 2 * se, 0.0), model.k_inf + 2 * se
    if not (np.isfinite(high) and end > 0):
        says = "the record does not bound k_inf"
        return Finding(says + ": hold longer", np.inf, faulted=True, grade="stop")
    return Finding(
        f"k_inf lies between {1e-3 * low:.3g} and {1e-3 * high:.3g} N/mm, {1e-3 * end:.3g} N/mm "
        "are left at the end of the hold",
        (high - low) / end,
        "; the record does not tell it: hold longer, and record a baseline before contact",
        grade="stop" if high - low > end else None,
    )


@criterion("fall in the hold / peak", "<=", 0.02, "our choice; or 7 standard errors", grade="stop")
def arms_where_force_relaxes(model: GeneralizedMaxwell, test: RampHold) -> Finding:
    """A force that relaxes is given an arm to relax by."""
    force = test.force[test.hold]
    if len(force) < 20:
        return Finding("the hold is too short to judge what the force relaxes")
    tenth = max(len(force) // 10, 1)
    peak = max(float(np.abs(test.force).max()), 1e-300)
    fall = float(force[:tenth].mean() - force[-tenth:].mean())
    return Finding(
        f"the force falls by {100 * fall / peak:.2g} % of its peak in the hold",
        fall / peak,
        ", and the solid has no arm to follow it: do not use it",
        excused=bool(model.arms) or fall <= 7 * test.force_noise * np.sqrt(2 / tenth),
    )


@criterion("plateau, N/m or Pa", ">", source="3 standard errors")
def plateau_seen(model: GeneralizedMaxwell, se: float, *, unit: str, further: str) -> Finding:
    """There is a stiffness that does not relax."""
    return Finding(
        f"the plateau is {amount(model.k_inf, unit)} with a standard error of {amount(se, unit)}",
        model.k_inf,
        f"; it is not told from zero: the material flows, or {further}",
        limit=3.0 * se,
        # exact data leave a plateau of rounding size, and a standard error to match
        faulted=model.k_inf <= _ROUNDING * (model.k_inf + sum(model.k)),
    )


@criterion(
    "residuals that say the same", "<=", 20.0, "our choice: white residuals give 1", grade="note"
)
def residuals_random(kappa: float, rms: float, noise: float | None = None) -> Finding:
    """The residuals are noise: no curve is left in them.

    `rms` is that of weighted residuals, or in N beside a `noise`.
    """
    size = f"weighted residuals are {rms:.3g} rms"
    cause = "the model misses part of the curve (a broad spectrum has no few arms: see the dense "
    cause += "spectrum)"
    if noise is not None:
        size = f"residuals are {1e3 * rms:.3g} mN rms"
        cause = "the record was filtered or drifts"
        if rms > 1.3 * noise:
            cause = "the model misses part of the curve (try another arm, or look at the residuals)"
    return Finding(
        f"the {size} and {kappa:.3g} neighbours say the same",
        kappa,
        f": {cause}; intervals are widened for it",
    )


@criterion(
    "misfit / noise",
    "<=",
    FOLLOWED_TO_NOISE,
    "our choice; noise of at least 0.1 % of the peak",
    otherwise=f"stop beyond {NOT_FOLLOWED:g}",
)
def force_followed(test: RampHold, residual: FloatArray) -> Finding:
    """The solid follows the force to its noise.

    `residual` is of the last samples up to the end of the hold, N.
    """
    misfit, where = worst_misfit(test, residual)
    noise = max(noise_of_force(test), FINE_ENOUGH * float(np.abs(test.force).max()))
    ratio = misfit / noise if noise > 0 else 1.0
    return Finding(
        f"the solid misses the force by {1e3 * misfit:.3g} mN rms {where}, where it follows worst; "
        f"{1e3 * noise:.3g} mN are noise or too little to matter",
        ratio,
        ": the seal is not such a solid, or another motion pressed it (stiffening, friction, slip, "
        "a late force); do not read arms off it",
        grade="stop" if ratio > NOT_FOLLOWED else None,
    )


@criterion("change of k", source="no limit", grade="note")
def step_bias(model: GeneralizedMaxwell, tests: Sequence[RampHold]) -> Finding:
    r"""The ramp is accounted for, and what a step would have made of it is told.

    :math:`(\tau/c)(1 - e^{-c/\tau}) - 1`, the worst arm.
    """
    if not model.arms:
        return Finding("a spring does not feel the ramp")
    c = max(test.ramp_time for test in tests)
    bias = [tau / c * -np.expm1(-c / tau) - 1.0 for tau in model.tau]
    listed = ", ".join(f"k_{j} by {100 * b:.2g} %" for j, b in enumerate(bias, start=1))
    return Finding(
        f"the ramp of {c:.3g} s is accounted for; taking it as a step at its end would change "
        f"{listed}",
        float(min(bias)),
    )


@criterion(
    "fastest tau / ramp", ">=", 0.1, f"our choice; or k known to {100 * KNOWN_K:g} %", grade="note"
)
def fast_arm_visible(
    model: GeneralizedMaxwell, tests: Sequence[RampHold], *, error: float = np.inf
) -> Finding:
    """The fastest arm is slow enough to be seen after the ramp, or its k is known all the same.

    `error` is the relative standard error of its k.
    """
    if not model.arms:
        return Finding("there is no arm")
    ratio = model.tau[0] / min(test.ramp_time for test in tests)
    return Finding(
        f"the fastest arm, tau = {model.tau[0]:.3g} s, is {ratio:.2g} of the shortest ramp",
        ratio,
        "; it has relaxed before the ramp ends, so only its b = k tau is seen, not its k: "
        "ramp faster, or identify it from vibration",
        excused=error < KNOWN_K,
    )


@criterion(
    "SE(ln tau), slowest arm",
    "<=",
    0.1,
    "our choice; or correlated with drift < 0.9",
    grade="note",
)
def drift_told_from_arm(
    model: GeneralizedMaxwell, correlation: float | None, se_ln_tau: float
) -> Finding:
    """The slowest arm can be told from a drifting sensor."""
    if not model.arms:
        return Finding("there is no slow arm to be taken for drift")
    if correlation is None:
        return Finding(
            "no drift is fitted, so a drifting sensor would be taken for the slowest arm; "
            "the fit of ramp and hold fits it"
        )
    return Finding(
        f"the slowest tau and the drift of the sensor are correlated by {correlation:.2f}, and "
        f"with the drift unknown tau is known to {100 * se_ln_tau:.2g} %",
        se_ln_tau,
        ": the record cannot tell the arm from drift; record a baseline before contact for "
        "as long as you can, and hold longer",
        excused=correlation < MAX_DRIFT_CORRELATION,
    )


@criterion("slow / medium power", "<=", 4.0, "our choice: white residuals give 1")
def residuals_steady(residuals: Sequence[FloatArray], *, rounding: float = 0.0) -> Finding:
    """The residuals do not wander slowly, as 1/f drift and a missed slow arm do.

    Those of an rms below `rounding`, N, are no measurement.
    """
    measured = [one for one in residuals if float(np.sqrt(np.mean(one * one))) > rounding]
    ratios = [wander(residual) for residual in measured if len(residual) >= 800]
    if not ratios:
        return Finding("the residuals are too few, or rounding alone, to judge slow wandering")
    return Finding(
        f"slow and medium residuals differ by a factor {max(ratios):.2g} in power",
        max(ratios),
        ": the force wanders slowly (1/f drift, temperature, or a missed arm), and no fit "
        "can tell that from a slow arm; the intervals of k_inf and of the slowest arm are "
        "too narrow",
    )


@criterion(
    "arms by BIC",
    "==",
    source="arms by significance, below the most that was tried",
    grade="note",
)
def order_agreed(choice: Choice) -> Finding:
    """The two rules for the number of arms agree, on less than the most that was tried."""
    chosen = _arms(choice.arms)
    says = f"both rules choose {chosen}"
    if not choice.agreed:
        says = (
            f"BIC supports {_arms(choice.by_bic)}, the significance of k and tau supports "
            f"{_arms(choice.by_significance)}; {chosen} taken: look at the residuals of both"
        )
    if choice.in_noise_metric:
        says += "; the noise is as slow as the arms, so fits in its own metric were judged"
    if choice.capped:
        says += f"; that is the most that was tried: ask for more than {choice.arms}"
    return Finding(
        says,
        float(choice.by_bic),
        limit=float(choice.by_significance),
        faulted=choice.capped,
    )


@criterion(
    "change of a parameter",
    "<=",
    MAX_METHOD_DIFFERENCE,
    "our choice; or 3 SE",
    grade="note",
    otherwise="limit if it is k_inf",
)
def hold_and_full_agree(
    full: GeneralizedMaxwell,
    hold: GeneralizedMaxwell | None,
    error: FloatArray,
    *,
    followed: bool = True,
) -> Finding:
    """The hold alone says the same as the recorded motion.

    `error` holds the standard errors of the full fit: k_inf, every k, every ln tau. A
    difference within three of them is noise. Where the numbers of arms differ k_inf alone is
    compared. `followed` tells whether the fit follows the ramp: which of the two to trust.
    """
    if hold is None:
        return Finding("eq. 5 does not apply to this history, so the two methods are not compared")
    n, alike = full.arms, hold.arms == full.arms
    ours, theirs = np.array([full.k_inf]), np.array([hold.k_inf])
    labels, sigma = ["k_inf"], error[:1]
    if alike:
        ours = np.array((full.k_inf, *full.k, *full.tau))
        theirs = np.array((hold.k_inf, *hold.k, *hold.tau))
        labels += [f"{kind}_{j}" for kind in ("k", "tau") for j in range(1, n + 1)]
        # an error of ln tau is relative as it stands
        sigma = np.concatenate((error[: 1 + n], np.array(full.tau) * error[1 + n : 1 + 2 * n]))
    # a plateau of nothing has no relative change: it is measured by the whole stiffness
    whole = np.where(ours > _ROUNDING * full.k_0, ours, max(full.k_0, 1e-300))
    difference = (theirs - ours) / whole
    size = np.abs(difference)
    beyond = np.abs(theirs - ours) > 3.0 * sigma
    failed = beyond & (size > MAX_METHOD_DIFFERENCE)
    worst = int(np.argmax(np.where(failed, 1e9, 0.0) + size))
    orders = "" if alike else f" with {_arms(hold.arms)} for {n}"
    trust = (
        "the ramp is followed, so trust the recorded motion, whose tare and drift are bound"
        if followed
        else "the ramp is not followed, so trust the hold"
    )
    return Finding(
        f"eq. 5 on the hold alone{orders} changes {labels[worst]} by "
        f"{100 * difference[worst]:+.2g} %, "
        f"{'more' if beyond[worst] else 'not more'} than noise explains",
        float(size[worst]),
        f"; {trust}",
        excused=not failed.any(),
        # eq. 5 knows an ideal ramp alone: that its arms differ is no fault of the recorded motion
        grade="limit" if failed[0] else None,
    )


@criterion("upper end, Hz", ">", source="the lower end of the band", grade="stop")
def frequencies_informed(band: tuple[float, float]) -> Finding:
    """The test informs a band of frequencies at all."""
    low, high = band
    return Finding(
        f"this test informs {low:.2g} to {high:.2g} Hz; a prediction beyond is an extrapolation",
        high,
        instead="at no frequency does this test halve what was unknown of the loss stiffness: "
        "reduce the noise, press deeper or hold longer",
        limit=low,
    )


# -- a filter, several depths, a broad spectrum ---------------------------------------------------


@criterion("change of a parameter", "<=", 0.01, "our choice; cut-off >= 5/tau_1, not causal")
def filter_bias(
    by: Filter | None,
    changes: Mapping[str, Mapping[str, float]] | str = "",
    fastest: float = np.inf,
) -> Finding:
    """A filter hardly changes the parameters.

    `changes` holds that of each parameter by method, or says why there is none; `fastest` is the
    shortest relaxation time, s.
    """
    if by is None:
        return Finding("the record is not filtered")
    if isinstance(changes, str):
        says = f"the bias of {by} cannot be predicted, because the raw record has no fit: {changes}"
        return Finding(says, faulted=True)
    slow = by.kind == "lowpass" and by.cutoff < 5 / fastest
    says = f"{by} changes, by eq. 5 on the hold, {_listed(changes['hold'])}; with the full history "
    if by.linear:
        most = max(changes["full"].values(), key=abs)
        says += f"at most {100 * most:+.3g} %, because the displacement is filtered alike"
    else:
        says += _listed(changes["full"])
    if slow:
        says += f"; the cut-off is below 5/tau_1 = {5 / fastest:.3g} Hz"
    if by.causal:
        says += "; a causal filter delays the force"
    return Finding(
        says,
        max(abs(change) for found in changes.values() for change in found.values()),
        "; fit the raw record: the fit needs no smooth curve",
        faulted=slow or by.causal,
    )


@criterion("probability by chance", ">=", 0.01, "Wald's test at 1 %; or alike within 0.1 %")
def separable(chance: float | None, spread: float | None) -> Finding:
    """The shape of relaxation is the same at every depth.

    A `spread` of None is a spring's, a `chance` of None that of an arm that is not known.
    """
    if spread is None:
        return Finding("a spring does not relax at any depth")
    if chance is None:
        return Finding("an arm of one depth is not identified, so the shapes cannot be compared")
    says = f"the shape of relaxation differs between depths by up to {100 * spread:.2g} %, "
    enough = "too little to matter" if spread < ALIKE else "no more than chance"
    return Finding(
        says + f"{enough}: one quasi-linear solid serves every depth",
        chance,
        instead=says + f"more than chance (probability {chance:.1g}): use each depth's own "
        "stiffnesses, not one quasi-linear solid",
        excused=spread < ALIKE,
    )


@criterion("rms error of the fit", "<", FOLLOWED)
def few_arms_suffice(missed: float, arms: int, most: int, dense: tuple[int, float]) -> Finding:
    """Few arms follow the curves.

    `dense` holds arms and rms of the dense spectrum.
    """
    return Finding(
        f"{arms} arms follow the curves",
        missed,
        instead=f"no number of arms up to {most} follows the curves: {arms} leave "
        f"{100 * missed:.2g} % rms. This is the dense spectrum on an even grid, {dense[0]} arms "
        f"that leave {100 * dense[1]:.2g} %: a table for a solver, whose single arms mean nothing",
    )


# -- storage and loss -----------------------------------------------------------------------------


@criterion("smooth misfit", "<=", MAX_INCONSISTENT, "our choice; or 2.5 sd of what chance shows")
def kramers_kronig(misfit: tuple[FloatArray, FloatArray] | None) -> Finding:
    r"""Storage and loss belong to one passive solid.

    Every passive relaxing solid is a positive sum of arms, whose storage and loss obey the
    Kramers-Kronig relations one by one. `misfit` is what the nearest of them all misses
    (:func:`~dashpot.fitting.spectrum.passive_misfit`); what it misses without scatter, the root
    of the residuals' product with their neighbours, is what the relations forbid, unless white
    residuals of that size would show as much by chance.
    """
    if misfit is None:
        return Finding(
            "a storage is not above 0, so storage and loss cannot be held against each other",
            faulted=True,
        )
    smooth = [_without_scatter(error) for error in misfit]
    return Finding(
        f"the nearest passive solid with any number of arms misses storage by "
        f"{100 * smooth[0]:.2g} % and loss by {100 * smooth[1]:.2g} % beyond scatter",
        max(smooth),
        "; storage and loss contradict each other (Kramers-Kronig), so no fit can follow "
        "both: look for a wrong shift of a master curve, a change of temperature or strain "
        "between sweeps, slip in the grips, or the compliance of the machine",
        excused=all(
            found <= max(MAX_INCONSISTENT, _by_chance(error))
            for found, error in zip(smooth, misfit, strict=True)
        ),
    )


@criterion("losses below 0", "<=", 0.0, "passivity")
def loss_positive(data: DynamicTest) -> Finding:
    """No loss gives energy back."""
    bad = np.flatnonzero(data.loss < 0)
    if not bad.size:
        return Finding("no loss is below zero", 0.0)
    return Finding(
        f"{bad.size} of {len(data.loss)} losses are below zero, the first at "
        f"{data.frequency[bad[0]]:.3g} Hz: no passive solid does that; check the sign "
        "convention, the phase calibration, and the resolution at small loss",
        float(bad.size),
    )


@criterion("fall of the storage", "<=", 0.05, "our choice: scatter")
def storage_rises(data: DynamicTest) -> Finding:
    """The storage does not fall with frequency, as mass in the grips makes it."""
    order = np.argsort(data.frequency, kind="stable")
    storage, frequency = data.storage[order], data.frequency[order]
    top = np.maximum.accumulate(storage)
    falls = 1 - storage / np.where(top > 0, top, np.inf)
    worst = int(np.argmax(falls))
    return Finding(
        "the storage does not fall with frequency beyond scatter",
        float(falls[worst]),
        instead=f"the storage has fallen by {100 * falls[worst]:.2g} % at "
        f"{frequency[worst]:.3g} Hz, which no relaxing solid does: mass moved along (inertia, a "
        "resonance of the machine) or the part warmed up; leave those frequencies out",
    )


@criterion("last third / first third", "<=", 1.25, "our choice: scatter", grade="stop")
def modulus_falls(modulus: FloatArray) -> Finding:
    """The modulus falls, as that of every relaxing solid does."""
    third = max(len(modulus) // 3, 1)
    first, last = float(modulus[:third].mean()), float(modulus[-third:].mean())
    ratio = last / first if first > 0 else None
    return Finding(
        "the modulus falls with time",
        ratio,
        instead=f"it rises with time, from {first:.3g} in its first third to {last:.3g} in its "
        "last, where a relaxation modulus falls: a creep compliance rises so, and creep is not "
        "fitted yet",
    )


@criterion("scatter jointly / alone", "<=", 1.3, otherwise=f"stop beyond {CONTRADICTED:g}")
def data_agree(spread: Sequence[float], names: Sequence[str]) -> Finding:
    """One solid explains every data set about as well as a solid of its own does.

    Parameters
    ----------
    spread : sequence of float
        What the joint fit leaves of each curve, over what a fit to its test alone leaves.
    names : sequence of str
    """
    worst = int(np.argmax(spread))
    return Finding(
        f"the joint fit leaves {spread[worst]:.3g} times of {names[worst]} what its test alone "
        "does",
        float(spread[worst]),
        ": the tests contradict each other, or one solid needs more arms for both; is it the "
        "same piece, length, temperature and depth? a small vibration at depth feels the "
        "tangent stiffness, a press from zero the secant",
        grade="stop" if spread[worst] > CONTRADICTED else None,
    )


@criterion("gap, a factor", "<=", 10.0, "our choice: a decade")
def bands_meet(dynamic: tuple[float, float], relaxation: tuple[float, float]) -> Finding:
    """No decade between the two tests is left unmeasured."""
    return Finding(
        f"the sweep covers {dynamic[0]:.3g} to {dynamic[1]:.3g} Hz and the relaxation informs "
        f"{relaxation[0]:.3g} to {relaxation[1]:.3g} Hz",
        float(max(dynamic[0] / relaxation[1], relaxation[0] / dynamic[1])),
        "; between them more than a decade was not measured, and arms there are a guess: "
        "start the sweep lower or ramp faster",
    )


# -- measures -------------------------------------------------------------------------------------


def wander(residual: FloatArray) -> float:
    """Return the mean power at 6 to 24 cycles per record over that at 60 to 240."""
    n = len(residual)
    size = fast_length(n)
    power = np.abs(np.fft.rfft(residual - residual.mean(), size)) ** 2
    cycles = np.arange(len(power)) * n / size
    slow, medium = (
        float(power[(cycles >= low) & (cycles <= high)].mean())
        for low, high in ((6, 24), (60, 240))
    )
    return slow / medium if medium > 0 else 1.0


def worst_misfit(test: RampHold, residual: FloatArray) -> tuple[float, str]:
    """Return the largest rms of ramp, a ramp after it, and the rest; and where, in words."""
    time = test.time[: test.hold.stop][-len(residual) :]
    parts = (
        ("in the ramp", (time > test.onset) & (time <= test.ramp_end)),
        ("after the ramp", (time > test.ramp_end) & (time <= test.ramp_end + test.ramp_time)),
        ("in the hold", time > test.ramp_end + test.ramp_time),
    )
    found = [
        (float(np.sqrt(np.mean(residual[part] ** 2))), where)
        for where, part in parts
        if np.count_nonzero(part) >= 5
    ]
    return max(found, default=(0.0, "in the record"))


def noise_of_force(test: RampHold) -> float:
    """Return the noise of the force, N: the scatter between samples, and about the baseline."""
    rest = test.force[(test.time < test.onset) & (test.displacement < AT_REST * test.depth)]
    return max(test.force_noise, float(rest.std()) if len(rest) >= 20 else 0.0)


def amount(value: float, unit: str) -> str:
    """Return a stiffness as people read it: N/mm of a part, MPa of a material."""
    shown, factor = ("MPa", 1e-6) if unit == "Pa" else ("N/mm", 1e-3)
    return f"{factor * value:.3g} {shown}"


def _arms(count: int) -> str:
    return "no arm" if count == 0 else f"{count} arm{'s' * (count > 1)}"


def _listed(changes: Mapping[str, float]) -> str:
    return ", ".join(
        f"{name} by {100 * change:+.3g} %" if change > -1 else f"{name} to nothing"
        for name, change in changes.items()
    )


def _without_scatter(error: FloatArray) -> float:
    r"""Return :math:`\sqrt{\overline{e_i e_{i+1}}}`: the rms of what neighbours share."""
    if len(error) < 2:
        return 0.0
    return float(np.sqrt(max(float(np.mean(error[1:] * error[:-1])), 0.0)))


def _by_chance(error: FloatArray) -> float:
    r"""Return what :func:`_without_scatter` finds in white residuals, 2.5 standard deviations.

    The mean product of n white neighbours has the standard deviation :math:`s^2/\sqrt n`.
    """
    return float(np.sqrt(2.5 * np.mean(error * error)) / len(error) ** 0.25)
