"""Registry rows of tests at several depths."""

from dashpot.registry.row import Extension

EXTENSION = Extension(
    "depths",
    handlers={
        "fit at several depths": {
            "dashpot.datamodel.relaxation:RampHold": "dashpot.extensions.depths.depth_dependence:fit_depths",
        },
    },
)
