"""Registry rows of the seal in a door."""

from dashpot.registry.row import Extension, KindOfTest

EXTENSION = Extension(
    "door",
    kinds=(
            KindOfTest(
                "seal-line", place="part",
                examples="dashpot.extensions.door.examples:EXAMPLES", order=19,
        ),
            KindOfTest("free-modes", "dashpot.extensions.door.read_modes:read_modes", place="part", order=20),
    ),
    handlers={
        "stations": {"door": "dashpot.extensions.door.export_handler:find_line_stations"},
        "option groups": {"predict": "dashpot.extensions.door.command_options:list_groups"},
        "predict file": {
            "door": "dashpot.extensions.door.predict_handler:run",
        },
        "predict": {
            "dashpot.extensions.door.door_model:Door": "dashpot.extensions.door.api:predict_door",
        },
        "read": {
            "door": "dashpot.extensions.door.read:read_door",
        },
        "file row": {".toml": "dashpot.extensions.door.app_page:describe_file"},
        "predict open files": {"door": "dashpot.extensions.door.app_page:predict_open_files"},
        "figure cards": {"dashpot.extensions.door.result:DoorResult": "dashpot.extensions.door.app_page:list_cards"},
        "page": {"dashpot.extensions.door.result:DoorResult": "dashpot.extensions.door.app_page:page"},
        "mounts": {"dashpot.extensions.door.seal_line:SealLine": "dashpot.extensions.door.mounts:line_mounts"},
        "text": {
            "dashpot.extensions.door.closing_result:ClosingResult": "dashpot.extensions.door.closing_text:render_closing",
            "dashpot.extensions.door.result:DoorResult": "dashpot.extensions.door.text:door",
        },
        "html": {
            "dashpot.extensions.door.result:DoorResult": "dashpot.extensions.door.page:door_html",
            "dashpot.extensions.door.closing_result:ClosingResult": "dashpot.extensions.door.page:door_html",
        },
        "plot": {
            "closing": "dashpot.extensions.door.closing_figure:closing",
            "door": "dashpot.extensions.door.figure:door",
        },
        "figure": {
            "dashpot.extensions.door.result:DoorResult": "dashpot.extensions.door.figure:door",
            "dashpot.extensions.door.closing_result:ClosingResult": "dashpot.extensions.door.closing_figure:closing",
        },
    },
)  # fmt: skip
