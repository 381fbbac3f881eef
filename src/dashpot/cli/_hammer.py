"""The options of an impact test."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar

import click

from dashpot.cli._shell import Quantity

T = TypeVar("T")


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
    @click.option("--record", type=Quantity("time"), help="Length of a block around a hit.")
    @click.option("--pretrigger", type=Quantity("time"), help="Quiet in it before the hit.")
    @click.option(
        "--polarity",
        type=click.Choice(["+1", "-1"]),
        multiple=True,
        help="Sign of each accelerometer, in order; repeat for each.",
    )
    @functools.wraps(function)
    def command(
        *,
        estimator: str,
        window: str,
        combine: str,
        accept: tuple[str, ...],
        reject: tuple[str, ...],
        record: float | None,
        pretrigger: float | None,
        polarity: tuple[str, ...],
        **arguments: Any,
    ) -> T:
        from dashpot.workflow.job import HammerChoices

        chosen = HammerChoices(
            estimator=estimator,
            window=window,
            combine=combine,
            accept=accept,
            reject=reject,
            record=record,
            pretrigger=pretrigger,
            polarity=tuple(int(sign) for sign in polarity) or None,
        )
        return function(hammer=chosen, **arguments)

    return command
