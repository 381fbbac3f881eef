"""Options of ``dashpot predict`` on a door."""

from __future__ import annotations

from dashpot.cli._command import CommandOption, group, mark_advanced, opt
from dashpot.cli._param_types import File, WithUnit

_DOOR = "door"


def list_groups() -> list[list[CommandOption]]:
    """Return the options of a door, under their title."""
    return [
        group(
            "Door",
            opt(
                "--close",
                "speed",
                type=WithUnit("velocity"),
                metavar="SPEED",
                kinds=_DOOR,
                help="Closing speed: energy, least closing speed.",
            ),
            opt("--leak", kinds=_DOOR, help="Car speed that lifts the seal: new, cold, aged."),
            mark_advanced(
                opt(
                    "--lot",
                    type=File(),
                    metavar="FOLDER",
                    kinds=_DOOR,
                    help="Batch of its seals: doors of many cars.",
                ),
                opt(
                    "--limit",
                    "limits",
                    type=str,
                    multiple=True,
                    metavar="LIMIT",
                    kinds=_DOOR,
                    help="'mode 1 >= 30Hz', 'closing <= 1.2m/s': share beyond.",
                ),
                opt(
                    "--spread",
                    type=WithUnit("strain"),
                    metavar="PART",
                    kinds=_DOOR,
                    help="Or the seals scatter by this, e.g. 4%.",
                ),
                opt("--modes", "every", kinds=_DOOR, help="Share of every part in every mode."),
            ),
        )
    ]
