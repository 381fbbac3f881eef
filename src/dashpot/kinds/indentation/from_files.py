"""From a file to what an indenter's contact says of a surface."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from dashpot.base.checks import Check, Verdict
from dashpot.base.choices import ImpactLawAsked
from dashpot.base.documents import Documented
from dashpot.base.errors import DataError, ReadError
from dashpot.io.options import ReadOptions
from dashpot.io.source import about
from dashpot.kinds.indentation.fit import fit_indentation
from dashpot.kinds.indentation.indenter import Indenter
from dashpot.kinds.indentation.read import read_indentation
from dashpot.kinds.indentation.record import IndentationFit


@dataclass(frozen=True)
class Indentation(Documented):
    """What ``dashpot fit`` found.

    Attributes
    ----------
    fit : IndentationFit
    """

    schema = "dashpot/indentation@1"
    keys = (
        "fit.law", "fit.of", "fit.indenter", "*values", "intervals", "units", "orders", "fit.touch",
        "fit.noise", "fit.residual", "verdict", "checks", "fit.source",
    )  # fmt: skip

    fit: IndentationFit

    @property
    def checks(self) -> tuple[Check, ...]:
        """Of the contact."""
        return self.fit.checks

    @property
    def verdict(self) -> Verdict:
        """What to make of it."""
        return self.fit.verdict

    @property
    def values(self) -> dict[str, float]:
        """What was found, by its names."""
        return {one.name: one.value for one in self.fit.found}

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """95 %, by the same names."""
        return {one.name: (one.low, one.high) for one in self.fit.found}

    @property
    def units(self) -> dict[str, str]:
        """By the same names."""
        return {one.name: one.unit for one in self.fit.found}

    @property
    def orders(self) -> dict[str, float]:
        """BIC of each law that was tried."""
        return dict(self.fit.orders)


def indent_file(
    path: str | Path,
    *,
    indenter: Indenter,
    law: ImpactLawAsked = "auto",
    options: ReadOptions | None = None,
) -> Indentation:
    """Find what the largest contact in a file says of the surface.

    Parameters
    ----------
    path : path
    indenter : Indenter
        With its mass.
    law : str
        As :func:`~dashpot.kinds.indentation.fit.fit_indentation` takes it.
    options : ReadOptions, optional
        What the user said of the file.
    """
    if indenter.mass is None:
        raise ReadError(
            "an indenter's mass makes forces of its motion; give it, for example --mass 5g"
        )
    test = read_indentation(path, indenter=indenter, options=options)
    with about(Path(path).name):
        try:
            return Indentation(fit_indentation(test, law=law))
        except DataError as error:
            raise ReadError(str(error)) from None
