"""Registry rows of material tests."""

from dashpot.registry.row import Extension, FitRow, KindOfTest

EXTENSION = Extension(
    "materials",
    file_kinds={
        "cld": (
            "a compression load deflection (CLD), pressed and released", "use dashpot fit",
            ("time", "displacement", "force"),
        ),
        "stress-strain": (
            "stress over strain of a material",
            "use dashpot fit; of a relaxation test multiply by area and height first",
            ("time", "stretch", "strain", "stress"),
        ),
        "indentation": (
            "a rebound indentation", "use dashpot fit with its mass", ("time", "velocity"), True,
        ),
        "drop": (
            "a drop test of a mass on a specimen", "use dashpot fit with its mass",
            ("time", "force"), True,
        ),
        "csr": (
            "a record of compression stress relaxation (CSR)", "use dashpot fit",
            ("time", "force"), False, True,
        ),
    },
    kinds=(
            KindOfTest(
                "cld", "dashpot.extensions.materials.cld.read:read_cld", "dashpot.extensions.materials.cld.fit_files:cld_files", fit_route="cld",
                app_section="standalone",
                classes={
                    "dashpot.extensions.materials.cld.datamodel:CLDTest": "",
                    "dashpot.extensions.materials.cld.datamodel:CLD": "dashpot.extensions.materials.cld.figure:cld",
                },
                pages={"dashpot.extensions.materials.cld.fit_files:CLDResult": "dashpot.extensions.materials.cld.page:page"},
                app_form="dashpot.extensions.materials.cld.app_form",
                checks="dashpot.extensions.materials.cld.checks",
                lot_row="dashpot.extensions.materials.cld.lot_row:build_lot_row",
                columns=(
                    "cld_at_m", "cld_force_N", "cld_force_se_N", "cld_per_100mm_N", "cld_slope_N_per_m",
                    "cld_hysteresis", "cld_softening", "cld_set_m",
                ),
                examples="dashpot.extensions.materials.cld.examples:EXAMPLES", order=11,
        ),
            KindOfTest(
                "indentation", "dashpot.extensions.materials.indentation.read:read_indentation",
                "dashpot.extensions.materials.indentation.fit_files:indent_file", fit_route="indentation", app_section="standalone",
                classes={
                    "dashpot.extensions.materials.indentation.datamodel:IndentationTest": "",
                    "dashpot.extensions.materials.indentation.datamodel:IndentationFit": "dashpot.extensions.materials.indentation.figure:indentation",
                },
                pages={"dashpot.extensions.materials.indentation.datamodel:IndentationFit": "dashpot.extensions.materials.indentation.page:page"},
                app_form="dashpot.extensions.materials.indentation.app_form", takes_one_file=True,
                read_keywords=("mass", "radius", "radius_error", "drop_height", "impact_velocity"),
                checks="dashpot.extensions.materials.indentation.checks",
                lot_row="dashpot.extensions.materials.indentation.lot_row:build_lot_row", required_value="mass",
                lot_hint="give the indenter's mass (--mass, or the column 'mass' of --manifest)",
                columns=(
                    "indent_modulus_Pa", "indent_modulus_low_Pa", "indent_modulus_high_Pa",
                    "indent_depth_m", "restitution", "contact_s",
                ),
                examples="dashpot.extensions.materials.indentation.examples:EXAMPLES", order=12,
        ),
            KindOfTest(
                "rod", "dashpot.reading.readers.frf:read_frf", "dashpot.extensions.materials.rod.fit_files:rod_files", fit_route="rod",
                classes={"dashpot.extensions.materials.rod.datamodel:RodModulus": "dashpot.extensions.materials.rod.figure:rod"},
                pages={"dashpot.extensions.materials.rod.fit_files:Rod": "dashpot.extensions.materials.rod.page:page"},
                app_form="dashpot.extensions.materials.rod.app_form", takes_one_file=True,
                checks="dashpot.extensions.materials.rod.checks",
                examples="dashpot.extensions.materials.rod.examples:EXAMPLES", order=13,
        ),
            KindOfTest(
                "stress-strain", "dashpot.extensions.materials.hyperelastic.read:read_stress_strain",
                "dashpot.extensions.materials.hyperelastic.fit_files:hyperelastic_files", fit_route="stress-strain", app_section="standalone",
                classes={
                    "dashpot.extensions.materials.hyperelastic.datamodel:StressStrainTest": "",
                    "dashpot.extensions.materials.hyperelastic.datamodel:HyperelasticFit": "dashpot.extensions.materials.hyperelastic.figure:hyperelastic",
                },
                pages={"dashpot.extensions.materials.hyperelastic.datamodel:HyperelasticFit": "dashpot.extensions.materials.hyperelastic.page:page"},
                app_form="dashpot.extensions.materials.hyperelastic.app_form",
                checks="dashpot.extensions.materials.hyperelastic.checks",
                examples="dashpot.extensions.materials.hyperelastic.examples:EXAMPLES",
                read_keywords=("test",), order=14,
        ),
            KindOfTest(
                "csr", "dashpot.extensions.materials.csr.read:read_csr", "dashpot.extensions.materials.csr.fit_files:csr_files", fit_route="csr",
                app_section="standalone",
                classes={
                    "dashpot.extensions.materials.csr.datamodel:CSRTest": "",
                    "dashpot.extensions.materials.csr.aging_plan:AgingPlan": "",
                    "dashpot.extensions.materials.csr.datamodel:Aging": "dashpot.extensions.materials.csr.figure:csr",
                    "dashpot.extensions.materials.csr.lifetime_prediction:AgingPrediction": "dashpot.extensions.materials.csr.figure:draw_aged_force",
                },
                pages={
                    "dashpot.extensions.materials.csr.datamodel:Aging": "dashpot.extensions.materials.csr.page:page",
                    "dashpot.extensions.materials.csr.lifetime_prediction:AgingPrediction": "dashpot.extensions.materials.csr.page:lay_out_aged",
                },
                app_form="dashpot.extensions.materials.csr.app_form",
                checks="dashpot.extensions.materials.csr.checks",
                lot_row="dashpot.extensions.materials.csr.lot_row:build_lot_row",
                columns=(
                    "csr_loss_per_decade", "csr_chemical_time_s", "csr_chemical_time_low_s",
                    "csr_activation_J_per_mol",
                ),
                examples="dashpot.extensions.materials.csr.examples:EXAMPLES",
                fits="dashpot.extensions.materials.csr.lifetime_prediction:fit_life", fit_options=("temperatures", "machine", "use_at"),
                predict="dashpot.extensions.materials.csr.lifetime_prediction:predict_aged", predict_options="dashpot.extensions.materials.csr.options:AgingPredictionOptions",
                next_command="predict FILE --temperature 70degC --end 50%", order=15,
        ),
            KindOfTest(
                "drop", "dashpot.extensions.materials.drop.read:read_drop_test", "dashpot.extensions.materials.drop.fit_files:fit_drop_files", fit_route="drop",
                app_section="standalone",
                classes={
                    "dashpot.extensions.materials.drop.datamodel:DropTest": "",
                    "dashpot.extensions.materials.drop.datamodel:DropFit": "dashpot.extensions.materials.drop.figure:draw_drop_fit",
                    "dashpot.extensions.materials.drop.prediction:DropPrediction": "dashpot.extensions.materials.drop.figure:draw_drop_prediction",
                },
                app_form="dashpot.extensions.materials.drop.app_form",
                checks="dashpot.extensions.materials.drop.checks",
                examples="dashpot.extensions.materials.drop.examples:EXAMPLES",
                fits="dashpot.extensions.materials.drop.fit:fit_drop_tests", kind_option="drop", fit_options=("mass", "drop", "relaxation", "specimen"), order=16,
        ),
    ),
    handlers={
        "bound value": {
            "dashpot.extensions.materials.csr.datamodel:Aging": "dashpot.extensions.materials.csr.lifetime_prediction:make_life_interval",
            "dashpot.extensions.materials.csr.lifetime_prediction:AgingPrediction": "dashpot.extensions.materials.csr.lifetime_prediction:make_life_interval",
        },
        "retained force": {
            "dashpot.extensions.materials.csr.datamodel:Aging": "dashpot.extensions.materials.csr.lifetime_prediction:predict_aging",
        },
        "option groups": {
            "fit": "dashpot.extensions.materials.fit_options:list_groups",
            "plan": "dashpot.extensions.materials.csr.plan_command:list_groups",
        },
        "plan test": {"use_at": "dashpot.extensions.materials.csr.plan_command:plan_test"},
        "options": {
            "predict": "dashpot.extensions.materials.drop.command_options:list_of_prediction",
        },
        "predict with option": {
            "drop": "dashpot.extensions.materials.drop.prediction:predict_drop",
        },
        "read record": {
            "stress-strain": "dashpot.extensions.materials.hyperelastic.api:read_stress_strain_record",
            "indentation": "dashpot.extensions.materials.indentation.api:read_hit_record",
        },
        "refuse sizes": {"stress-strain": "dashpot.extensions.materials.hyperelastic.read:refuse_sizes"},
        "table rule": {
            "csr": "dashpot.extensions.materials.csr.table_rule:has_counterforce",
            "indentation": "dashpot.extensions.materials.table_rules:has_indenter_motion",
            "drop": "dashpot.extensions.materials.table_rules:has_drop",
        },
        "text": {
            "dashpot.extensions.materials.csr.lifetime_prediction:AgingPrediction": "dashpot.extensions.materials.csr.text:render_aged",
            "dashpot.extensions.materials.csr.aging_plan:AgingPlan": "dashpot.extensions.materials.csr.plan_command:format_plan",
            "dashpot.extensions.materials.cld.fit_files:CLDResult": "dashpot.extensions.materials.cld.text:cld",
            "dashpot.extensions.materials.hyperelastic.datamodel:HyperelasticFit": "dashpot.extensions.materials.hyperelastic.text:hyperelastic",
            "dashpot.extensions.materials.indentation.datamodel:IndentationFit": "dashpot.extensions.materials.indentation.text:indentation",
            "dashpot.extensions.materials.rod.fit_files:Rod": "dashpot.extensions.materials.rod.text:rod",
        },
        "figure": {
            "dashpot.extensions.materials.csr.lifetime_prediction:FittedLife": "dashpot.extensions.materials.csr.figure:draw_life",
            "dashpot.extensions.materials.cld.fit_files:CLDResult": "dashpot.extensions.materials.cld.figure:draw_specimens",
            "dashpot.extensions.materials.rod.fit_files:Rod": "dashpot.extensions.materials.rod.figure:draw_rod",
        },
        "plot": {
            "cld": "dashpot.extensions.materials.cld.figure:cld",
            "life": "dashpot.extensions.materials.csr.figure:draw_life_chart",
            "hyperelastic": "dashpot.extensions.materials.hyperelastic.figure:hyperelastic",
            "indentation": "dashpot.extensions.materials.indentation.figure:indentation",
            "rod": "dashpot.extensions.materials.rod.figure:rod",
        },
        "deck terms": {
            "dashpot.extensions.materials.hyperelastic.datamodel:HyperelasticFit": "dashpot.extensions.materials.hyperelastic.page:find_terms",
        },
        "export": {
            "dashpot.extensions.materials.hyperelastic.datamodel:HyperelasticFit": "dashpot.extensions.materials.hyperelastic.material_cards:export_law",
        },
    },
    fits=(
        FitRow(
            "rod", "dashpot.extensions.materials.rod.api:fit_rod",
            "dashpot.extensions.materials.rod.fit_handler:run",
            "a rod", "a rod under a mass", order=6,
            options=(
                "model", "arms", "mass", "band", "rig", "hammer", "rod", "density", "poisson",
                "temperatures", "specimen",
            ),
            selecting=("rod", "density", "shape"),
        ),
        FitRow(
            "cld", "dashpot.extensions.materials.cld.api:fit_load_deflection",
            "dashpot.extensions.materials.cld.fit_handler:run",
            "load deflection", "load deflection", order=7,
            options=(
                "compression", "compression_limits", "force_limits", "machine", "relaxation", "temperatures",
                "specimen",
            ),
        ),
        FitRow(
            "stress-strain", "dashpot.extensions.materials.hyperelastic.api:fit_stress_strain",
            "dashpot.extensions.materials.hyperelastic.fit_handler:run",
            "stress over strain", "stress over strain", order=8,
            options=(
                "model", "relaxation", "test", "poisson", "stretches", "terms", "measures",
                "temperatures",
            ),
        ),
        FitRow(
            "indentation", "dashpot.extensions.materials.indentation.api:fit_hit",
            "dashpot.extensions.materials.indentation.fit_handler:run",
            "an indenter's hit", "the hit of an indenter", order=9,
            options=("model", "mass", "indenter"),
        ),
        FitRow(
            "drop", "",
            "dashpot.extensions.materials.drop.fit_handler:run",
            "drop tests", "drop tests", order=10,
            options=("mass", "relaxation", "drop", "temperatures", "specimen"),
        ),
    ),
)  # fmt: skip
