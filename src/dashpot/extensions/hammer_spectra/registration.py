"""Registry row of the limits of a hammer fit over every spectrum."""

from dashpot.registry.row import Extension

EXTENSION = Extension(
    "hammer_spectra",
    handlers={
        "limits over spectra": {
            "frf": "dashpot.extensions.hammer_spectra.line_spectra:widen_to_spectra"
        },
    },
)
