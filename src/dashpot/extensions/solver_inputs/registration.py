"""Registry rows of further solver inputs."""

from dashpot.registry.row import Extension, SolverInput

EXTENSION = Extension(
    "solver_inputs",
    handlers={
        "option groups": {"export": "dashpot.extensions.solver_inputs.draws.command_options:list_groups"},
        "export with option": {
            "draws": "dashpot.extensions.solver_inputs.draws.command_options:export_requested_draws",
        },
    },
    solver_inputs=(
        SolverInput("ansys", "dashpot.extensions.solver_inputs.ansys", order=2),
        SolverInput("lsdyna", "dashpot.extensions.solver_inputs.lsdyna", order=3),
        SolverInput("radioss", "dashpot.extensions.solver_inputs.radioss", order=4),
        SolverInput("calculix", "dashpot.extensions.solver_inputs.calculix", order=5),
        SolverInput("opensees", "dashpot.extensions.solver_inputs.opensees", order=6),
        SolverInput("adams", "dashpot.extensions.solver_inputs.adams", order=7),
        SolverInput("statespace", "dashpot.extensions.solver_inputs.statespace", order=8),
        SolverInput("csv", "dashpot.extensions.solver_inputs.csv", order=9),
        SolverInput("fmu", "dashpot.extensions.solver_inputs.fmu", order=10),
        SolverInput("modelica", "dashpot.extensions.solver_inputs.modelica", order=11),
    ),
)  # fmt: skip
