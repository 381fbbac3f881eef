"""Registry rows of lots of files."""

from dashpot.registry.row import Command, Extension

EXTENSION = Extension(
    "batch",
    handlers={
        "compare files": {
            "lot": "dashpot.extensions.batch.comparison:compare_folders",
        },
        "compare": {
            "dashpot.extensions.batch.lot:Lot": "dashpot.extensions.batch.api:compare_lots",
        },
        "process capability": {
            "numpy:ndarray": "dashpot.extensions.batch.statistics.process_capability:capability",
        },
        "scatter of specimens": {
            "lot": "dashpot.extensions.batch.specimen_scatter:find_specimen_scatter",
        },
        "read": {
            "lot": "dashpot.extensions.batch.api:read_lot",
        },
        "text": {
            "dashpot.extensions.batch.comparison:LotComparison": "dashpot.text_output.results:render_summary",
        },
    },
    commands=(
        Command("batch", "Many tests", "A folder of tests to one table; --watch adds new files.", "dashpot.extensions.batch.command", order=6),
    ),
)  # fmt: skip
