"""Registry rows of further solver inputs."""

from dashpot.registry.row import Command, Extension, SolverInput

EXTENSION = Extension(
    "solver_inputs",
    handlers={
        "choice": {
            "kratos": "dashpot.extensions.solver_inputs.unsupported_solvers:KRATOS",
            "marc": "dashpot.extensions.solver_inputs.unsupported_solvers:UNCHECKED",
            "msc-marc": "dashpot.extensions.solver_inputs.unsupported_solvers:UNCHECKED",
            "exudyn": "dashpot.extensions.solver_inputs.unsupported_solvers:UNCHECKED",
        },
        "procedures": {
            "solver input": "dashpot.extensions.solver_inputs.procedures:format_procedures",
        },
        "text": {
            "dashpot.extensions.solver_inputs.cards.imported_model:ImportedModel": "dashpot.extensions.solver_inputs.cards.text:render_imported_model",
        },
        "option groups": {"export": "dashpot.extensions.solver_inputs.draws.command_options:list_groups"},
        "export with option": {
            "draws": "dashpot.extensions.solver_inputs.draws.command_options:export_requested_draws",
        },
    },
    commands=(
        Command("import", "Work", "A solver card back to a model, and what a test could identify.", "dashpot.extensions.solver_inputs.cards.command", order=5),
    ),
    solver_inputs=(
        SolverInput("ansys", "dashpot.extensions.solver_inputs.ansys", order=2, synonyms=("mapdl", "apdl")),
        SolverInput("lsdyna", "dashpot.extensions.solver_inputs.lsdyna", order=3, synonyms=("ls-dyna", "dyna")),
        SolverInput("radioss", "dashpot.extensions.solver_inputs.radioss", order=4, synonyms=("openradioss",)),
        SolverInput("calculix", "dashpot.extensions.solver_inputs.calculix", order=5, synonyms=("ccx",)),
        SolverInput("opensees", "dashpot.extensions.solver_inputs.opensees", order=6, synonyms=("openseespy", "xara")),
        SolverInput("adams", "dashpot.extensions.solver_inputs.adams", order=7),
        SolverInput("fmu", "dashpot.extensions.solver_inputs.fmu", order=10, synonyms=("fmi",)),
        SolverInput("modelica", "dashpot.extensions.solver_inputs.modelica", order=11),
        SolverInput("felupe", "dashpot.extensions.solver_inputs.felupe", order=12),
        SolverInput("optistruct", "dashpot.extensions.solver_inputs.optistruct", order=13),
        SolverInput("comsol", "dashpot.extensions.solver_inputs.comsol", order=14),
    ),
)  # fmt: skip
