"""Predicted FRF of a mass on a viscoelastic solid: static equilibrium, poles, FRF."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray, validate_samples
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.provenance import Step
from dashpot.base.units import GRAVITY, Quantity, convert_to_si, format_quantity
from dashpot.base.value_ranges import (
    SIZES,
    format_quantity_short,
    require_nonnegative,
    require_positive,
)
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF, Kind, Mode
from dashpot.solids.elastic import require_plausible_compression
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid
from dashpot.vibration.checks import seal_mass_negligible

# Static equilibrium of a mass on seals, and the linear seal there.
#
# At rest n seals carry the weight, :math:`n F_e(x) = m g`; vibration about that compression feels
# the tangent of the elastic law, :math:`F_e'(x)/k` times every stiffness of the solid that a test
# found, k its secant stiffness at the depth tested (Fung: all arms answer :math:`F_e(x(t))`).


@dataclass(frozen=True)
class MassOnSeals:
    """Mass on a number of equal seals.

    Attributes
    ----------
    mass : float
        Moving mass, with its part of the seals, kg.
    seals : float
        Number of seals under it.
    compression : float or None
        Compression of the seals, m; by default where :math:`n F_e(x) = m g`.
    coupled : float
        Part of the mass of the seals that couples their ends, kg
        (:mod:`dashpot.vibration.mass_on_seals`).
    """

    mass: float
    seals: float = 1.0
    compression: float | None = None
    coupled: float = 0.0

    @property
    def keywords(self) -> dict[str, Any]:
        """The mass, seals and compression as arguments of what predicts or identifies them."""
        return {"mass": self.mass, "seals": self.seals, "compression": self.compression}

    def divide_masses(self, scale: float) -> MassOnSeals:
        """Return the masses divided by `scale`, on the same seals."""
        return replace(self, mass=self.mass / scale, coupled=self.coupled / scale)


@dataclass(frozen=True)
class OperatingPoint:
    """Operating point: a compression, and the linear seal there.

    Attributes
    ----------
    compression : float
        m; infinite where nothing carries the weight at rest.
    depth : float or None
        The deepest compression tested, m; None if the fit has no elastic law.
    factor, factor_se : float
        Tangent stiffness over the fit's, and its standard error.
    linear : bool
        The fit's elastic law is a straight line, or it has none: the factor is 1.
    is_stated : bool
        The compression was given; else it is that of the weight.
    """

    compression: float
    depth: float | None
    factor: float = 1.0
    factor_se: float = 0.0
    linear: bool = True
    is_stated: bool = False

    @property
    def is_extrapolated(self) -> bool:
        """Deeper than tested: there the last tangent goes on."""
        return self.depth is not None and self.compression > self.depth

    def solid(self, fit: Fit) -> Solid:
        """Return the tangent solid of one seal."""
        return fit.solid if self.linear else self.factor * fit.solid


def operating_point(fit: Fit, load: MassOnSeals) -> OperatingPoint:
    r"""The compression of a mass's weight, or one given, and the tangent there.

    Parameters
    ----------
    fit : Fit
        Fit of one seal.
    load : MassOnSeals

    Raises
    ------
    DataError
        If a number cannot be, the fit is of a material, no compression carries the weight, or
        the seal would be pressed beyond its height or ten times as deep as it was tested.
    """
    mass, seals, compression = load.mass, load.seals, load.compression
    require_positive(mass=mass, seals=seals)
    require_positive(compression=compression, optional=True)
    if fit.unit != "N/m":
        raise DataError(
            f"the fit is of a material's modulus, in {fit.unit}; a mass rests on a part. Give its "
            'shape: --shape disc:20mm,20mm (Python: fit.part("disc:20mm,20mm"))'
        )
    law, is_given = fit.elastic_law, compression is not None
    is_nonlinear = law is not None and law.kind != "linear"
    if compression is None:
        k_inf = fit.model.k_inf
        compression = mass * GRAVITY / (seals * k_inf) if k_inf > 0 else np.inf
        if law is not None and is_nonlinear:
            compression = law.compression(mass * GRAVITY / seals)
    require_plausible_compression(
        compression, law, fit.specimen.height, carried=None if is_given else mass / seals
    )
    if law is None or not is_nonlinear:
        depth = None if law is None else law.depth
        return OperatingPoint(float(compression), depth, is_stated=is_given)
    factor, error = float(law.factor(compression)), float(law.factor_se(compression))
    return OperatingPoint(
        float(compression), law.depth, factor, error, linear=False, is_stated=is_given
    )


# Mass on a viscoelastic solid: poles, FRF, and effect of a finite record.


FREQUENCY_TOLERANCE = 1e-14
"""Relative change at which a frequency has converged."""
_REAL_POLE_TOLERANCE = 1e-9
"""Relative imaginary part up to which a pole is real."""
_MAX_NEWTON_STEPS, _POLE_TOLERANCE, _POLE_SEPARATION = 30, 1e-12, 1e-6
"""Newton steps to a pole; relative residual that needs none; that of an accepted pole."""
LINE_COUNT, FREQUENCY_FACTOR = 4001, 10.0
"""Default lines of a prediction: their number, and the factor to either side of its peak."""
NEGLIGIBLE_PART = 1e-6
"""Relative error of stiffness up to which an arm is replaced by a dashpot or a spring."""
MAX_DECAY = 50.0
"""Time constants after which a motion is negligible."""


def predict_frf(
    model: Solid | Fit,
    *,
    mass: Quantity,
    frequency: npt.ArrayLike | None = None,
    kind: Kind | str = Kind.ACCELERANCE,
    shift: float = 0.0,
    seals: float | None = None,
    compression: Quantity | None = None,
    temperature: Quantity | None = None,
) -> FRF:
    r"""FRF of a rigid mass on a solid that is fixed to ground (paper eqs. 6 and 7).

    .. math:: \frac{X}{F}(s) = \frac{1}{m s^2 + K(s)}, \qquad T(j\omega) = \frac{-\omega^2 X}{F}

    Eq. (7) prints a magnitude with a factor :math:`-\omega^2`; the sign belongs to the complex
    accelerance, which is what is returned, phase included.

    Where the base moves and no force acts, ``kind="transmissibility"`` is the motion of the mass
    over that of the base, both absolute; less 1 it is the motion relative to the base:

    .. math:: T(s) = \frac{K(s)}{m s^2 + K(s)} = 1 - m A(s)

    Parameters
    ----------
    model : Solid or Fit
        All the seals together: two equal seals are ``2 * model``. Of a fit, which is of one seal,
        the tangent solid where the mass rests (:func:`operating_point`).
    mass : float
        kg.
    frequency : array_like, shape (n,), optional
        Hz; by default a factor of 10 to either side of the highest frequency of the peak.
    kind : Kind or str
    shift : float
        Decay of an exponential window, 1/s: evaluates at :math:`s = j\omega + a`.
    seals : float, optional
        How many seals of a fit carry the mass; 1 by default.
    compression : float, optional
        Compression of the seals of a fit, m; by default that of the mass's weight.
    temperature : float, optional
        Temperature of the seals of a fit of tests at several, K; by default that of its solid.

    Raises
    ------
    DataError
        If the mass or a frequency cannot be, the mass would sink farther into the solid than any
        does, the response is infinite at a line, seals, a
        compression or a temperature were given with a solid, or the fit knows of no such
        temperature.
    """
    mass, compression = convert_to_si(mass, "mass"), convert_to_si(compression, "length")
    require_positive(mass=mass, unit=" kg")
    if temperature is not None:
        model = _apply_temperature(model, temperature)
    model = _assemble_seals(model, mass, seals, compression)
    _refuse_sag(model, mass)
    f = (
        _default_frequencies(model.k_0, mass)
        if frequency is None
        else validate_samples("frequency", frequency)
    )
    s = 2j * np.pi * f + shift
    stiffness = model.stiffness_at(s)
    with np.errstate(divide="ignore", invalid="ignore"):
        receptance = 1 / (mass * s**2 + stiffness)
    if not np.isfinite(receptance).all():
        i = int(np.flatnonzero(~np.isfinite(receptance))[0])
        raise DataError(
            f"the response at {f[i]:g} Hz is infinite: the solid has no stiffness there"
        )
    if Kind(kind) is Kind.TRANSMISSIBILITY:
        return FRF(f, stiffness * receptance, Kind.TRANSMISSIBILITY, shift=shift, units="SI")
    if Kind(kind) is Kind.RELATIVE_TRANSMISSIBILITY:
        return FRF.from_receptance(f, receptance, shift=shift).to(kind, mass=mass)
    return FRF.from_receptance(f, receptance, kind=kind, shift=shift)


def isolation_frequency(model: Solid, mass: float) -> float:
    r"""Return frequency above which the mass moves less than its base, Hz.

    There :math:`m\omega^2 = 2 K'(\omega)`. Since K' does not fall with frequency,
    :math:`\omega \leftarrow \sqrt{2 K'(\omega) / m}` comes down from the glassy stiffness to the
    highest such frequency and passes none.

    Parameters
    ----------
    model : Solid
        All the seals together.
    mass : float
        kg.
    """
    require_positive(mass=mass, unit=" kg")
    arms = model.maxwell
    omega, last = float(np.sqrt(2 * (arms.k_inf + sum(arms.k)) / mass)), np.inf
    while omega < last * (1 - FREQUENCY_TOLERANCE):
        stiffness = float(arms.complex_stiffness(omega=np.array([omega])).real[0])
        omega, last = float(np.sqrt(2 * max(stiffness, 0.0) / mass)), omega
    return omega / (2 * np.pi)


def _refuse_sag(model: Solid, mass: float) -> None:
    """Raise DataError if the weight would compress the solid by more than any seal."""
    k_inf = model.maxwell.k_inf
    if k_inf > 0:
        sag = mass * GRAVITY / k_inf
        SIZES["sag"].refuse(
            sag,
            f"a mass of {format_quantity_short(mass, 'kg')} would press the solid by "
            f"{format_quantity_short(sag, 'm')}",
            remedy="Check the mass and its unit (is it g?).",
        )


def _apply_temperature(model: Solid | Fit, temperature: Quantity) -> Fit:
    if isinstance(model, Fit):
        return model.at_temperature(temperature)
    raise DataError(
        "a solid has no temperature, which belongs to a fit of tests at several: give the fit, or "
        "the solid at that temperature (Python: fit.at(temperature))"
    )


def _assemble_seals(
    model: Solid | Fit, mass: float, seals: float | None, compression: float | None
) -> Solid:
    """Return the tangent solid of all seals together."""
    if isinstance(model, Fit):
        count = 1.0 if seals is None else seals
        point = operating_point(model, MassOnSeals(mass, count, compression))
        return count * point.solid(model)
    if seals is not None or compression is not None:
        raise DataError(
            "seals= and compression= belong to a fit of one seal; a solid is all the seals "
            "together, as they vibrate: give seals * solid, or the fit"
        )
    return model


def _default_frequencies(stiffness: float, mass: float) -> FloatArray:
    """Return lines about the highest frequency that the peak can have."""
    if not (np.isfinite(stiffness) and stiffness > 0):
        raise DataError(
            "the solid has no stiffness of its own at high frequency (Python: give frequency=)"
        )
    peak_limit = compute_peak_limit(stiffness, mass)
    return np.geomspace(peak_limit / FREQUENCY_FACTOR, peak_limit * FREQUENCY_FACTOR, LINE_COUNT)


def compute_peak_limit(stiffness: float, mass: float) -> float:
    r"""Return the frequency, Hz, that the peak of a mass cannot pass: :math:`\sqrt{k_0/m}/2\pi`.

    `stiffness`, N/m, is that of all the seals together at high frequency, `mass` in kg.

    Raises
    ------
    DataError
        If the mass cannot be.
    """
    require_positive(mass=mass, unit=" kg")
    return float(np.sqrt(max(stiffness, 0.0) / mass) / (2 * np.pi))


def model_modes(model: Solid, mass: float) -> tuple[Mode, ...]:
    r"""Exact modes of a mass on a solid: the oscillating poles of :math:`m s^2 + K(s)`.

    `model` is all the seals together, `mass` in kg. Empty where the mass creeps back without
    oscillating. The residue of the receptance is :math:`1/(2 m p + K'(p))`.

    Raises
    ------
    DataError
        If the mass cannot be.

    Examples
    --------
    >>> from dashpot.solids.maxwell import GeneralizedMaxwell
    >>> seal = GeneralizedMaxwell(196.5, k=(117.5, 17.8), tau=(59 / 117.5, 292.2 / 17.8))
    >>> (mode,) = model_modes(2 * seal, mass=0.1040426)
    >>> round(mode.frequency, 4), round(mode.damping_ratio, 6)
    (12.7097, 0.004435)
    """
    require_positive(mass=mass, unit=" kg")
    p = poles(model, mass)
    p = np.append(
        p[p.imag > _REAL_POLE_TOLERANCE * np.abs(p)], _estimate_undamped_pole(model, mass)
    )
    p = _refine_poles(model, mass, p)
    return tuple(
        Mode(float(abs(pole)) / (2 * np.pi), float(-pole.real / abs(pole)), complex(residue))
        for pole, residue in zip(p, residues(model, mass, p), strict=True)
    )


def _estimate_undamped_pole(model: Solid, mass: float) -> complex:
    """Return the pole of the undamped mass, 1/s, as a starting point."""
    omega = np.sqrt(max(model.k_0, 0.0) / mass)
    for _ in range(50):
        stiffness = float(model.stiffness_at(1j * omega).real) if omega > 0 else 0.0
        omega = np.sqrt(max(stiffness, 0.0) / mass)
    return complex(0.0, omega)


def _refine_poles(model: Solid, mass: float, p: ComplexArray) -> ComplexArray:
    """Return the poles of the solid by Newton's method, from those of its arms.

    Of arms over twenty decades rounding makes poles that are none: they do not settle, or settle
    twice.
    """

    def evaluate_characteristic(p: ComplexArray) -> ComplexArray:
        return np.asarray(mass * p**2 + model.stiffness_at(p))

    p = p[p != 0]
    for _ in range(_MAX_NEWTON_STEPS):
        is_unsettled = np.abs(evaluate_characteristic(p)) > _POLE_TOLERANCE * np.abs(mass * p**2)
        if not is_unsettled.any():
            break
        updated = p - evaluate_characteristic(p) / (2 * mass * p + model.slope_at(p))
        p = np.where(is_unsettled & np.isfinite(updated), updated, p)
    is_settled = np.abs(evaluate_characteristic(p)) <= _POLE_SEPARATION * np.abs(mass * p**2)
    values = p[is_settled & (p.real <= 0) & (p.imag > _REAL_POLE_TOLERANCE * np.abs(p))]
    distinct = [
        i
        for i, value in enumerate(values)
        if not (np.abs(values[:i] / value - 1) < _POLE_SEPARATION).any()
    ]
    return np.asarray(values[distinct])


def poles(model: Solid, mass: float) -> ComplexArray:
    r"""Poles of a mass on a solid, 1/s, shape (2 + arms,): roots of :math:`m s^2 + K(s) = 0`.

    Eigenvalues of the state matrix in position, velocity and the elongation of each arm's spring,
    :math:`\dot q_j = v - q_j/\tau_j`; `model` is all the seals together, `mass` in kg. Of the
    arms that stand for the solid.
    """
    arms = model.maxwell
    pole_count = 2 + arms.arms
    state = np.zeros((pole_count, pole_count))
    state[0, 1] = 1.0
    state[1, 0] = -arms.k_inf / mass
    state[1, 1] = -arms.b / mass
    state[1, 2:] = -np.asarray(arms.k) / mass
    state[2:, 1] = 1.0
    state[2:, 2:] = -np.diag(1 / np.asarray(arms.tau))
    return np.asarray(np.linalg.eigvals(state), dtype=complex)


def ringing_pole(model: Solid, mass: float) -> complex:
    """Return the pole that oscillates fastest, 1/s."""
    values = poles(model, mass)
    return complex(values[np.argmax(values.imag)])


def residues(model: Solid, mass: float, pole: ComplexArray) -> ComplexArray:
    r"""Residues of the receptance at its simple poles: :math:`1 / (2 m p + K'(p))`, m/(N s)."""
    slope = model.slope_at(pole)
    # an arm too weak to shift its own pole has an infinite slope there, and no residue
    finite = np.isfinite(slope)
    residue = np.zeros(len(pole), dtype=complex)
    residue[finite] = 1 / (2 * mass * pole[finite] + slope[finite])
    return residue


def accelerance(
    model: Solid, mass: float, s: npt.ArrayLike, record: float | None = None, pulse: float = 0.0
) -> ComplexArray:
    r"""Accelerance as the transform of a response cut off `record` s after the hit sees it, 1/kg.

    .. math::

        A_T(s) = \frac{s^2}{m s^2 + K(s)} - \sum_i r_i p_i^2
                 \frac{e^{(p_i - s) T + \vartheta^2 (p_i^2 - s^2)/2}}{s - p_i}

    where :math:`r_i` is the residue of the receptance at its pole :math:`p_i` and
    :math:`\vartheta` the rms width of the `pulse`, s, at whose middle the record begins. With an
    exponential window, s = j omega + a, the cut-off part shrinks by e^{-aT}; without a `record`
    nothing is cut.
    """
    return Response(model, mass, np.asarray(s, dtype=complex), record, pulse).accelerance


class TruncationLoss(NamedTuple):
    """Terms of a response that the end of its record truncates, one per pole.

    Attributes
    ----------
    p, residue : complex array, shape (m,)
        Pole and residue of the receptance.
    amplitude, curvature : complex array, shape (m,)
        Amplitude and curvature of the truncated term, and the second derivative of m s^2 + K at the
        pole.
    """

    p: ComplexArray
    residue: ComplexArray
    amplitude: ComplexArray
    curvature: ComplexArray


@dataclass(frozen=True, eq=False)
class Response:
    """Response of a mass on a solid in a finite record, as :func:`accelerance`, with its slope.

    Attributes
    ----------
    model : Solid
    mass : float
        kg.
    s : complex array, shape (n,)
    record : float or None
        s.
    pulse : float
        s.
    """

    model: Solid
    mass: float
    s: ComplexArray
    record: float | None
    pulse: float

    @cached_property
    def receptance(self) -> ComplexArray:
        """Return the receptance for a record without an end, m/N."""
        return np.asarray(1 / (self.mass * self.s**2 + self.model.stiffness_at(self.s)))

    @cached_property
    def accelerance(self) -> ComplexArray:
        """Shape (n,), 1/kg."""
        untruncated, loss = self.s**2 * self.receptance, self._truncation_loss
        if loss is None:
            return np.asarray(untruncated)
        return np.asarray(
            untruncated
            - (loss.amplitude / (self.s[:, None] - loss.p)).sum(axis=1) * self._compute_end_motion
        )

    def slope(
        self,
        line_slopes: ComplexArray,
        evaluate_pole_slopes: Callable[[TruncationLoss], tuple[ComplexArray, ComplexArray]],
    ) -> ComplexArray:
        """Return derivative of the accelerance by some parameters, shape (n, q).

        Parameters
        ----------
        line_slopes : complex array, shape (n, q)
            That of m s^2 + K.
        evaluate_pole_slopes : callable
            That of m s^2 + K, and of its derivative by s, at the poles, shape (k, q) each.
        """
        untruncated = -((self.s * self.receptance) ** 2)[:, None] * line_slopes
        if (loss := self._truncation_loss) is None:
            return untruncated
        pole_change, slope_change = evaluate_pole_slopes(loss)
        p, residue = loss.p[:, None], loss.residue[:, None]
        shift = -residue * pole_change
        # of the residue, of p^2, and of the decay until the end
        residue_change = -residue * (slope_change + loss.curvature[:, None] * shift)
        residue_change += (2 / p + (self.record or 0.0) + self.pulse**2 * p) * shift
        part = loss.amplitude / (self.s[:, None] - loss.p)
        truncation_slope = part @ residue_change + part / (self.s[:, None] - loss.p) @ shift
        return np.asarray(untruncated - truncation_slope * self._compute_end_motion[:, None])

    @cached_property
    def _compute_end_motion(self) -> ComplexArray:
        return np.asarray(np.exp(-self.s * (self.record or 0.0) - 0.5 * (self.pulse * self.s) ** 2))

    @cached_property
    def _truncation_loss(self) -> TruncationLoss | None:
        if self.record is None:
            return None
        sizes, mass = np.abs(self.s), self.mass
        arms = _simplify_distant_arms(
            self.model.maxwell, float(sizes.min()), float(sizes.max()), self.record
        )
        p = poles(arms, mass)
        # of an arm faster than the pulse the width of it shows nothing: it has long died away
        p = p[p.real * self.record > -MAX_DECAY]
        r = residues(arms, mass, p)
        motion_at_end = r * p**2 * np.exp(p * self.record + 0.5 * (self.pulse * p) ** 2)
        is_alive = np.abs(motion_at_end) > 0
        p = p[is_alive]
        return TruncationLoss(p, r[is_alive], motion_at_end[is_alive], 2 * mass + arms.bend_at(p))


def _simplify_distant_arms(
    arms: GeneralizedMaxwell, slowest: float, fastest: float, record: float
) -> GeneralizedMaxwell:
    """Return the solid, within 1e-6, with far faster arms as a dashpot and far slower as a spring.

    Relaxation times over a hundred decades, as of a flat spectrum, leave no digit of any pole.
    """
    # of a fast arm what is missed is a square
    fastest_tau = np.sqrt(NEGLIGIBLE_PART) / max(fastest, 1 / record)
    slowest_tau = max(1 / slowest if slowest > 0 else record, record) / NEGLIGIBLE_PART
    if not arms.arms or (arms.tau[0] >= fastest_tau and arms.tau[-1] <= slowest_tau):
        return arms
    k, tau = np.asarray(arms.k), np.asarray(arms.tau)
    is_retained = (tau >= fastest_tau) & (tau <= slowest_tau)
    return GeneralizedMaxwell(
        arms.k_inf + float(k[tau > slowest_tau].sum()),
        tuple(k[is_retained]),
        tuple(tau[is_retained]),
        arms.b + float((k * tau)[tau < fastest_tau].sum()),
    )


def mass_for_peak(model: Solid, frequency: float, kind: Kind | str = Kind.ACCELERANCE) -> float:
    r"""The mass that puts the peak of the accelerance at `frequency` Hz, kg; no number if none.

    At the peak :math:`|m - u|^2`, with :math:`u = K(j\omega)/\omega^2`, has a zero slope, which is
    linear in m:

    .. math:: m = \frac{\mathrm{Re}(\bar u' u)}{\mathrm{Re}\,u'}

    Of a transmissibility :math:`T = u / (u - m)`, so too:

    .. math:: m = 2 \,\mathrm{Re}\,u - \frac{|u|^2\,\mathrm{Re}\,u'}{\mathrm{Re}(\bar u' u)}
    """
    omega = 2 * np.pi * frequency
    w = omega * (1 + np.array([-1e-5, 0.0, 1e-5]))
    u = model.complex_stiffness(omega=w) / w**2
    slope = u[2] - u[0]
    product, center = float((np.conj(slope) * u[1]).real), complex(u[1])
    if Kind(kind) is Kind.TRANSMISSIBILITY:
        return 2 * center.real - abs(center) ** 2 * slope.real / product if product != 0 else np.nan
    return float(product / slope.real) if slope.real != 0 else float("nan")


def geometry_factor(
    modulus: Solid, *, mass: Quantity, peak: Quantity, kind: Kind | str = Kind.TRANSMISSIBILITY
) -> float:
    r"""Return the geometry factor of a part from one measured resonance, m: :math:`K^* = g\,E^*`.

    A mass on g times a solid peaks where m/g does on the solid itself
    (:func:`mass_for_peak`).

    Parameters
    ----------
    modulus : Solid
        Modulus of the material, Pa.
    mass : str or float
        On all the parts together, kg.
    peak : str or float
        Frequency at which the FRF is largest, Hz.
    kind : str
        Kind of that FRF: a transmissibility, or ``"accelerance"``.

    Raises
    ------
    DataError
        If no such part peaks there: the material damps too much.
    """
    kilograms, hz = convert_to_si(mass, "mass"), convert_to_si(peak, "frequency")
    require_positive(mass=kilograms, unit=" kg")
    require_positive(peak=hz, unit=" Hz", expected="a frequency > 0")
    ratio = mass_for_peak(modulus, hz, kind)
    if not (np.isfinite(ratio) and ratio > 0):
        raise DataError(
            f"no part of this material has a peak at {hz:.5g} Hz: it damps too much there"
        )
    return kilograms / ratio


def moving_mass(block: float, *, seal: float, seals: float = 1.0) -> tuple[float, Check]:
    r"""Mass that moves when a block rests on seals that have a mass of their own.

    .. math:: m = m_{\mathrm{block}} + n\,m_{\mathrm{seal}} / 3

    A third of a spring's mass moves with its free end (Rayleigh), as long as no wave runs within
    the seal. The paper neglects it.

    Parameters
    ----------
    block, seal : float
        Mass of the block and of the compressed part of one seal, kg.
    seals : float
        How many carry the block.

    Returns
    -------
    mass : float
        kg.
    check : Check
        ``seal_mass_negligible``: whether all seals weigh less than 2 % of the block.
    """
    require_positive("block ", mass=block, unit=" kg")
    require_nonnegative("seal ", mass=seal, unit=" kg")
    if seals * seal > block:
        raise DataError(
            f"the seals would weigh {format_quantity(seals * seal, 'g')} on a mass of "
            f"{format_quantity(block, 'g')}: check the mass of one seal and its unit"
        )
    return block + seals * seal / 3, seal_mass_negligible(seals * seal / block)


# Transmissibility with the mass of mounts and of a sensor between their ends.


def compute_coupled_mass(seal: float | None, seals: float) -> float:
    r"""Mass of the mounts that couples the mass to its base, kg: a sixth of theirs.

    The consistent mass matrix of a rod, of mass :math:`m_r`, is :math:`m_r/6\,(2\;1;\,1\;2)`: a
    third moves with either end, and a sixth between them.
    """
    return 0.0 if seal is None else seals * seal / 6


def add_mount_mass(frf: FRF, *, mass: float, coupled: float) -> FRF:
    r"""Return the transmissibility on mounts with mass, from that on massless mounts.

    .. math:: K + \omega^2\mu = T\,(K - \omega^2 M), \qquad T - 1 = (T_0 - 1)\,(1 + \mu / M)

    with T_0 that of mounts without mass under the moving mass M, and :math:`\mu` the mass that
    couples it to the base (:func:`compute_coupled_mass`). Good to the second resonance of the
    mounts: within 0.2 % of K up to twice the natural frequency where they weigh a tenth of the
    mass.

    Parameters
    ----------
    frf : FRF
        A transmissibility, or a relative one.
    mass, coupled : float
        M, a third of the mounts included, and :math:`\mu`, kg.
    """
    return _scale_relative_motion(frf, 1 + coupled / mass)


def remove_mount_mass(frf: FRF, *, mass: float, coupled: float) -> FRF:
    """Return the transmissibility on massless mounts: the inverse of `add_mount_mass`."""
    if coupled == 0:
        return frf
    step = Step("on_light_mounts", (("mass", f"{mass!r} kg"), ("coupled", f"{coupled!r} kg")))
    motion = _scale_relative_motion(frf, 1 / (1 + coupled / mass))
    return replace(motion, steps=(*frf.steps, step))


def _scale_relative_motion(frf: FRF, factor: float) -> FRF:
    """Return the motion relative to the base, so many times, as the kind that it was."""
    if not frf.quantity.over_base:
        raise DataError(f"the FRF is a {frf.quantity.label}; expected a transmissibility")
    relative = frf.to(Kind.RELATIVE_TRANSMISSIBILITY)
    sd = None if relative.sd is None else factor * relative.sd
    return replace(relative, value=factor * relative.value, sd=sd).to(frf.quantity)


def as_relative(frf: FRF) -> FRF:
    """Return the FRF with its values taken as relative transmissibility, (mass - base) / base."""
    step = Step("as_relative", (), "the motion of the mass was measured relative to the base")
    return replace(frf, quantity=Kind.RELATIVE_TRANSMISSIBILITY, steps=(*frf.steps, step))
