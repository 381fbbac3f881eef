"""Registry rows of blank tests."""

from dashpot.registry.row import Extension, FitRow, KindOfTest

EXTENSION = Extension(
    "blank_tests",
    file_kinds={
        "blank": (
            "a blank test of the machine", "use dashpot fit --kind blank -o rig.toml",
            ("time", "displacement", "force"),
        ),
    },
    kinds=(
        KindOfTest(
            "blank", "dashpot.extensions.blank_tests.read:read_blank_test",
            "dashpot.extensions.blank_tests.fit_files:fit_blank_files", fit_route="blank",
            app_section="standalone", app_form="dashpot.extensions.blank_tests.app_form",
            classes={
                "dashpot.extensions.blank_tests.datamodel:BlankTest": "",
                "dashpot.extensions.blank_tests.datamodel:MachineFit": "dashpot.extensions.blank_tests.figure:draw_machine",
            },
            pages={"dashpot.extensions.blank_tests.datamodel:MachineFit": "dashpot.extensions.blank_tests.page:page"},
            checks="dashpot.extensions.blank_tests.checks",
            examples="dashpot.extensions.blank_tests.examples:EXAMPLES",
            kind_option="spring_stiffness", fit_options=("spring_stiffness",),
            read_keywords=("role",), order=21,
        ),
    ),
    handlers={
        "app file": {
            "dashpot.extensions.blank_tests.datamodel:MachineFit": "dashpot.extensions.blank_tests.app_form:save_machine_file",
        },
        "file row": {".toml machine": "dashpot.extensions.blank_tests.app_row:describe_machine_file"},
        "option groups": {"fit blank tests": "dashpot.extensions.blank_tests.command_options:list_groups"},
        "plan advice": {"machine": "dashpot.extensions.blank_tests.expected_gain:advise_blank_tests"},
        "read": {"machine": "dashpot.extensions.blank_tests.machine_file:read_machine_file"},
        "read option": {"--machine": "dashpot.extensions.blank_tests.machine_file:MachineFields"},
        "read record": {"blank": "dashpot.extensions.blank_tests.read:read_stated_role"},
    },
    fits=(
        FitRow(
            "blank", "dashpot.extensions.blank_tests.api:fit_machine",
            "dashpot.extensions.blank_tests.fit_handler:run",
            "blank tests", "blank tests", order=11,
            options=("spring_stiffness", "spring_error", "roles", "specimen"),
        ),
    ),
)  # fmt: skip
