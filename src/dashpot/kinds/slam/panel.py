"""What the app asks of slams, and what they find by what was answered."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.asks import Answers, Ask
from dashpot.io.options import ReadOptions
from dashpot.kinds.slam.from_files import slam_files
from dashpot.kinds.slam.record import SlamFit

ASKS = (
    Ask("mass", "Moving mass", "g", "--mass"),
    Ask("slam", "Speed or fall", "", "--slam", form="words"),
)


def answered(files: Sequence[str], said: Answers, options: ReadOptions) -> SlamFit:
    """What the slams say of the piece."""
    mass = said.number("mass", "mass")
    return slam_files(files, mass=mass, slam=said.of("slam").split(), options=options)
