"""Parametrisation of the identified solid: Maxwell arms or one fractional element.

A parametrisation writes a solid as a vector and back, gives the force of a relaxation test and its
derivative by that vector, and says what the vector's covariance means in physical terms. Mass,
gain, delay and a parallel dashpot stand beside it
(``identification/likelihood``).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import ClassVar, NamedTuple, TypeAlias

import numpy as np

from dashpot.base import dataclass, field, replace
from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.parameter_estimate import ELEMENT_PARAMETERS, parameter_names
from dashpot.fitting.fractional_model.checks import fractional_slope_determined
from dashpot.fitting.fractional_model.family_selection import (
    ALPHA_RANGE,
    GRID_MARGIN,
    GRID_STEP,
    TAU_MARGIN,
)
from dashpot.fitting.marginal_relaxation import RelaxationData, RelaxationRows
from dashpot.numerics.inference.model_order import is_well_determined
from dashpot.solids.fractional import FractionalZener, compute_arm_weights
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

# Smallest stiffness in the logarithmic parametrisation, relative to k_0.
ZERO_STIFFNESS_SHARE = 1e-9
# share of the stiffness below which an arm or an element is dropped
MIN_STIFFNESS_SHARE = 1e-6
_AT_EDGE = 1e-3


class RelaxationResiduals(NamedTuple):
    """Residuals of a relaxation test as rows of unit noise, with their derivative.

    Attributes
    ----------
    residual : array, shape (n,)
        Residual of the solid without a parallel dashpot.
    jacobian : array, shape (n, size)
        By the parametrisation's own numbers.
    dashpot : array, shape (n,)
        The column of a parallel dashpot.
    """

    residual: FloatArray
    jacobian: FloatArray
    dashpot: FloatArray


@dataclass(frozen=True)
class Arms:
    """Maxwell arms as free numbers: ln k_inf, ln k_j, ln tau_j."""

    count: int = 0

    @property
    def size(self) -> int:
        """Number of parameters."""
        return 1 + 2 * self.count

    def pack(self, solid: Solid) -> FloatArray:
        """Return the numbers of a solid."""
        model = solid.maxwell
        k_inf = max(model.k_inf, ZERO_STIFFNESS_SHARE * max(model.k_0, 1e-300))
        return np.log([k_inf, *model.k, *model.tau])

    def unpack(self, numbers: FloatArray, b: float) -> GeneralizedMaxwell:
        """Return the solid of the numbers, beside a dashpot b."""
        solid, N = np.exp(numbers), self.count
        return GeneralizedMaxwell(
            float(solid[0]), tuple(solid[1 : 1 + N]), tuple(solid[1 + N :]), b
        )

    def residuals(self, relaxation: RelaxationData, numbers: FloatArray) -> RelaxationResiduals:
        """Return what it makes of a relaxation test."""
        N = self.count
        rows = relaxation.rows(numbers[1 + N :])
        k_inf, k = np.exp(numbers[0]), np.exp(numbers[1 : 1 + N])
        columns = (k_inf * rows.spring[:, None], rows.arms * k, rows.slopes * k)
        force = columns[0][:, 0] + rows.arms @ k
        return RelaxationResiduals(
            force - rows.target, np.concatenate(columns, axis=1), rows.dashpot
        )

    def ends(self, log_tau: tuple[float, float]) -> FloatArray:
        """Return the limits of the last parameters, those of relaxation times."""
        return np.tile(log_tau, (self.count, 1))

    def physical(self, numbers: FloatArray) -> tuple[tuple[str, ...], FloatArray, FloatArray]:
        """Return names and values of a fit's parameters, and their derivative by the numbers."""
        N = self.count
        order = np.argsort(numbers[1 + N :], kind="stable")
        rows = np.array([0, *(1 + order), *(1 + N + order)])
        values = np.concatenate((np.exp(numbers[: 1 + N]), numbers[1 + N :]))[rows]
        scale = np.concatenate((values[: 1 + N], np.ones(N)))
        return parameter_names(N), values, scale[:, None] * np.eye(self.size)[rows]

    def arm_gradient(self, numbers: FloatArray) -> FloatArray:
        """Derivative of k_inf, every k and every ln tau of the solid's arms by the numbers."""
        return self.physical(numbers)[2]

    def differentiate_stiffness(self, numbers: FloatArray, s: ComplexArray) -> ComplexArray:
        """Return derivative of the stiffness by the numbers, shape (n, size)."""
        return differentiate_poles(self, numbers, s)[0]

    def extract_earlier_values(self, before: Fit) -> tuple[dict[str, float], list[int]]:
        """Return the values of an earlier fit, by name, and their indices."""
        prior_arms = Arms(before.model.arms)
        names, values, _ = prior_arms.physical(prior_arms.pack(before.model))
        # faster arms than the earlier fit has are new: it says nothing about them
        new_order, count = self.count - prior_arms.count, self.count
        indices = [
            0,
            *range(1 + new_order, 1 + count),
            *range(1 + count + new_order, 1 + 2 * count),
        ]
        return dict(zip(names, values.tolist(), strict=True)), indices

    def is_identified(self, error: FloatArray) -> bool:
        """Return whether the standard errors of all parameters are small enough."""
        return bool(self.find_identified_arms(error).all())

    def find_identified_arms(self, error: FloatArray) -> BoolArray:
        """Return which arms these errors identify, in the order of the parameters."""
        N = self.count
        return is_well_determined(np.ones(N), error[1 : 1 + N], error[1 + N : 1 + 2 * N])

    def log_tau(self, numbers: FloatArray) -> FloatArray:
        """Logarithms of the relaxation times, s, in that order."""
        return numbers[1 + self.count : 1 + 2 * self.count]

    def is_complete(self, solid: Solid) -> bool:
        """Return whether no part of the solid has left it."""
        return all(k > MIN_STIFFNESS_SHARE * solid.k_0 for k in solid.maxwell.k)

    def format_model_order(self) -> str:
        """Return what is sought, in words."""
        return f"{self.count} arm{'s' * (self.count != 1)}"


