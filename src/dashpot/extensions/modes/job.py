"""Job of the app on the modes of several FRFs."""

from __future__ import annotations

from dashpot.base import dataclass
from dashpot.base.option_fields import OverBase, copy_option, make_nested_options, option
from dashpot.reading.read_options import ReadOptions
from dashpot.workflow.job import HammerChoices, Job


@dataclass(frozen=True)
class ModesJob:
    """Job of ``dashpot fit`` on modes: all files and options.

    The fields are the arguments of
    :func:`~dashpot.extensions.modes.measured_modes.modes_files`, and of
    :func:`~dashpot.extensions.modes.mass_series_files.modes_by_mass` where there are masses.
    """

    files: tuple[str, ...] = option((), metavar="FILE", argument=1)
    band: tuple[float, float] | None = copy_option(Job, "band")
    masses: tuple[float, ...] = option(
        (), "Mass on the seals in each FRF, in order.", unit="mass", multiple=True, flag="mass"
    )
    seals: float = copy_option(Job, "seals")
    motion: OverBase = copy_option(HammerChoices, "motion")
    polarity: tuple[int, ...] | None = copy_option(HammerChoices, "polarity")
    options: ReadOptions = make_nested_options(ReadOptions)
