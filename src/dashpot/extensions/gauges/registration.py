"""The rows of records in gauge voltages."""

from dashpot.registry.row import Extension

EXTENSION = Extension(
    "gauges",
    handlers={
        "options": {"simulate": "dashpot.extensions.gauges.simulated_record:list_options"},
        "files beside": {
            "simulate": "dashpot.extensions.gauges.simulated_record:list_calibration_files"
        },
        "simulated record": {
            "gauges": "dashpot.extensions.gauges.simulated_record:serialise_record"
        },
    },
)