@dataclass(frozen=True, eq=False)
class FractionalElement:
    """Fractional element as free numbers: ln k_inf, ln of its own k, ln tau, alpha.

    At fixed relaxation times its column is a weighted sum of columns of arms, so each relaxation
    test is asked once (:mod:`dashpot.fitting.fractional_model.family_selection`).

    Attributes
    ----------
    grids : mapping
        Ln tau and rows of each test.
    """

    size: ClassVar[int] = 4
    grids: Mapping[RelaxationData, tuple[FloatArray, RelaxationRows]] = field(
        default_factory=lambda: MappingProxyType({})
    )

    @classmethod
    def from_relaxations(cls, relaxations: Sequence[RelaxationData]) -> FractionalElement:
        """Return an element beside these tests."""
        grids = {}
        for relaxation in relaxations:
            low, high = np.log(relaxation.window)
            count = int(np.ceil((high - low + 2 * GRID_MARGIN) / GRID_STEP))
            log_tau = low - GRID_MARGIN + GRID_STEP * np.arange(count + 1.0)
            grids[relaxation] = log_tau, relaxation.rows(log_tau, with_slopes=False)
        return cls(MappingProxyType(grids))

    def pack(self, solid: Solid) -> FloatArray:
        """Return the numbers of a solid."""
        assert isinstance(solid, FractionalZener)  # noqa: S101  # nothing else is an element
        k_inf, value = solid.k_inf, solid.k_0 - solid.k_inf
        springs = [
            max(number, ZERO_STIFFNESS_SHARE * max(solid.k_0, 1e-300)) for number in (k_inf, value)
        ]
        return np.array([*np.log(springs), np.log(solid.tau), solid.alpha])

    def unpack(self, numbers: FloatArray, b: float) -> FractionalZener:
        """Return the solid of the numbers, beside a dashpot b."""
        k_inf, value, tau = np.exp(numbers[:3]).tolist()
        return FractionalZener(k_inf + value, k_inf, tau, float(numbers[3]), b)

    def residuals(self, relaxation: RelaxationData, numbers: FloatArray) -> RelaxationResiduals:
        """Return what it makes of a relaxation test."""
        log_tau, rows = self.grids[relaxation]
        k_inf, value = np.exp(numbers[:2])
        weights = compute_arm_weights(log_tau - numbers[2], float(numbers[3]))
        column, by_tau, by_alpha = (value * (rows.arms @ weight) for weight in weights)
        spring = k_inf * rows.spring
        slopes = np.column_stack((spring, column, by_tau, by_alpha))
        return RelaxationResiduals(spring + column - rows.target, slopes, rows.dashpot)

    def ends(self, log_tau: tuple[float, float]) -> FloatArray:
        """Return the limits of ln tau and alpha."""
        return np.array([(log_tau[0] - TAU_MARGIN, log_tau[1] + TAU_MARGIN), ALPHA_RANGE])

    def physical(self, numbers: FloatArray) -> tuple[tuple[str, ...], FloatArray, FloatArray]:
        """Names, values and derivatives of a fit's parameters."""
        k_inf, value = np.exp(numbers[:2])
        gradient = np.eye(4)
        gradient[:2, :2] = [[k_inf, 0.0], [k_inf, value]]
        return ELEMENT_PARAMETERS, np.array([k_inf, k_inf + value, *numbers[2:]]), gradient

    def arm_gradient(self, numbers: FloatArray) -> FloatArray:
        """Return the gradient of the arms that approximate the element."""
        return self.unpack(numbers, 0.0).arm_gradient() @ self.physical(numbers)[2]

    def differentiate_stiffness(self, numbers: FloatArray, s: ComplexArray) -> ComplexArray:
        """Return derivative of its own stiffness."""
        (k_inf, value, tau), alpha = np.exp(numbers[:3]), numbers[3]
        power = (s * tau) ** alpha
        column = value * (1 - 1 / (1 + power))
        rotated_column = column / (1 + power)
        spring = np.full(len(s), k_inf)
        return np.column_stack(
            (spring, column, alpha * rotated_column, np.log(s * tau) * rotated_column)
        )

    def extract_earlier_values(self, earlier_fit: Fit) -> tuple[dict[str, float], list[int]]:
        """Return what an earlier fit found."""
        values = self.physical(self.pack(earlier_fit.solid))[1]
        return dict(zip(ELEMENT_PARAMETERS, values.tolist(), strict=True)), [*range(4)]

    def is_identified(self, error: FloatArray) -> bool:
        """Return whether no number is unknown."""
        return not fractional_slope_determined(float(error[3]), edge=False).failed

    def is_complete(self, solid: Solid) -> bool:
        """Return whether no part has left it."""
        return solid.k_0 - solid.k_inf > MIN_STIFFNESS_SHARE * solid.k_0

    def format_model_order(self) -> str:
        """Return the model order in words."""
        return "a fractional element"


