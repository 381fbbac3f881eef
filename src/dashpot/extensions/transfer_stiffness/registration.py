"""Registry rows of the transfer stiffness of a mount."""

from dashpot.registry.row import Command, Extension

_SHEET = "dashpot.extensions.transfer_stiffness.stiffness_sheet:TransferStiffness"

EXTENSION = Extension(
    "transfer_stiffness",
    handlers={
        "text": {_SHEET: "dashpot.extensions.transfer_stiffness.text:render_transfer_stiffness"},
        "figure": {_SHEET: "dashpot.extensions.transfer_stiffness.figure:draw_transfer_stiffness"},
        "plot": {
            "transfer_stiffness": "dashpot.extensions.transfer_stiffness.figure:draw_transfer_stiffness",
        },
        "page": {_SHEET: "dashpot.extensions.transfer_stiffness.page:page"},
        "document": {"dashpot/transfer-stiffness@1": _SHEET},
    },
    commands=(
        Command(
            "stiffness", "Work", "Transfer stiffness of a mount, as defined in ISO 10846.",
            "dashpot.extensions.transfer_stiffness.command", order=5,
        ),
    ),
)  # fmt: skip
