"""The rows of recording an instrument."""

from dashpot.registry.row import Command, Extension

EXTENSION = Extension(
    "acquisition",
    commands=(
        Command("record", "Before the test", "An instrument to a file. It moves nothing.", "dashpot.extensions.acquisition.command", order=9),
    ),
)  # fmt: skip
