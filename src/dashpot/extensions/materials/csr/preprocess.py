"""Preparation of counterforce records: the readings of specimens in ovens, in one lot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.base.errors import DataError
from dashpot.extensions.materials.csr.datamodel import CSRTest, Oven
from dashpot.extensions.materials.csr.law import F0_TIME
from dashpot.numerics.inference.covariance_estimate import Estimate

EARLIEST = 600.0
"""Earliest time of F0 after the compression, s: before, half of its decay is to come."""
ONE_OVEN = 2.0
"""Temperature difference within which specimens are in one oven, K."""
_MIN_COUNT = 3
"""Least number of readings of a specimen."""


class Readings(NamedTuple):
    """Readings of all specimens, concatenated.

    Attributes
    ----------
    time, force : array, shape (n,)
        s, and over the first force of the specimen.
    specimen_number, oven : array, shape (n,)
        The number of each.
    temperature : array, shape (ovens,)
        K, rising.
    force_scale : array, shape (n,)
        Mean of the initial forces over the initial force of the specimen.
    """

    time: FloatArray
    force: FloatArray
    specimen_number: IndexArray
    oven: IndexArray
    temperature: FloatArray
    force_scale: FloatArray

    @property
    def specimens(self) -> int:
        """Number of specimens."""
        return int(self.specimen_number[-1]) + 1

    @property
    def last_reading_time(self) -> FloatArray:
        """Time of the last reading in every oven, s."""
        return np.array([self.time[self.oven == k].max() for k in range(len(self.temperature))])

    def ovens(self, estimate: Estimate) -> tuple[Oven, ...]:
        """Return every oven with its rate and its readings over the fitted F0 of each specimen."""
        scale, ovens = estimate.optimum.beta[self.specimen_number], []
        for k, kelvin in enumerate(self.temperature.tolist()):
            value, longest = self.oven == k, float(self.last_reading_time[k])
            ovens.append(
                Oven(
                    kelvin, len(np.unique(self.specimen_number[value])),
                    float(estimate.optimum.theta[1 + k]) / longest,
                    float(estimate.standard_error[1 + k]) / longest,
                    self.time[value], self.force[value] / scale[value],
                )
            )  # fmt: skip
        return tuple(ovens)


def collect_readings(tests: Sequence[CSRTest]) -> Readings:
    """Return the readings of all specimens of some records, by oven.

    Raises
    ------
    DataError
        If methods A and B are mixed, or a specimen was measured too soon, too seldom, or in two
        ovens.
    """
    methods = set("".join(test.method for test in tests))
    if len(methods) > 1:
        raise DataError(
            "Method A reads the force in the oven, method B at room temperature, and these records "
            "are of both. Fit each method by itself"
        )
    kelvin = np.concatenate([test.temperature for test in tests])
    order = np.argsort(kelvin, kind="stable")
    oven = np.empty(len(kelvin), dtype=np.intp)
    oven[order] = np.cumsum(np.diff(kelvin[order], prepend=kelvin[order][0]) > ONE_OVEN)
    lot = np.repeat(np.arange(len(tests)), [len(test.time) for test in tests])
    cells = np.stack((oven, lot, np.concatenate([test.specimen_number for test in tests])))
    _, specimen_number = np.unique(cells, axis=1, return_inverse=True)
    time = np.concatenate([test.time for test in tests])
    force = np.concatenate([test.force for test in tests])
    rows = np.lexsort((time, specimen_number.ravel()))
    time, force, specimen_number, oven = (
        time[rows],
        force[rows],
        specimen_number.ravel()[rows],
        oven[rows],
    )
    first = np.flatnonzero(np.diff(specimen_number, prepend=-1))
    _refuse(tests, time, cells[:, rows], first)
    return Readings(
        time, force / force[first][specimen_number], specimen_number, oven,
        np.array([kelvin[rows][oven == k].mean() for k in range(int(oven[-1]) + 1)]),
        force[first].mean() / force[first][specimen_number],
    )  # fmt: skip


def _refuse(
    tests: Sequence[CSRTest],
    time: FloatArray,
    cells: IndexArray,
    first: IndexArray,
) -> None:
    """Refuse specimens with too few readings, or with one too soon after their compression."""
    for begins, count in zip(first, np.diff((*first, len(time))), strict=True):
        _, lot, number = cells[:, begins].tolist()
        source = tests[lot].source
        name = f"{source.file}, specimen {number}" if source else f"specimen {number}"
        if count < _MIN_COUNT:
            raise DataError(
                f"{name} was read {count} times in one oven; at least {_MIN_COUNT} readings show "
                "how it ages. Give each specimen its own number, or leave this one out"
            )
        if time[begins] < EARLIEST:
            raise DataError(
                f"{name} was first read {time[begins] / 60:.3g} min after its compression. F0 is "
                f"the force at {F0_TIME / 60:.0f} min, for sooner it still falls fast. Leave out "
                f"what was read before {EARLIEST / 60:.0f} min, and write 30 min as 0.5 h, not as 0"
            )
