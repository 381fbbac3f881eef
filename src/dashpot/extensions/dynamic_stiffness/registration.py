"""Registry rows of storage and loss stiffness at frequencies."""

from dashpot.registry.row import Extension

EXTENSION = Extension(
    "dynamic_stiffness",
    handlers={
        "options": {
            "stiffness": "dashpot.extensions.dynamic_stiffness.command_options:list_options",
        },
        "predict with option": {
            "frequency": "dashpot.extensions.dynamic_stiffness.prediction:predict_stiffness",
        },
        "page": {
            "dashpot.extensions.dynamic_stiffness.prediction:StiffnessPrediction": "dashpot.extensions.dynamic_stiffness.page:lay_out_stiffness",
        },
        "figure": {
            "dashpot.extensions.dynamic_stiffness.prediction:StiffnessPrediction": "dashpot.extensions.dynamic_stiffness.figure:draw_stiffness_prediction",
        },
    },
)
