"""Registry rows of preload maps."""

from dashpot.registry.row import Command, Extension, KindOfTest

_MAP = "dashpot.extensions.preload_map.preload_map:PreloadMap"

EXTENSION = Extension(
    "preload_map",
    file_kinds={
        "preload-map": (
            "storage and loss at several compressions", "use dashpot map",
            ("frequency", "storage", "loss", "temperature"),
        ),
    },
    kinds=(
        KindOfTest(
            "preload-map", "dashpot.extensions.preload_map.read:read_preload_table",
            classes={
                "dashpot.extensions.preload_map.preload_sweep:PreloadTable": "",
                _MAP: "dashpot.extensions.preload_map.figure:draw_preload_map",
            },
            pages={_MAP: "dashpot.extensions.preload_map.page:page"},
            checks="dashpot.extensions.preload_map.checks",
            examples="dashpot.extensions.preload_map.examples:EXAMPLES", order=22,
        ),
    ),
    handlers={
        "propose roles": {"preload-map": "dashpot.extensions.preload_map.read:propose_settings"},
        "table rule": {"preload-map": "dashpot.extensions.preload_map.table_rule:has_several_compressions"},
        "text": {_MAP: "dashpot.extensions.preload_map.text:format_preload_map"},
        "plot": {"preload_map": "dashpot.extensions.preload_map.figure:draw_preload_map"},
    },
    commands=(
        Command(
            "map", "Work", "Stiffness over frequency, amplitude and compression.",
            "dashpot.extensions.preload_map.command", order=6,
        ),
    ),
)  # fmt: skip
