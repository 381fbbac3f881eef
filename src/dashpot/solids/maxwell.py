"""Base class of solids, the generalized Maxwell solid, and solids in parallel."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property, reduce
from operator import add
from typing import TYPE_CHECKING, Any, NamedTuple, overload

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import (
    ComplexArray,
    FloatArray,
    convert_numbers_to_si,
    require_increasing,
    require_same_length,
    to_complex,
    validate_samples,
)
from dashpot.base.errors import DataError
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import Quantity
from dashpot.base.value_ranges import require_positive

if TYPE_CHECKING:
    from dashpot.solids.interconversion import CreepSpectrum


# Base class of solids, and the generalized Maxwell solid.


# Number of values (samples times arms) of one step of a scan, for speed.
_CACHE_SIZE = 8192


def angular(
    *positional: object, frequency: Quantity | npt.ArrayLike | None = None, omega: Any = None
) -> FloatArray:
    """Return the angular frequency, rad/s, that is named: the two differ more than sixfold.

    Raises
    ------
    TypeError
        If a bare number is given, or not one of both.
    """
    if positional or (frequency is None) == (omega is None):
        raise TypeError("say frequency= in Hz or omega= in rad/s")
    if frequency is None:
        return convert_numbers_to_si("omega", omega)
    return 2 * np.pi * convert_numbers_to_si("frequency", frequency, "frequency")


class Solid(ABC):
    r"""Linear viscoelastic solid: a complex stiffness, with its equivalent positive arms.

    A new solid gives `k_inf`, `k_0`, :meth:`stiffness_at`, `maxwell` and the product with a
    number; frequency follows from its stiffness, time from its arms.

    Sign convention: x(t) = Re X e^{+j omega t}; a positive imaginary part dissipates.

    Attributes
    ----------
    k_inf, k_0 : float
        Equilibrium and instantaneous stiffness, N/m, >= 0.
    """

    k_inf: float
    k_0: float

    @property
    @abstractmethod
    def maxwell(self) -> GeneralizedMaxwell:
        """The arms of the solid, exact or within the given tolerance."""

    @abstractmethod
    def stiffness_at(self, s: npt.ArrayLike) -> ComplexArray:
        r"""Stiffness on the Laplace plane, N/m, `s` in 1/s.

        At :math:`s = j\omega` it is the complex stiffness, at :math:`s = j\omega + a` what an
        exponentially windowed test sees.
        """

    @abstractmethod
    def __mul__(self, count: float) -> Solid:
        """`count` equal solids in parallel; a fraction is a shorter piece of seal."""

    @abstractmethod
    def __rmul__(self, count: float) -> Solid:
        """Return ``solid * count``."""

    def slope_at(self, s: npt.ArrayLike) -> ComplexArray:
        """Derivative of the stiffness by s, N s/m: by differences over a circle about `s`."""
        s = to_complex(s)
        # four points leave an error of the fourth power of the step
        circle_points = 1e-3 * np.abs(s)[..., None] * np.array([1, 1j, -1, -1j])
        return np.asarray(
            (self.stiffness_at(s[..., None] + circle_points) / circle_points).mean(axis=-1)
        )

    @overload
    def complex_stiffness(self, *, frequency: Quantity | npt.ArrayLike) -> ComplexArray: ...
    @overload
    def complex_stiffness(self, *, omega: npt.ArrayLike) -> ComplexArray: ...
    def complex_stiffness(
        self, *positional: object, frequency: Any = None, omega: Any = None
    ) -> ComplexArray:
        r"""Complex stiffness :math:`K^*(\omega)`, N/m, at `frequency`, Hz, or `omega`, rad/s."""
        return self.stiffness_at(1j * angular(*positional, frequency=frequency, omega=omega))

    @overload
    def storage(self, *, frequency: Quantity | npt.ArrayLike) -> FloatArray: ...
    @overload
    def storage(self, *, omega: npt.ArrayLike) -> FloatArray: ...
    def storage(self, *positional: object, frequency: Any = None, omega: Any = None) -> FloatArray:
        """Return storage stiffness K', N/m, at `frequency`, Hz, or `omega`, rad/s."""
        omega = angular(*positional, frequency=frequency, omega=omega)
        return np.asarray(self.stiffness_at(1j * omega).real)

    @overload
    def loss(self, *, frequency: Quantity | npt.ArrayLike) -> FloatArray: ...
    @overload
    def loss(self, *, omega: npt.ArrayLike) -> FloatArray: ...
    def loss(self, *positional: object, frequency: Any = None, omega: Any = None) -> FloatArray:
        """Return loss stiffness K'', N/m, at `frequency`, Hz, or `omega`, rad/s."""
        omega = angular(*positional, frequency=frequency, omega=omega)
        return np.asarray(self.stiffness_at(1j * omega).imag)

    @overload
    def loss_factor(self, *, frequency: Quantity | npt.ArrayLike) -> FloatArray: ...
    @overload
    def loss_factor(self, *, omega: npt.ArrayLike) -> FloatArray: ...
    def loss_factor(
        self, *positional: object, frequency: Any = None, omega: Any = None
    ) -> FloatArray:
        """Return loss factor K''/K', dimensionless, at `frequency`, Hz, or `omega`, rad/s."""
        stiffness = self.stiffness_at(1j * angular(*positional, frequency=frequency, omega=omega))
        return np.asarray(stiffness.imag / stiffness.real)[()]

    def relaxation(self, t: npt.ArrayLike) -> FloatArray:
        """Relaxation stiffness, N/m, for t > 0 in s."""
        return self.maxwell.relaxation(t)

    def creep(self, t: npt.ArrayLike) -> FloatArray:
        """Creep compliance, m/N, for t > 0 in s: the displacement under a unit step of force."""
        return self.maxwell.creep(t)

    def force(self, t: npt.ArrayLike, displacement: npt.ArrayLike) -> FloatArray:
        """Force, N, under a displacement history, m, that is straight between its samples."""
        return self.maxwell.force(t, displacement)

    def displacement(self, t: npt.ArrayLike, force: npt.ArrayLike) -> FloatArray:
        """Displacement, m, under a force history, N, that is straight between its samples."""
        return self.maxwell.displacement(t, force)


