"""Registry rows of curves over time, frequency and temperature."""

from dashpot.registry.row import Extension, KindOfTest

EXTENSION = Extension(
    "curves",
    file_kinds={
        "creep": ("a creep test", "use dashpot fit"),
        "modulus": ("a relaxation modulus over time", "use dashpot fit", ("time", "modulus")),
    },
    kinds=(
            KindOfTest(
                "dma", "dashpot.extensions.curves.dynamic.read:read_dynamic", "dashpot.workflow.bench_tests:fit_files", app_section="bench", fit_route="bench",
                classes={"dashpot.extensions.curves.datamodel.dynamic:DynamicTest": ""},
                checks="dashpot.extensions.curves.checks",
                examples="dashpot.extensions.curves.examples:SWEEPS", order=4,
        ),
            KindOfTest(
                "master-curve", "dashpot.extensions.curves.dynamic.read:read_dynamic", "dashpot.workflow.bench_tests:fit_files", app_section="bench", fit_route="bench",
                classes={"dashpot.extensions.curves.datamodel.superposition:Superposition": "dashpot.extensions.curves.superposition.figure:superposition"},
                checks="dashpot.extensions.curves.superposition.checks", order=5,
        ),
            KindOfTest("temperature-sweep", order=7),
            KindOfTest("single-frequency", order=8),
            KindOfTest(
                "modulus", "dashpot.extensions.curves.modulus.read:read_modulus", "dashpot.workflow.bench_tests:fit_files", app_section="bench", fit_route="bench",
                classes={
                    "dashpot.extensions.curves.datamodel.modulus:RelaxationModulus": "",
                    "dashpot.extensions.curves.datamodel.stress_relaxation:StressRelaxationTest": "",
                },
                checks="dashpot.extensions.curves.checks",
                examples="dashpot.extensions.curves.examples:CURVES", order=9,
        ),
            KindOfTest(
                "creep", "dashpot.extensions.curves.creep.read:read_creep", "dashpot.workflow.bench_tests:fit_files", app_section="bench", fit_route="bench",
                classes={
                    "dashpot.extensions.curves.datamodel.creep:CreepTest": "",
                    "dashpot.extensions.curves.datamodel.creep:LoadHold": "",
                    "dashpot.extensions.curves.datamodel.creep:CreepCompliance": "",
                },
                checks="dashpot.extensions.curves.creep.checks", order=10,
        ),
    ),
    handlers={
        "plan repeats": {"temperatures": "dashpot.extensions.curves.temperatures.planned_repeats:plan_repeats"},
        "planned rows": {"temperatures": "dashpot.extensions.curves.temperatures.planned_repeats:build_planned_rows"},
        "read document": {"TemperatureShifts": "dashpot.extensions.curves.temperatures.shift_table:complete_document"},
        "part text": {
            "dashpot.datamodel.shift_factors:TemperatureShifts": "dashpot.extensions.curves.temperatures.text:format_shifts",
            "dashpot.datamodel.parameter_estimate:CreepEstimate": "dashpot.extensions.curves.creep.text:format_compliances",
        },
        "part page": {
            "dashpot.datamodel.shift_factors:TemperatureShifts": "dashpot.extensions.curves.temperatures.page:make_page_part",
        },
        "deck header": {
            "dashpot.datamodel.shift_factors:TemperatureShifts": "dashpot.extensions.curves.temperatures.deck_lines:format_law_lines",
        },
        "deck remarks": {
            "dashpot.datamodel.shift_factors:TemperatureShifts": "dashpot.extensions.curves.temperatures.deck_lines:format_missing_stiffness_lines",
        },
        "shift table": {
            "dashpot.datamodel.shift_factors:TemperatureShifts": "dashpot.extensions.curves.temperatures.shift_table:format_shift_table",
        },
        "fit figure": {
            "dashpot.extensions.curves.datamodel.superposition:Superposition": "dashpot.extensions.curves.superposition.figure:draw_fit",
            "dashpot.extensions.curves.datamodel.modulus:RelaxationModulus": "dashpot.extensions.curves.time_curve_figure:modulus",
            "dashpot.extensions.curves.datamodel.stress_relaxation:StressRelaxationTest": "dashpot.extensions.curves.time_curve_figure:draw_stress_relaxation",
            "dashpot.extensions.curves.datamodel.creep:LoadHold": "dashpot.extensions.curves.creep.figure:creep",
            "dashpot.extensions.curves.datamodel.creep:CreepCompliance": "dashpot.extensions.curves.creep.figure:creep",
            "dashpot.extensions.curves.datamodel.dynamic:DynamicTest": "dashpot.extensions.curves.dynamic.figure:draw_sweep",
            "dashpot.datamodel.shift_factors:TemperatureShifts": "dashpot.extensions.curves.temperatures.figure:temperatures",
        },
        "plot": {
            "creep": "dashpot.extensions.curves.creep.figure:creep",
            "modulus": "dashpot.extensions.curves.time_curve_figure:modulus",
            "superposition": "dashpot.extensions.curves.superposition.figure:superposition",
            "temperatures": "dashpot.extensions.curves.temperatures.figure:temperatures",
        },
        "record rule": {"stress-strain": "dashpot.extensions.curves.material_records:recognise_material_record"},
        "refuse sizes": {
            "modulus": "dashpot.extensions.curves.material_records:refuse_material_sizes",
            "creep": "dashpot.extensions.curves.material_records:refuse_creep_sizes",
            "cyclic": "dashpot.extensions.curves.material_records:refuse_material_sizes",
        },
        "read signals": {"stress-strain": "dashpot.extensions.curves.material_records:read_strain_and_stress"},
        "propose roles": {"modulus": "dashpot.extensions.curves.modulus.read:propose_temperature"},
        "roles": {"creep": "dashpot.extensions.curves.creep.read:roles", "modulus": "dashpot.extensions.curves.modulus.read:roles"},
        "fit records": {
            "dashpot.extensions.curves.datamodel.dynamic:DynamicTest": "dashpot.extensions.curves.fit_records:fit_curves",
            "dashpot.extensions.curves.datamodel.modulus:RelaxationModulus": "dashpot.extensions.curves.fit_records:fit_curves",
            "dashpot.extensions.curves.datamodel.stress_relaxation:StressRelaxationTest": "dashpot.extensions.curves.fit_records:fit_curves",
            "dashpot.extensions.curves.datamodel.creep:CreepTest": "dashpot.extensions.curves.fit_records:fit_curves",
            "dashpot.extensions.curves.datamodel.creep:LoadHold": "dashpot.extensions.curves.fit_records:fit_curves",
            "dashpot.extensions.curves.datamodel.creep:CreepCompliance": "dashpot.extensions.curves.fit_records:fit_curves",
        },
        "fit at several temperatures": {
            "dashpot.datamodel.relaxation:RampHold": "dashpot.extensions.curves.temperatures.fit_temperatures:fit_records",
        },
        "lot columns": {
            "dashpot.extensions.curves.datamodel.creep:LoadHold": "dashpot.extensions.curves.lot_row:list_load_columns",
            "dashpot.extensions.curves.datamodel.creep:CreepCompliance": "dashpot.extensions.curves.lot_row:list_curve_columns",
            "dashpot.extensions.curves.datamodel.modulus:RelaxationModulus": "dashpot.extensions.curves.lot_row:list_curve_columns",
            "dashpot.extensions.curves.datamodel.stress_relaxation:StressRelaxationTest": "dashpot.extensions.curves.lot_row:list_curve_columns",
            "dashpot.extensions.curves.datamodel.dynamic:DynamicTest": "dashpot.extensions.curves.lot_row:list_sweep_columns",
        },
        "dynamic stiffness": {
            "dashpot.extensions.curves.datamodel.dynamic:DynamicTest": "dashpot.extensions.curves.dynamic.read:convert_to_frf",
        },
        "fit complex modulus": {
            "dma": "dashpot.extensions.curves.dynamic.fit:fit_complex_modulus",
        },
    },
)  # fmt: skip
