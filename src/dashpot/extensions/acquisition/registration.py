"""Registry rows of the recording of an instrument."""

from dashpot.registry.row import Command, Extension

EXTENSION = Extension(
    "acquisition",
    handlers={
        "record": {"file": "dashpot.extensions.acquisition.record_to_file:record"},
        "recorder": {
            "serial": "dashpot.extensions.acquisition.serial_line:SerialLine",
            "simulated": "dashpot.extensions.acquisition.replay_device:create_simulated_device",
            "replay": "dashpot.extensions.acquisition.replay_device:replay",
        },
    },
    commands=(
        Command("record", "Before the test", "Signals of an instrument to a file; it controls no machine.", "dashpot.extensions.acquisition.command", order=9),
    ),
)  # fmt: skip
