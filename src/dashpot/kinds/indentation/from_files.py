"""From a file to what an indenter's contact says of a surface."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from dashpot.base.checks import Check, Verdict
from dashpot.base.errors import DataError, ReadError
from dashpot.io.options import ReadOptions
from dashpot.io.source import about
from dashpot.kinds.indentation.fit import LawName, fit_indentation
from dashpot.kinds.indentation.read import read_indentation
from dashpot.kinds.indentation.record import IndentationFit, Indenter


@dataclass(frozen=True)
class Indentation:
    """What ``dashpot indent`` found.

    Attributes
    ----------
    fit : IndentationFit
    """

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
    def document(self) -> dict[str, Any]:
        """``dashpot/indentation@1``."""
        fit = self.fit
        return {
            "schema": "dashpot/indentation@1",
            "law": fit.law,
            "of": fit.of,
            "indenter": asdict(fit.indenter),
            **{one.name: one.value for one in fit.found},
            "intervals": {one.name: [one.low, one.high] for one in fit.found},
            "units": {one.name: one.unit for one in fit.found},
            "orders": dict(fit.orders),
            "touch": fit.touch,
            "noise": fit.noise,
            "residual": fit.residual,
            "verdict": self.verdict.document,
            "checks": [check.document for check in fit.checks],
            "source": None if fit.source is None else asdict(fit.source),
        }


def indent_file(
    path: str | Path,
    *,
    indenter: Indenter,
    law: LawName = "auto",
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
