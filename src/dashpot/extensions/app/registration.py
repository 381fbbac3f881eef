"""Registry rows of the local app."""

from dashpot.registry.row import Command, Extension

EXTENSION = Extension(
    "app",
    commands=(
        Command("app", "Learn", "The same work in a browser, on this computer only.", "dashpot.extensions.app.command", order=12),
    ),
)  # fmt: skip
