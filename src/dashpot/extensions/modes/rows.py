"""The rows of modes of several points, masses and hits."""

from dashpot.registry.row import Extension

EXTENSION = Extension(
    "modes",
    handlers={
        "text": {
            "dashpot.extensions.modes.measured_modes:MeasuredModes": "dashpot.text_output.modes:modes",
            "dashpot.extensions.modes.mass_series_files:ModesByMass": "dashpot.text_output.modes:modes_by_mass",
        },
        "fit command": {
            "modes": "dashpot.extensions.modes.fit_handler:run",
            "masses": "dashpot.extensions.modes.fit_handler:under_masses",
        },
    },
)  # fmt: skip
