"""Registry rows of systems on seals: at a level, over a random base, a door."""

from dashpot.registry.row import Extension, KindOfTest

EXTENSION = Extension(
    "systems",
    file_kinds={
        "seal-line": (
            "points of a seal line", "a door file names it: [seal] points, for dashpot predict",
        ),
        "free-modes": (
            "modes of a structure at points",
            "a door file names it: [modes] file, for dashpot predict",
        ),
    },
    kinds=(
            KindOfTest(
                "seal-line", app_section="part",
                examples="dashpot.extensions.systems.door.examples:EXAMPLES", order=19,
        ),
            KindOfTest("free-modes", "dashpot.extensions.systems.door.read_modes:read_modes", app_section="part", order=20),
    ),
    handlers={
        "part text": {
            "dashpot.workflow.frf_prediction:ShakenMass": "dashpot.extensions.systems.shaken_text:format_shaken_mass",
        },
        "random base": {
            "system": "dashpot.extensions.systems.shaken_systems:shake_system",
            "mass": "dashpot.extensions.systems.shaken_systems:shake_mass",
        },
        "sweep at level": {"mass": "dashpot.extensions.systems.level_response:sweep_mass_at_level"},
        "stations": {"door": "dashpot.extensions.systems.door.export_handler:find_line_stations"},
        "option groups": {"predict": "dashpot.extensions.systems.door.command_options:list_groups"},
        "predict file": {
            "door": "dashpot.extensions.systems.door.predict_handler:run",
        },
        "predict": {
            "dashpot.extensions.systems.door.door_model:Door": "dashpot.extensions.systems.door.api:predict_door",
        },
        "read": {
            "door": "dashpot.extensions.systems.door.read:read_door",
        },
        "file row": {".toml": "dashpot.extensions.systems.door.app_page:describe_file"},
        "predict open files": {"door": "dashpot.extensions.systems.door.app_page:predict_open_files"},
        "figure cards": {"dashpot.extensions.systems.door.result:DoorResult": "dashpot.extensions.systems.door.app_page:list_cards"},
        "page": {
            "dashpot.extensions.systems.door.leak_result:LeakResult": "dashpot.extensions.systems.door.leak_page:leak_page",
            "dashpot.extensions.systems.door.population:DoorPopulation": "dashpot.extensions.systems.door.population_figure:lay_out_population",
            "dashpot.extensions.systems.door.result:DoorResult": "dashpot.extensions.systems.door.app_page:page",
        },
        "mounts": {"dashpot.extensions.systems.door.seal_line:SealLine": "dashpot.extensions.systems.door.mounts:make_line_mounts"},
        "text": {
            "dashpot.extensions.systems.door.population:DoorPopulation": "dashpot.extensions.systems.door.population_text:render_population",
            "dashpot.extensions.systems.door.leak_result:LeakResult": "dashpot.extensions.systems.door.leak_text:render_leak",
            "dashpot.extensions.systems.door.closing_result:ClosingResult": "dashpot.extensions.systems.door.closing_text:render_closing",
            "dashpot.extensions.systems.door.result:DoorResult": "dashpot.extensions.systems.door.text:door",
        },
        "html": {
            "dashpot.extensions.systems.door.result:DoorResult": "dashpot.extensions.systems.door.page:door_html",
            "dashpot.extensions.systems.door.closing_result:ClosingResult": "dashpot.extensions.systems.door.page:door_html",
        },
        "plot": {
            "closing": "dashpot.extensions.systems.door.closing_figure:closing",
            "door": "dashpot.extensions.systems.door.figure:door",
            "leak": "dashpot.extensions.systems.door.leak_figure:draw_leak",
        },
        "document": {
            "dashpot/door-population@1": "dashpot.extensions.systems.door.population:DoorPopulation",
        },
        "figure": {
            "dashpot.extensions.systems.door.leak_result:LeakResult": "dashpot.extensions.systems.door.leak_figure:draw_leak",
            "dashpot.extensions.systems.door.population:DoorPopulation": "dashpot.extensions.systems.door.population_figure:draw_population",
            "dashpot.extensions.systems.door.result:DoorResult": "dashpot.extensions.systems.door.figure:door",
            "dashpot.extensions.systems.door.closing_result:ClosingResult": "dashpot.extensions.systems.door.closing_figure:closing",
        },
    },
)  # fmt: skip
