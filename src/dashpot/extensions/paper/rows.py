"""The rows of the paper, reproduced."""

from dashpot.registry.row import Extension

EXTENSION = Extension(
    "paper", handlers={"demo": {"paper": "dashpot.extensions.paper.demo_handler:run"}}
)