Parametrisation: TypeAlias = Arms | FractionalElement
"""Representation of a solid by `size` free numbers."""


def differentiate_poles(
    parametrisation: Parametrisation, numbers: FloatArray, p: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """Derivative of the stiffness of its arms, and of its slope, by the numbers: (n, size)."""
    gradient = parametrisation.arm_gradient(numbers)
    by_arms, slope_by_arms = parametrisation.unpack(numbers, 0.0).maxwell.arm_slopes(p)
    return by_arms @ gradient, slope_by_arms @ gradient


def is_at_edge(
    parametrisation: Parametrisation, numbers: FloatArray, log_tau: tuple[float, float]
) -> bool:
    """Return whether a relaxation time or a slope is at an end of its range."""
    low, high = (limits := parametrisation.ends(log_tau)).T
    end_numbers = numbers[len(numbers) - len(limits) :]
    return bool(np.any((end_numbers < low + _AT_EDGE) | (end_numbers > high - _AT_EDGE)))


def on_another_spring(solid: Solid, times: float) -> Solid:
    """Return the solid with k_inf multiplied by a factor."""
    if isinstance(solid, FractionalZener):
        k_inf = times * solid.k_inf
        return replace(solid, k_inf=k_inf, k_0=solid.k_0 - solid.k_inf + k_inf)
    return replace(solid.maxwell, k_inf=times * solid.k_inf)


def with_dashpot(solid: Solid, b: float) -> Solid:
    """Return a solid beside a dashpot of b in all, N s/m."""
    return replace(solid if isinstance(solid, FractionalZener) else solid.maxwell, b=b)
