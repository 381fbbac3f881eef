"""Registry rows of the reproduced paper."""

from dashpot.registry.row import Extension

EXTENSION = Extension(
    "paper", handlers={"demo": {"paper": "dashpot.extensions.paper.demo_handler:run"}}
)
