"""Registry rows of the core: its tests, commands, formats and solver inputs."""

from dashpot.registry.row import Command, Extension, FileFormat, FitRow, KindOfTest, SolverInput

_PAIR = (
    "say of which test (--pair, or the column 'hammer' of --manifest), or fit both with dashpot fit"
)

_BENCH = (
    "model", "arms", "elastic", "method", "time_limits", "machine", "filter", "thorough", "shifting",
    "save_shifts", "temperatures", "specimen",
)  # fmt: skip

EXTENSION = Extension(
    "core",
    kinds=(
            KindOfTest(
                "relaxation", "dashpot.reading.readers.relaxation:read_relaxation", "dashpot.workflow.bench_tests:fit_files", app_section="test", fit_route="bench",
                classes={
                    "dashpot.datamodel.relaxation:RelaxationTest": "",
                    "dashpot.datamodel.relaxation:RampHold": "dashpot.plot.relaxation:segments",
                },
                pages={
                    "dashpot.datamodel.fit:Fit": "dashpot.report.solid_and_frf_pages:solid_page",
                    "dashpot.workflow.identification:IdentificationResult": "dashpot.report.solid_and_frf_pages:identified_page",
                    "dashpot.workflow.frf_prediction:Prediction": (
                        "dashpot.report.solid_and_frf_pages:prediction_page"
                    ),
                },
                checks="dashpot.preprocessing.checks", order=0,
        ),
            KindOfTest(
                "impact", "dashpot.reading.readers.impact:read_impact", "dashpot.workflow.measured_frf:impact_files",
                app_section="hammer", lot_hint=_PAIR, resonates=True, fit_route="hits",
                classes={"dashpot.datamodel.vibration_tests:ImpactTest": ""},
                pages={
                    "dashpot.workflow.measured_frf:Modes": "dashpot.report.solid_and_frf_pages:modes_page",
                    "dashpot.workflow.frf_comparison:FRFComparison": "dashpot.report.solid_and_frf_pages:agreement_page",
                },
                checks="dashpot.vibration.impact.checks", order=1,
        ),
            KindOfTest(
                "frf", "dashpot.reading.readers.frf:read_frf", "dashpot.extensions.modes.measured_modes:modes_files",
                app_section="response", lot_hint=_PAIR, resonates=True, fit_route="modes", alternative_kind="rod",
                classes={"dashpot.datamodel.frf:FRF": "dashpot.plot.frf_figure:frf"},
                checks="dashpot.extensions.modes.checks", order=2,
        ),
            KindOfTest(
                "transmissibility", "dashpot.reading.readers.frf:read_frf",
                "dashpot.extensions.modes.measured_modes:modes_files", app_section="base", fit_route="modes", alternative_kind="rod", order=3,
        ),
    ),
    handlers={
        "figure": {
            "dashpot.workflow.frf_prediction:Prediction": "dashpot.report.result_output:draw_prediction",
        },
        "text": {
            "dashpot.planning.plan:Plan": "dashpot.text_output.results:render_summary",
            "dashpot.datamodel.fit:Fit": "dashpot.text_output.results:render_fit",
            "dashpot.workflow.frf_comparison:FRFComparison": "dashpot.text_output.results:render_agreement",
            "dashpot.workflow.identification:IdentificationResult": "dashpot.text_output.results:render_identification",
            "dashpot.workflow.measured_frf:ImpactResult": "dashpot.text_output.results:render_impact",
            "dashpot.workflow.frf_prediction:Prediction": "dashpot.text_output.results:render_prediction",
            "dashpot.workflow.study:Study": "dashpot.text_output.results:render_study",
        },
        "document": {
            "dashpot/model@1": "dashpot.solids.maxwell:GeneralizedMaxwell",
            "dashpot/fractional@1": "dashpot.solids.fractional:FractionalZener",
            "dashpot/parallel@1": "dashpot.solids.maxwell:Parallel",
            "dashpot/fit@2": "dashpot.datamodel.fit:Fit",
            "dashpot/impact@2": "dashpot.workflow.measured_frf:ImpactResult",
            "dashpot/inspection@2": "dashpot.workflow.inspections:Inspections",
            "dashpot/comparison@2": "dashpot.vibration.comparison.comparison_result:Comparison",
            "dashpot/plan@2": "dashpot.planning.plan:Plan",
            "dashpot/job@2": "dashpot.workflow.job:Job",
            "dashpot/study@2": "dashpot.workflow.study:Study",
        },
        "read document": {"InspectedFile": "dashpot.workflow.inspections:convert_old_inspection"},
        "html": {"dashpot.workflow.study:Study": "dashpot.report.study_page:write_study"},
        "deck terms": {"dashpot.datamodel.fit:Fit": "dashpot.report.page_frame:find_terms"},
        "export": {
            "dashpot.solids.maxwell:Solid": "dashpot.export:export_solid",
            "dashpot.datamodel.fit:Fit": "dashpot.export:export_fit",
        },
    },
    commands=(
        Command("inspect", "Work", "What a file is, how it was read, what is unclear.", "dashpot.cli.inspect", order=0),
        Command("fit", "Work", "A model fitted to records: viscoelastic, modal, elastic.", "dashpot.cli.fit", order=1),
        Command("predict", "Work", "How a fitted model vibrates, under a mass or in a door.", "dashpot.cli.predict", order=2),
        Command("compare", "Work", "A prediction with a measurement, two FRFs, two lots.", "dashpot.cli.compare", order=3),
        Command("report", "Work", "The main workflow: relaxation and hammer test on one page.", "dashpot.cli.report", order=4),
        Command("export", "Work", "A model or constitutive law as input for solvers, as FMU or table.", "dashpot.cli.export", order=5),
        Command("plan", "Before the test", "How well a test will measure, before it is run.", "dashpot.cli.plan", order=8),
        Command("simulate", "Before the test", "A test of a known seal, marked 'simulated'.", "dashpot.cli.simulate", order=10),
    ),
    formats=(
        FileFormat("text", "dashpot.reading.formats.text"),
    ),
    solver_inputs=(
        SolverInput("nastran", "dashpot.export.decks.nastran", order=0, synonyms=("msc-nastran", "nx-nastran")),
        SolverInput("abaqus", "dashpot.export.decks.abaqus", order=1),
        SolverInput("statespace", "dashpot.export.decks.statespace", order=8, synonyms=("state-space", "octave", "matlab")),
        SolverInput("csv", "dashpot.export.decks.csv", order=9),
    ),
    fits=(
        FitRow(
            "bench", "dashpot.api.fit:fit_bench_tests",
            "dashpot.cli.fit_handlers:run_bench_tests",
            "tests on a bench", "tests on a bench", order=0,
            options=_BENCH,
        ),
        FitRow(
            "joint", "dashpot.api.fit:fit_jointly",
            "dashpot.cli.fit_handlers:run_joint",
            "vibration under a mass", "the solid under one mass", order=1,
            options=(
                *_BENCH, "mass", "seals", "seal_mass", "band", "compression", "rig", "hammer",
                "solid_prior", "stiffness_table", "impact_temperature",
            ),
        ),
        FitRow(
            "hits", "dashpot.api.fit:fit_hits",
            "dashpot.cli.fit_handlers:run_hits",
            "hits without a mass", "hammer hits without a mass", order=2,
            options=("mass", "band", "hammer"),
        ),
    ),
)  # fmt: skip
