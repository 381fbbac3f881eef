"""The main job as a value: which files, read and treated how."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from dashpot.base.documents import Documented
from dashpot.base.errors import DataError
from dashpot.base.options import option
from dashpot.io.options import ReadOptions
from dashpot.records.machine import Machine
from dashpot.records.specimen import Specimen


def signs(given: Sequence[str]) -> tuple[int, ...] | None:
    """Return signs typed by a user as numbers, None if there are none."""
    return tuple(int(sign) for sign in given) or None


def known_of_a_test(machine: Machine | None, *, tests: int, add: str) -> None:
    """Refuse what is said of a machine where no relaxation test was made on it.

    Raises
    ------
    DataError
        If the machine is described and `tests` is 0; `add` names what is missing.
    """
    if machine is not None and machine != Machine() and not tests:
        raise DataError(
            "--sync, --drift, --compliance and --force-filter describe the machine of a "
            f"relaxation test, and there is none here: add {add}, or leave them out"
        )


@dataclass(frozen=True)
class HammerChoices:
    """How hits are found, judged, windowed and averaged.

    The fields are the arguments of :func:`~dashpot.vibration.impact.frf_estimation.estimate_frf`,
    and how the mass over a base that moves was measured.
    """

    estimator: str = option("H1", choices=("H1", "H2", "Hv", "Hs"))
    window: str = option(
        "none", "none, exponential, or exponential:0.01 (what is left at the end)."
    )
    combine: str = option("mean", "mean, weighted (nulls rocking), or a channel's name.")
    accept: tuple[str, ...] = option((), "Use this hit all the same.", metavar="HIT", multiple=True)
    reject: tuple[str, ...] = option((), "Leave this hit out.", metavar="HIT", multiple=True)
    record: float | None = option(None, "Length of a block around a hit.", unit="time")
    pretrigger: float | None = option(None, "Quiet in it before the hit.", unit="time")
    polarity: tuple[int, ...] | None = option(
        None,
        "Sign of each accelerometer, in order; repeat for each.",
        choices=("+1", "-1"),
        multiple=True,
        parse=signs,
    )
    motion: str = option(
        "absolute",
        "Of the mass over a base that moves: absolute, or relative to the base.",
        choices=("absolute", "relative"),
    )


@dataclass(frozen=True)
class Cuts:
    """Where a relaxation test is cut by hand, s on its own clock; found in the record where None.

    The fields are arguments of :func:`~dashpot.preparation.prepare.prepare`.
    """

    onset: float | None = option(None, "First contact on the record's clock.", unit="time")
    ramp_end: float | None = option(None, "End of the ramp on that clock.", unit="time")
    hold_end: float | None = option(None, "End of the hold on that clock.", unit="time")

    def refuse_several(self, tests: int) -> None:
        """Refuse cuts of several tests.

        Raises
        ------
        DataError
            If anything is cut by hand and there is not one test.
        """
        if self != Cuts() and tests != 1:
            raise DataError(
                "--onset, --ramp-end and --hold-end cut one relaxation test, and there are "
                f"{tests} here: leave them out, or fit that test alone"
            )


@dataclass(frozen=True)
class Job(Documented):
    """Everything that decides the result of ``dashpot report``.

    Attributes
    ----------
    relaxation : str
        File of the relaxation test.
    further : tuple of str
        Files of further relaxation tests of the same seal, at other temperatures.
    temperatures : tuple of float
        Of the relaxation tests, K: one for all of them, or one for each, in their order.
    impact_temperature : float or None
        Of the seals under the hammer, K; None for that of the solid of the relaxation tests.
    impact : tuple of str
        Files of hits, or one file with an FRF.
    mass, seal_mass : float or None
        Of the block and of one seal, kg.
    seals : float
    arms : int or "auto"
    method : "full" or "hold"
    law : "auto", "linear" or "nonlinear"
    family : "maxwell", "fractional" or "auto"
    cuts : Cuts
        Of the relaxation test, by hand.
    band : (float, float) or None
        Lines compared, Hz.
    filter : str or None
    joint : bool
    compression : float or None
        Of the seals under the mass, m; None for that of its weight.
    specimen : Specimen
    machine : Machine
        What is known of the machine of the relaxation test.
    reading, reading_impact : ReadOptions
        What the user said of the relaxation file and of the impact files.
    hammer : HammerChoices
    title : str
        Of the report; by default the specimen, or the file.
    logo : str or None
        File of an image for its head.
    """

    schema = "dashpot/job@1"

    relaxation: str
    impact: tuple[str, ...] = ()
    mass: float | None = None
    seal_mass: float | None = None
    seals: float = 1.0
    arms: int | Literal["auto"] = "auto"
    method: Literal["full", "hold"] = "full"
    law: Literal["auto", "linear", "nonlinear"] = "auto"
    family: Literal["maxwell", "fractional", "auto"] = "maxwell"
    cuts: Cuts = field(default_factory=Cuts)
    band: tuple[float, float] | None = None
    filter: str | None = None
    joint: bool = True
    compression: float | None = None
    specimen: Specimen = field(default_factory=Specimen)
    machine: Machine = field(default_factory=Machine)
    reading: ReadOptions = field(default_factory=ReadOptions)
    reading_impact: ReadOptions = field(default_factory=ReadOptions)
    hammer: HammerChoices = field(default_factory=HammerChoices)
    title: str = ""
    logo: str | None = None
    further: tuple[str, ...] = ()
    temperatures: tuple[float, ...] = ()
    impact_temperature: float | None = None
