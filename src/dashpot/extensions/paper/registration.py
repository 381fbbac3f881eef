"""Registry rows of the demonstration: the main job, its story, and the reproduced paper."""

from dashpot.registry.row import Command, Extension

EXTENSION = Extension(
    "paper",
    commands=(
        Command(
            "demo",
            "Learn",
            "The main workflow, simulated; --files writes its two files.",
            "dashpot.extensions.paper.command",
            order=11,
        ),
    ),
)