class MaxwellArm(NamedTuple):
    """Maxwell arm: spring, N/m, relaxation time, s, and dashpot, N s/m."""

    k: float
    tau: float
    b: float


@dataclass(frozen=True)
class GeneralizedMaxwell(Solid, Serialisable):
    r"""Generalized Maxwell solid: a spring, a dashpot and Maxwell arms in parallel.

    .. math::

        k(t) = k_\infty + \sum_j k_j e^{-t/\tau_j} + b\,\delta(t), \qquad
        K^*(\omega) = k_\infty + \sum_j k_j \frac{j\omega\tau_j}{1 + j\omega\tau_j} + j\omega b

    ::

            +---[ k_inf ]------------+
        o---+---[ k_1 ]--( b_1 )-----+---o      b_j = k_j tau_j
            +---[ k_2 ]--( b_2 )-----+
            +---( b )----------------+

    Attributes
    ----------
    k_inf : float
        Equilibrium stiffness, N/m, >= 0.
    k : tuple of float
        Arm stiffnesses, N/m, > 0.
    tau : tuple of float
        Relaxation times, s, > 0; stored ascending, as in the paper's Table 1.
    b : float
        Parallel dashpot, N s/m, >= 0: with it Kelvin-Voigt and Maxwell-Voigt are of this type.

    The same mathematics serves a part (N/m) and a material (Pa). Source: paper eqs. (1)-(5);
    R. S. Lakes, *Viscoelastic Materials*.

    >>> seal = GeneralizedMaxwell(196.5, k=(117.5, 17.8), tau=(0.5021, 16.416))
    >>> round(seal.loss_factor(frequency="12.71Hz"), 5)
    np.float64(0.00887)
    """

    schema = "dashpot/model@1"
    _keys = ("k_inf", "b", Key("arms", "arms_list"))

    k_inf: float
    k: tuple[float, ...] = ()
    tau: tuple[float, ...] = ()
    b: float = 0.0

    def __post_init__(self) -> None:
        try:
            k, tau, (k_inf, b) = (
                np.atleast_1d(np.asarray(values, dtype=float))
                for values in (self.k, self.tau, (self.k_inf, self.b))
            )
        except (TypeError, ValueError):
            raise DataError(
                f"k_inf={self.k_inf!r}, k={self.k!r}, tau={self.tau!r}, b={self.b!r}; expected "
                "numbers in SI: N/m, s and N s/m"
            ) from None
        if len(k) != len(tau):
            raise DataError(f"every arm needs a k and a tau, found {len(k)} k and {len(tau)} tau")
        for name, value in (("k_inf", k_inf), ("b", b)):
            if not (np.isfinite(value) and value >= 0):
                raise DataError(
                    f"{name} = {float(value)!r}; a passive solid needs {name} >= 0 and finite"
                )
        for name, values in (("k", k), ("tau", tau)):
            bad_indices = np.flatnonzero(~(np.isfinite(values) & (values > 0)))
            if bad_indices.size:
                bad_index, value = int(bad_indices[0]), float(values[bad_indices[0]])
                raise DataError(
                    f"{name}_{bad_index + 1} = {value!r}; a passive arm needs {name} > 0 and finite"
                )
        order = np.argsort(tau, kind="stable")
        object.__setattr__(self, "k_inf", float(k_inf))
        object.__setattr__(self, "b", float(b))
        object.__setattr__(self, "k", tuple(k[order].tolist()))
        object.__setattr__(self, "tau", tuple(tau[order].tolist()))

    # -- what it is ---------------------------------------------------------------------------

    @property
    def arms(self) -> int:
        """Number of Maxwell arms."""
        return len(self.k)

    @property
    def maxwell(self) -> GeneralizedMaxwell:
        """Itself."""
        return self

    @property
    def arm_b(self) -> tuple[float, ...]:
        r"""Arm dashpots :math:`b_j = k_j \tau_j`, N s/m."""
        return tuple(k * tau for k, tau in zip(self.k, self.tau, strict=True))

    @property
    def arms_list(self) -> tuple[MaxwellArm, ...]:
        """The arms one by one."""
        return tuple(map(MaxwellArm, self.k, self.tau, self.arm_b))

    @property
    def k_0(self) -> float:  # type: ignore[override]  # others keep it as a field
        r"""Instantaneous stiffness :math:`k_\infty + \sum k_j`, N/m."""
        return self.k_inf + sum(self.k)

    # -- algebra ------------------------------------------------------------------------------

    def __add__(self, other: GeneralizedMaxwell) -> GeneralizedMaxwell:
        """Two solids in parallel: stiffnesses add, equal relaxation times merge."""
        if not isinstance(other, GeneralizedMaxwell):
            return NotImplemented
        arms: dict[float, float] = {}
        for k, tau in zip(self.k + other.k, self.tau + other.tau, strict=True):
            arms[tau] = arms.get(tau, 0.0) + k
        return GeneralizedMaxwell(
            self.k_inf + other.k_inf, tuple(arms.values()), tuple(arms), self.b + other.b
        )

    def __mul__(self, count: float) -> GeneralizedMaxwell:
        """`count` equal solids in parallel; a fraction is a shorter piece of seal."""
        if not isinstance(count, int | float | np.number):
            return NotImplemented
        if not (np.isfinite(count) and count > 0):
            raise DataError(f"cannot take {count!r} solids in parallel; expected a number > 0")
        return replace(
            self, k_inf=self.k_inf * count, k=tuple(k * count for k in self.k), b=self.b * count
        )

    __rmul__ = __mul__

    def with_length(self, length: float, *, measured_length: float) -> GeneralizedMaxwell:
        """Return the same section at another contact length, both in m: stiffness is per length."""
        require_positive(
            length=length, measured_length=measured_length, unit=" m", expected="a length > 0"
        )
        return self * (length / measured_length)

    def shift_to_temperature(self, a_t: float, b_t: float = 1.0) -> GeneralizedMaxwell:
        r"""Return the solid at another temperature: :math:`K^*(\omega) \to b_T K^*(a_T \omega)`.

        Relaxation times times `a_t`, stiffnesses times `b_t`
        (:mod:`dashpot.solids.shift_laws`).
        """
        require_positive(a_t=a_t, expected="a shift factor > 0")
        slower = replace(self, tau=tuple(a_t * tau for tau in self.tau), b=self.b * a_t)
        return slower * b_t

    def to_prony(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        r"""Relative moduli :math:`g_j = k_j / k_0` and relaxation times, as FE codes take them.

        Raises
        ------
        DataError
            If there is a parallel dashpot: a Prony series cannot hold one.
        """
        if self.b > 0:
            raise DataError(
                f"b = {self.b:g} N s/m: a Prony series has no parallel dashpot; "
                "export the arms, or fit without b"
            )
        if self.k_0 == 0:
            raise DataError("a solid without stiffness has no Prony series")
        return tuple(k / self.k_0 for k in self.k), self.tau

    # -- time ---------------------------------------------------------------------------------

    def relaxation(self, t: npt.ArrayLike) -> FloatArray:
        r"""Relaxation stiffness :math:`k_\infty + \sum_j k_j e^{-t/\tau_j}`, N/m, for t > 0 in s.

        The parallel dashpot's impulse at t = 0 is not in it.
        """
        t = convert_numbers_to_si("t", t, "time")
        k, tau = self._arms()
        return np.asarray(self.k_inf + np.exp(-t[..., None] / tau) @ k)

    def creep(self, t: npt.ArrayLike) -> FloatArray:
        r"""Creep compliance, m/N, for t > 0 in s: the displacement under a unit step of force.

        .. math:: D(t) = D_g + D_f t + \sum_i D_i (1 - e^{-t/\lambda_i})

        where poles and residues of :math:`1 / (s K(s))` give :math:`\lambda_i, D_i` exactly
        (:func:`dashpot.solids.interconversion.creep_spectrum`).
        """
        return self._creep_spectrum.compliance(t)

    def ramp_hold_force(self, t: npt.ArrayLike, *, depth: float, ramp_time: float) -> FloatArray:
        r"""Force, N, under a ramp of `ramp_time` s to `depth` m that is then held (paper eqs. 1-5).

        .. math::

            F = A \left[k_\infty t + \sum_j b_j (1 - e^{-t/\tau_j}) + b\right], \quad t \le c;
            \qquad
            F = A \left[k_\infty c + \sum_j b_j e^{-(t-c)/\tau_j} (1 - e^{-c/\tau_j})\right],
            \quad t > c

        with A = depth / ramp_time and c = ramp_time. Equation (5) as printed holds
        exp(c/tau), which overflows for tau < c/709; this form cannot.
        """
        require_positive(ramp_time=ramp_time, unit=" s", expected="a time > 0")
        t = convert_numbers_to_si("t", t, "time")
        k, tau = self._arms()
        b = k * tau
        loading = np.clip(t, 0.0, ramp_time)[..., None]
        hold_time = np.clip(t - ramp_time, 0.0, None)[..., None]
        shape = (
            self.k_inf * loading[..., 0]
            + (-np.expm1(-loading / tau) * np.exp(-hold_time / tau)) @ b
        )
        moving = (t > 0) & (t <= ramp_time)
        return np.asarray(depth / ramp_time * (shape + self.b * moving))

    def force(self, t: npt.ArrayLike, displacement: npt.ArrayLike) -> FloatArray:
        r"""Force, N, under a displacement history, m, that is straight between its samples.

        Each arm obeys, exactly for a straight segment of length h,

        .. math:: q_i = e^{-h/\tau} q_{i-1} + k\,\frac{1 - e^{-h/\tau}}{h/\tau}\,(x_i - x_{i-1})

        (:func:`arm_response`). The part is assumed at rest at displacement zero before the first
        sample; a first sample that is not zero is a step at that instant. The parallel dashpot sees
        the slope of the segment that ends at a sample.

        Parameters
        ----------
        t : array_like, shape (n,)
            Strictly increasing times, s; any spacing.
        displacement : array_like, shape (n,)
            Displacement, m.
        """
        time = require_increasing("t", validate_samples("t", t))
        x = validate_samples("displacement", displacement)
        require_same_length(t=time, displacement=x)
        total = self.k_inf * x + _arms_carry(time, x, *self._arms())
        if self.b > 0 and len(time) > 1:
            slope = np.diff(x) / np.diff(time)
            total = total + self.b * np.concatenate(([0.0], slope))
        return np.asarray(total)

    def displacement(self, t: npt.ArrayLike, force: npt.ArrayLike) -> FloatArray:
        r"""Displacement, m, under a force history, N, that is straight between its samples.

        The inverse of :meth:`force`, from the creep spectrum, exactly:

        .. math:: x(t) = D_g F(t) + D_f \int_0^t F\,du
            + \sum_i D_i \int_0^t \left(1 - e^{-(t-u)/\lambda_i}\right) dF(u)

        Parameters
        ----------
        t : array_like, shape (n,)
            Strictly increasing times, s; any spacing.
        force : array_like, shape (n,)
            Force, N; a first sample that is not zero is a step at that instant.
        """
        time, F = (
            require_increasing("t", validate_samples("t", t)),
            validate_samples("force", force),
        )
        require_same_length(t=time, force=F)
        creep = self._creep_spectrum
        impulse = np.concatenate(([0.0], np.cumsum(0.5 * (F[1:] + F[:-1]) * np.diff(time))))
        d, lam = np.array(creep.d, dtype=float), np.array(creep.lam, dtype=float)
        elastic = (creep.glass + d.sum()) * F + creep.flow * impulse
        return np.asarray(elastic - _arms_carry(time, F, d, lam))

    @cached_property
    def _creep_spectrum(self) -> CreepSpectrum:
        from dashpot.solids.interconversion import creep_spectrum  # few need it

        return creep_spectrum(self.k_inf, self.k, self.tau, self.b)

    # -- frequency ----------------------------------------------------------------------------

    def stiffness_at(self, s: npt.ArrayLike) -> ComplexArray:
        r"""Stiffness on the Laplace plane, N/m: :math:`k_\infty + \sum_j k_j s\tau_j/(1+s\tau_j) + bs`.

        `s` in 1/s; at :math:`s = j\omega` it is the complex stiffness, at :math:`s = j\omega + a`
        what an exponentially windowed test sees.
        """  # noqa: E501
        s = to_complex(s)
        k, tau = self._arms()
        product = s[..., None] * tau
        return np.asarray(self.k_inf + (product / (1 + product)) @ k + self.b * s)

    def slope_at(self, s: npt.ArrayLike) -> ComplexArray:
        r"""Derivative of the stiffness by s, N s/m: :math:`b + \sum_j k_j \tau_j/(1+s\tau_j)^2`.

        Not finite at an arm's own pole.
        """
        s = to_complex(s)
        k, tau = self._arms()
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray((k * tau / (1 + s[..., None] * tau) ** 2).sum(axis=-1) + self.b)

    def bend_at(self, s: npt.ArrayLike) -> ComplexArray:
        r"""Second derivative by s, N s^2/m: :math:`-2 \sum_j k_j \tau_j^2/(1+s\tau_j)^3`."""
        k, tau = self._arms()
        denominator = 1 + to_complex(s)[..., None] * tau
        return np.asarray((-2 * k * tau**2 / denominator**3).sum(axis=-1))

    def arm_slopes(self, s: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        r"""Derivative of :math:`K` and of :math:`K'` at s by k_inf, every k and every ln tau.

        Shape (n, 1 + 2 N) each. With :math:`x = s\tau_j`, of an arm

        .. math:: \frac{x}{1+x},\; \frac{k_j x}{(1+x)^2}, \qquad
                  \frac{\tau_j}{(1+x)^2},\; \frac{k_j\tau_j(1-x)}{(1+x)^3}
        """
        s = to_complex(s)[:, None]
        k, tau = self._arms()
        x, denominator, values = s * tau, 1 + s * tau, np.ones_like(s)
        return (
            np.hstack((values, x / denominator, k * x / denominator**2)),
            np.hstack((0 * values, tau / denominator**2, k * tau * (1 - x) / denominator**3)),
        )

    # -- private ------------------------------------------------------------------------------

    def _arms(self) -> tuple[FloatArray, FloatArray]:
        return np.array(self.k, dtype=float), np.array(self.tau, dtype=float)


def decaying_sum(decay: FloatArray, increments: FloatArray) -> FloatArray:
    r"""Return :math:`u_i = a_i u_{i-1} + d_i` with :math:`u_{-1} = 0`, shape (n,) or (n, m).

    A scan in log2(n) passes: after the pass of stride s every u_i holds the sum over the last
    2s increments, each with its own product of decays. All products are of numbers <= 1, so
    nothing can overflow; the scan ends early once every product has underflowed.
    """
    product = np.array(decay, dtype=float)
    total = np.array(increments, dtype=float)
    stride = 1
    while stride < len(total) and product[stride:].max(initial=0.0) > 0.0:
        total[stride:] += product[stride:] * total[:-stride]
        product[stride:] *= product[:-stride]
        stride *= 2
    return total


def arm_response(time: FloatArray, displacement: FloatArray, tau: float | FloatArray) -> FloatArray:
    r"""Return the elongation of the spring of an arm, m: force = k times this, shape (n,).

    Of several arms, `tau` of shape (m,), they are columns.

    For displacement straight between samples, with h the sample interval and z = h/tau,

    .. math:: q_i = e^{-z} q_{i-1} + \frac{1 - e^{-z}}{z} (x_i - x_{i-1}), \qquad q_0 = x_0

    Boltzmann superposition integrated exactly, segment by segment; any sampling.
    """
    z = np.divide.outer(np.diff(time), tau)
    increments = np.concatenate((displacement[:1], np.diff(displacement)))
    decay, mean = np.zeros((2, len(time), *z.shape[1:]))
    decay[1:], mean[0], mean[1:] = np.exp(-z), 1.0, -np.expm1(-z) / z
    return decaying_sum(decay, (mean.T * increments).T)


def _arms_carry(time: FloatArray, x: FloatArray, k: FloatArray, tau: FloatArray) -> FloatArray:
    """Return the sum of k times each :func:`arm_response`; short ones many at once."""
    at_once = max(1, _CACHE_SIZE // max(len(time), 1))
    total = np.zeros(len(time))
    for first in range(0, len(tau), at_once):
        sample_slice = slice(first, first + at_once)
        total += arm_response(time, x, tau[sample_slice]) @ k[sample_slice]
    return total


# Solids in parallel.


@dataclass(frozen=True)
class Parallel(Solid, Serialisable):
    """Solids in parallel: one displacement, and the sum of their forces.

    Attributes
    ----------
    parts : tuple of Solid
        At least one; parts that are themselves in parallel are laid out side by side.
    """

    schema = "dashpot/parallel@1"

    parts: tuple[Solid, ...]

    def __post_init__(self) -> None:
        components = [
            component
            for solid in self.parts
            for component in (solid.parts if isinstance(solid, Parallel) else [solid])
        ]
        if not components or not all(isinstance(component, Solid) for component in components):
            raise DataError(
                f"parts = {self.parts!r}; expected at least one solid, and nothing else"
            )
        object.__setattr__(self, "parts", tuple(components))

    @property
    def k_inf(self) -> float:  # type: ignore[override]  # others keep it as a field
        """Equilibrium stiffness, N/m."""
        return sum(part.k_inf for part in self.parts)

    @property
    def k_0(self) -> float:  # type: ignore[override]
        """Instantaneous stiffness, N/m."""
        return sum(part.k_0 for part in self.parts)

    @property
    def maxwell(self) -> GeneralizedMaxwell:
        """The arms of all parts."""
        return reduce(add, (part.maxwell for part in self.parts))

    def stiffness_at(self, s: npt.ArrayLike) -> ComplexArray:
        """Return stiffness on the Laplace plane, N/m, `s` in 1/s: the sum of the parts."""
        return np.asarray(sum(part.stiffness_at(s) for part in self.parts))

    def relaxation(self, t: npt.ArrayLike) -> FloatArray:
        """Relaxation stiffness, N/m, for t > 0 in s: the sum of the parts."""
        return np.asarray(sum(part.relaxation(t) for part in self.parts))

    def force(self, t: npt.ArrayLike, displacement: npt.ArrayLike) -> FloatArray:
        """Force, N, under a displacement history, m, that is straight between its samples."""
        return np.asarray(sum(part.force(t, displacement) for part in self.parts))

    def __add__(self, other: object) -> Parallel:
        """Another solid in parallel."""
        return Parallel((self, other)) if isinstance(other, Solid) else NotImplemented

    __radd__ = __add__

    def __mul__(self, count: float) -> Parallel:
        """`count` equal solids in parallel; a fraction is a shorter piece of seal."""
        return Parallel(tuple(part * count for part in self.parts))

    __rmul__ = __mul__
