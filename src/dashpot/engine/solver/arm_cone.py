"""The best sum of non-negative arms at given relaxation times, however many of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.engine.solver.descent import Stack
from dashpot.engine.solver.nnls import nonnegative


class Cone(NamedTuple):
    """A stack's columns at given relaxation times, free of the fixed columns, of unit length.

    Attributes
    ----------
    target : array, shape (n,)
        The data, as it is.
    fixed : array, shape (n, q)
    arms : array, shape (n, G, m)
        Group by group, as they are.
    columns : array, shape (n, G m)
        Swept and made unit; zero where the fixed columns explain one to seven digits.
    aim : array, shape (n,)
        The data, swept.
    """

    target: FloatArray
    fixed: FloatArray
    arms: FloatArray
    columns: FloatArray
    aim: FloatArray

    @classmethod
    def of(cls, stack: Stack, log_tau: FloatArray, *, loose: BoolArray) -> Cone:
        """At ln tau, shape (m,); `loose` fixed columns have a coefficient not held at zero."""
        target, phi, _ = stack.evaluate(log_tau, derivative=False)
        q = len(stack.names)
        arms = phi[:, q:]
        basis = np.linalg.qr(phi[:, :q][:, loose])[0]
        swept = arms - basis @ (basis.T @ arms)
        length, raw = (np.sqrt(np.vecdot(each.T, each.T)) for each in (swept, arms))
        columns = swept / np.where(length > 1e-7 * raw, length, np.inf)
        aim = target - basis @ (basis.T @ target)
        every = arms.reshape(len(target), len(stack.groups), -1)
        return cls(target, phi[:, :q], every, columns, aim)

    def best(self) -> tuple[FloatArray, float]:
        """Weights of the unit columns, shape (G m,), and the sum of squares that they leave."""
        x = nonnegative(self.columns.T @ self.columns, self.columns.T @ self.aim)
        rest = self.aim - self.columns @ x
        return x, float(rest @ rest)
