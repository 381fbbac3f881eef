"""Registry rows of the demonstration: the main job, its story, and the reproduced paper."""

from dashpot.registry.row import Command, Extension

EXTENSION = Extension(
    "paper",
    commands=(
        Command(
            "demo",
            "Learn",
            "The main job on a simulated seal; --files to try by hand.",
            "dashpot.extensions.paper.command",
            order=11,
        ),
    ),
)
