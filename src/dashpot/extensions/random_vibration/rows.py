"""Registry rows of random base motion."""

from dashpot.registry.row import Extension

EXTENSION = Extension(
    "random_vibration",
    handlers={
        "random base": {
            "system": "dashpot.extensions.random_vibration.shaken_systems:shake_system",
            "mass": "dashpot.extensions.random_vibration.shaken_systems:shake_mass",
        },
    },
)
