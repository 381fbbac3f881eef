"""Numbers that a test shows, each with its interval, and results that consist of them."""

from __future__ import annotations

from dataclasses import dataclass

from dashpot.base.checks import Checked
from dashpot.base.numbers import rounded


@dataclass(frozen=True)
class Found:
    """A number that a test shows, and its 95 % interval; from 0 where it is a bound alone.

    Attributes
    ----------
    name : str
    value, low, high : float
        SI.
    unit : str
    """

    name: str
    value: float
    low: float
    high: float
    unit: str

    @property
    def says(self) -> str:
        """In words, with its interval."""
        if self.low == 0:
            return f"{self.name} below {rounded(self.high)} {self.unit}".rstrip()
        own = f"{self.name} {rounded(self.value)} {self.unit}".rstrip()
        return f"{own}, 95 % {rounded(self.low)} to {rounded(self.high)}"


class Numbered(Checked):
    """A result of named numbers, `found`, that was asked whether it can be trusted."""

    found: tuple[Found, ...]

    def __getitem__(self, name: str) -> Found:
        """One of the numbers found, by its name."""
        return next(one for one in self.found if one.name == name)
