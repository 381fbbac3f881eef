"""The rows of further solver inputs."""

from dashpot.registry.row import Extension

EXTENSION = Extension(
    "solver_inputs",
    solver_inputs={
        "ansys": "dashpot.extensions.solver_inputs.ansys",
        "lsdyna": "dashpot.extensions.solver_inputs.lsdyna",
        "radioss": "dashpot.extensions.solver_inputs.radioss",
        "calculix": "dashpot.extensions.solver_inputs.calculix",
        "opensees": "dashpot.extensions.solver_inputs.opensees",
        "adams": "dashpot.extensions.solver_inputs.adams",
    },
)  # fmt: skip
