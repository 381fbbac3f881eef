"""Registry rows of tests at several amplitudes."""

from dashpot.registry.row import Extension, FitRow, KindOfTest

EXTENSION = Extension(
    "amplitude",
    file_kinds={
        "cyclic": (
            "cyclic loops without a hold", "use dashpot fit", ("time", "displacement", "force"),
        ),
    },
    kinds=(
            KindOfTest(
                "strain-sweep", "dashpot.extensions.amplitude.read:read_amplitude", "dashpot.extensions.amplitude.fit_files:level_files",
                app_section="level", fit_route="level",
                classes={
                    "dashpot.extensions.amplitude.datamodel:AmplitudeSweep": "dashpot.extensions.amplitude.figure:amplitude_sweep",
                    "dashpot.extensions.amplitude.datamodel:AmplitudeFit": "",
                    "dashpot.extensions.amplitude.level_results:LevelFit": "",
                },
                pages={
                    "dashpot.extensions.amplitude.fit_files:AmplitudeResult": "dashpot.extensions.amplitude.page:page",
                    "dashpot.extensions.amplitude.level_prediction:LevelPrediction": "dashpot.extensions.amplitude.page:prediction_page",
                },
                checks="dashpot.extensions.amplitude.checks", order=6,
        ),
            KindOfTest(
                "cyclic", "dashpot.extensions.amplitude.read:read_loops", "dashpot.extensions.amplitude.fit_files:level_files", app_section="level",
                fit_route="level",
                checks="dashpot.extensions.amplitude.checks",
                lot_row="dashpot.extensions.amplitude.lot_row:build_lot_row",
                columns=(
                    "loop_frequency_Hz", "loop_amplitude_m", "loop_amplitude",
                    "loop_storage_N_per_m", "loop_storage_se_N_per_m", "loop_loss_N_per_m",
                    "loop_loss_se_N_per_m", "loop_storage_Pa", "loop_storage_se_Pa", "loop_loss_Pa",
                    "loop_loss_se_Pa", "loop_loss_factor", "loop_softening",
                ),
                examples="dashpot.extensions.amplitude.examples:EXAMPLES", order=17,
        ),
    ),
    handlers={
        "fit job": {"dashpot.workflow.job:LevelJob": "dashpot.extensions.amplitude.page:fit_job"},
        "over amplitude": {"column": "dashpot.extensions.amplitude.read:get_amplitude_factor"},
        "read sweep": {
            "dashpot.workflow.job:LevelChoices": "dashpot.extensions.amplitude.amplitude_response:fit_swept_part",
        },
        "predict at levels": {
            "dashpot.workflow.job:LevelChoices": "dashpot.extensions.amplitude.level_prediction:LevelEffect",
        },
        "figure": {
            "dashpot.extensions.amplitude.fit_files:AmplitudeResult": "dashpot.extensions.amplitude.figure:draw_levels",
            "dashpot.extensions.amplitude.level_prediction:LevelPrediction": "dashpot.extensions.amplitude.page:draw_prediction",
        },
        "predict with sweep": {
            "dashpot.extensions.amplitude.datamodel:AmplitudeSweep": "dashpot.extensions.amplitude.api:fit_sweep",
        },
        "read record": {
            "cyclic": "dashpot.extensions.amplitude.api:read_loops_as_sweep",
        },
        "record rule": {"cyclic": "dashpot.extensions.amplitude.harmonic_motion:is_harmonic"},
        "propose roles": {"strain-sweep": "dashpot.extensions.amplitude.read:propose_amplitude"},
        "roles": {"cyclic": "dashpot.extensions.amplitude.read:list_loop_roles"},
        "text": {
            "dashpot.extensions.amplitude.level_prediction:LevelPrediction": "dashpot.extensions.amplitude.level_text:prediction",
            "dashpot.extensions.amplitude.hits_by_amplitude:HitLevels": "dashpot.extensions.amplitude.text:render_amplitude",
            "dashpot.extensions.amplitude.level_results:LevelFit": "dashpot.extensions.amplitude.text:render_amplitude",
            "dashpot.extensions.amplitude.datamodel:AmplitudeFit": "dashpot.extensions.amplitude.text:render_amplitude",
            "dashpot.extensions.amplitude.fit_files:AmplitudeResult": "dashpot.extensions.amplitude.text:render_levels",
        },
        "plot": {
            "amplitude_sweep": "dashpot.extensions.amplitude.figure:amplitude_sweep",
            "frfs_at_levels": "dashpot.extensions.amplitude.figure:frfs_at_levels",
            "level": "dashpot.extensions.amplitude.figure:level",
            "loops": "dashpot.extensions.amplitude.figure:loops",
        },
        "read document": {
            "dashpot/levels@2": "dashpot.extensions.amplitude.level_results:complete_document",
        },
        "deck terms": {
            "dashpot.extensions.amplitude.level_results:LevelFit": "dashpot.report.page_frame:find_terms",
        },
        "export": {
            "dashpot.extensions.amplitude.level_results:LevelFit": "dashpot.export:export_fit",
        },
    },
    fits=(
        FitRow(
            "level", "dashpot.extensions.amplitude.api:fit_levels",
            "dashpot.extensions.amplitude.fit_handler:run",
            "tests at several amplitudes", "tests at several amplitudes", order=5,
            options=("model", "machine", "mass", "seals", "band", "levels", "at", "motion"),
            selecting=("levels", "at"),
        ),
    ),
)  # fmt: skip
