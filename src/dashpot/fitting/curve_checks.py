"""Each way in which a fit to modulus or dynamic data can deceive, as a check with a sentence."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.engine.inference.order import MAX_SE_LN_TAU, MIN_K_OVER_SE, Choice
from dashpot.fitting.checks import MAX_KAPPA, order_agreed
from dashpot.fitting.spectrum import dynamic_master_curve, relative_scale
from dashpot.records.dynamic import DynamicTest
from dashpot.solids.maxwell import GeneralizedMaxwell

MAX_INCONSISTENT = 0.05
MAX_FALL = 0.05
MAX_DISAGREEMENT = 1.3
# a grid on which one sharp arm between two others is followed to 1 %
_DENSE = 8
# what is left of zero in a sum of stiffnesses, relative to it
_ROUNDING = 1e-12


# -- what the data show -------------------------------------------------------------------------


def of_dynamic(data: DynamicTest) -> tuple[Check, ...]:
    """Return the checks that need no fit."""
    return (kramers_kronig(data), loss_positive(data), storage_rises(data))


def kramers_kronig(data: DynamicTest) -> Check:
    r"""Storage and loss belong to one passive solid.

    Every passive relaxing solid is a positive sum of arms, whose storage and loss obey the
    Kramers-Kronig relations one by one. The nearest of them all is found
    (:func:`~dashpot.fitting.spectrum.dynamic_master_curve`); what it misses without scatter,
    the root of the residuals' product with their neighbours, is what the relations forbid,
    unless white residuals of that size would show as much by chance.
    """
    name, limit = "kramers_kronig", MAX_INCONSISTENT
    try:
        nearest = dynamic_master_curve(data, per_decade=_DENSE)
    except DataError:
        says = "a storage is not above 0, so storage and loss cannot be held against each other"
        return Check(name, False, says, None, limit)
    order = np.argsort(data.frequency, kind="stable")
    error = [
        (fitted - measured)[order] / scale[order]
        for fitted, measured, scale in zip(
            (nearest.model.storage(data.omega), nearest.model.loss(data.omega)),
            (data.storage, data.loss),
            relative_scale(data),
            strict=True,
        )
    ]
    smooth = [_without_scatter(one) for one in error]
    passed = all(
        found <= max(limit, _by_chance(one)) for found, one in zip(smooth, error, strict=True)
    )
    says = (
        f"the nearest passive solid with any number of arms misses storage by "
        f"{100 * smooth[0]:.2g} % and loss by {100 * smooth[1]:.2g} % beyond scatter"
    )
    if not passed:
        says += (
            "; storage and loss contradict each other (Kramers-Kronig), so no fit can follow "
            "both: look for a wrong shift of a master curve, a change of temperature or strain "
            "between sweeps, slip in the grips, or the compliance of the machine"
        )
    return Check(name, passed, says, max(smooth), limit)


def loss_positive(data: DynamicTest) -> Check:
    """No loss gives energy back."""
    bad = np.flatnonzero(data.loss < 0)
    says = "no loss is below zero"
    if bad.size:
        i = int(bad[0])
        says = (
            f"{bad.size} of {len(data.loss)} losses are below zero, the first at "
            f"{data.frequency[i]:.3g} Hz: no passive solid does that; check the sign convention, "
            "the phase calibration, and the resolution at small loss"
        )
    return Check("loss_positive", not bad.size, says, float(bad.size), 0.0)


def storage_rises(data: DynamicTest) -> Check:
    """The storage does not fall with frequency, as mass in the grips makes it."""
    order = np.argsort(data.frequency, kind="stable")
    storage, frequency = data.storage[order], data.frequency[order]
    top = np.maximum.accumulate(storage)
    falls = 1 - storage / np.where(top > 0, top, np.inf)
    worst = int(np.argmax(falls))
    fall = float(falls[worst])
    passed = fall <= MAX_FALL
    says = "the storage does not fall with frequency beyond scatter"
    if not passed:
        says = (
            f"the storage has fallen by {100 * fall:.2g} % at {frequency[worst]:.3g} Hz, which no "
            "relaxing solid does: mass moved along (inertia, a resonance of the machine) or the "
            "part warmed up; leave those frequencies out"
        )
    return Check("storage_rises", passed, says, fall, MAX_FALL)


# -- what the fit shows -------------------------------------------------------------------------


def arms_supported(model: GeneralizedMaxwell, error: FloatArray, *, unit: str) -> Check:
    """Every arm stands out of the noise; `error` as `Fit.parameters`: k_inf, k, ln tau."""
    n = model.arms
    se_k, se_ln_tau = error[1 : 1 + n], error[1 + n : 1 + 2 * n]
    weak = [
        f"arm {j} (k = {amount(k, unit)}, tau = {tau:.3g} s)"
        for j, (k, tau, sk, st) in enumerate(
            zip(model.k, model.tau, se_k, se_ln_tau, strict=True), start=1
        )
        if not (k > MIN_K_OVER_SE * sk and st < MAX_SE_LN_TAU)
    ]
    ratios = [k / sk for k, sk in zip(model.k, se_k, strict=True) if sk > 0]
    value = float(min(ratios)) if ratios and np.isfinite(min(ratios)) else None
    says = "every arm stands out of the noise"
    if weak:
        says = (
            f"{' and '.join(weak)} cannot be told from noise: k is below {MIN_K_OVER_SE:.0f} "
            "standard errors or tau is uncertain by more than a factor 1.6; fit fewer arms"
        )
    return Check("arms_supported", not weak, says, value, MIN_K_OVER_SE)


def tau_inside_window(model: GeneralizedMaxwell, window: tuple[float, float], of: str) -> Check:
    """Every relaxation time is one that the data could show; `window` in s."""
    outside = [tau for tau in model.tau if not window[0] <= tau <= window[1]]
    span = f"{window[0]:.3g} s to {window[1]:.3g} s"
    says = f"every relaxation time lies in what {of} can show, {span}"
    if outside:
        listed = ", ".join(f"{tau:.3g} s" for tau in outside)
        says = (
            f"tau = {listed} lies outside what {of} can show, {span}: only the tail of this arm "
            "was measured, so its k and tau are an extrapolation; fit fewer arms or measure wider"
        )
    return Check("tau_inside_window", not outside, says, min(outside, default=None), window[1])


def plateau_seen(model: GeneralizedMaxwell, se: float, *, unit: str, further: str) -> Check:
    """There is a stiffness that does not relax."""
    # exact data leave a plateau of rounding size, and a standard error to match
    passed = model.k_inf > max(3.0 * se, _ROUNDING * (model.k_inf + sum(model.k)))
    says = f"the plateau is {amount(model.k_inf, unit)} with a standard error of {amount(se, unit)}"
    if not passed:
        says += f"; it is not told from zero: the material flows, or {further}"
    return Check("plateau_seen", passed, says, model.k_inf, 3.0 * se)


def residuals_random(kappa: float, sse: float, count: int) -> Check:
    """The residuals are noise: no curve is left in them."""
    passed = kappa <= MAX_KAPPA
    rms = float(np.sqrt(sse / count))
    says = f"the weighted residuals are {rms:.3g} rms and {kappa:.3g} neighbours say the same"
    if not passed:
        says += (
            ": the model misses part of the curve (a broad spectrum has no few arms: see the "
            "dense spectrum); intervals are widened for it"
        )
    return Check("residuals_random", passed, says, kappa, MAX_KAPPA)


def order(choice: Choice | None) -> tuple[Check, ...]:
    """The two rules for the number of arms agree; nothing to ask if the number was given."""
    if choice is None:
        return ()
    return (order_agreed(choice),)


# -- dynamic and relaxation together ------------------------------------------------------------


def data_agree(spread: Sequence[float], names: Sequence[str]) -> Check:
    """One solid explains every data set about as well as a solid of its own does.

    Parameters
    ----------
    spread : sequence of float
        What the joint fit leaves of each curve, over what a fit to its test alone leaves.
    names : sequence of str
    """
    worst = int(np.argmax(spread))
    passed = spread[worst] <= MAX_DISAGREEMENT
    says = (
        f"the joint fit leaves {spread[worst]:.3g} times of {names[worst]} what its test alone does"
    )
    if not passed:
        says += (
            ": the tests contradict each other, or one solid needs more arms for both; is it the "
            "same piece, length, temperature and depth? a small vibration at depth feels the "
            "tangent stiffness, a press from zero the secant"
        )
    return Check("data_agree", passed, says, float(spread[worst]), MAX_DISAGREEMENT)


def bands_meet(dynamic: tuple[float, float], relaxation: tuple[float, float]) -> Check:
    """No decade between the two tests is left unmeasured."""
    gap = max(dynamic[0] / relaxation[1], relaxation[0] / dynamic[1])
    passed = gap <= 10.0
    says = (
        f"the sweep covers {dynamic[0]:.3g} to {dynamic[1]:.3g} Hz and the relaxation informs "
        f"{relaxation[0]:.3g} to {relaxation[1]:.3g} Hz"
    )
    if not passed:
        says += (
            "; between them more than a decade was not measured, and arms there are a guess: "
            "start the sweep lower or ramp faster"
        )
    return Check("bands_meet", passed, says, float(gap), 10.0)


# -- measures -----------------------------------------------------------------------------------


def amount(value: float, unit: str) -> str:
    """Return a stiffness as people read it: N/mm of a part, MPa of a material."""
    shown, factor = ("MPa", 1e-6) if unit == "Pa" else ("N/mm", 1e-3)
    return f"{factor * value:.3g} {shown}"


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
