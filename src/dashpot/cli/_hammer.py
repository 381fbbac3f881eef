"""The options of an impact test."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import click

from dashpot.cli._shell import Quantity

if TYPE_CHECKING:
    from dashpot.io.options import ReadOptions
    from dashpot.vibration.frf import FRF
    from dashpot.vibration.records import ImpactTest

T = TypeVar("T")


@dataclass(frozen=True)
class Hammer:
    """How hits are found, judged, windowed and averaged."""

    estimator: str
    window: str
    combine: str
    accept: tuple[str, ...]
    reject: tuple[str, ...]
    record: float | None

    def frf(self, impact: ImpactTest, *, mass: float | None) -> FRF:
        """Return the FRF of an impact test under these choices."""
        from dashpot.vibration.impact import estimate_frf

        return estimate_frf(
            impact,
            estimator=self.estimator,
            window=self.window,
            combine=self.combine,
            accept=self.accept,
            reject=self.reject,
            record=self.record,
            mass=mass,
        )

    def read(
        self, paths: tuple[str, ...], *, options: ReadOptions, mass: float | None
    ) -> tuple[ImpactTest | None, FRF]:
        """Return the hits, if the files hold hits, and their FRF; or the FRF a file holds."""
        from dashpot.io.read import inspect_file, read_frf, read_impact

        if len(paths) == 1 and inspect_file(paths[0], options=options).kind == "frf":
            return None, read_frf(paths[0])
        impact = read_impact(list(paths), options=options)
        return impact, self.frf(impact, mass=mass)


def hammer(function: Callable[..., T]) -> Callable[..., T]:
    """Give a command the options of an impact test; it receives one ``hammer``."""

    @click.option(
        "--estimator",
        type=click.Choice(["H1", "H2", "Hv", "Hs"]),
        default="H1",
        show_default=True,
    )
    @click.option(
        "--window",
        default="none",
        show_default=True,
        help="none, exponential, or exponential:0.01 (what is left at the end).",
    )
    @click.option(
        "--combine",
        default="mean",
        show_default=True,
        help="mean, weighted (nulls rocking), or a channel's name.",
    )
    @click.option("--accept", multiple=True, metavar="HIT", help="Use this hit all the same.")
    @click.option("--reject", multiple=True, metavar="HIT", help="Leave this hit out.")
    @click.option("--record", type=Quantity("time"), help="Length of record after a hit.")
    @functools.wraps(function)
    def command(
        *,
        estimator: str,
        window: str,
        combine: str,
        accept: tuple[str, ...],
        reject: tuple[str, ...],
        record: float | None,
        **arguments: Any,
    ) -> T:
        chosen = Hammer(estimator, window, combine, accept, reject, record)
        return function(hammer=chosen, **arguments)

    return command
