"""Registry rows of modes over several points, masses and hits."""

from dashpot.registry.row import Extension, FitRow

EXTENSION = Extension(
    "modes",
    handlers={
        "compare files": {
            "frf": "dashpot.extensions.modes.measured_modes:modes_files",
        },
        "job": {"modes": "dashpot.extensions.modes.job:ModesJob"},
        "fit job": {"dashpot.extensions.modes.job:ModesJob": "dashpot.extensions.modes.page:fit_job"},
        "leave one out": {
            "dashpot.datamodel.vibration_tests:ImpactTest": "dashpot.extensions.modes.leave_one_out:cross_validate_hits",
        },
        "read record": {
            "frf": "dashpot.extensions.modes.api:read_frf_record",
        },
        "read resonance": {
            "frf": "dashpot.extensions.modes.single_resonance:read_resonance",
        },
        "first point": {
            "frf": "dashpot.extensions.modes.read_frf_set:select_first_point",
        },
        "read several": {
            "frf": "dashpot.extensions.modes.read_frf_set:read_frfs",
            "shaken base": "dashpot.extensions.modes.shaken_base:read_shaken",
        },
        "estimate frf": {
            "dashpot.datamodel.vibration_tests:ShakenTest": "dashpot.extensions.modes.base_transmissibility:estimate_base_transmissibility",
        },
        "text": {
            "dashpot.extensions.modes.measured_modes:MeasuredModes": "dashpot.extensions.modes.text:modes",
            "dashpot.extensions.modes.mass_series_files:MassSeriesModes": "dashpot.extensions.modes.text:modes_by_mass",
        },
        "page": {
            "dashpot.extensions.modes.mass_series_files:MassSeriesModes": "dashpot.extensions.modes.page:masses_page",
        },
        "figure": {
            "dashpot.extensions.modes.mass_series_files:MassSeriesModes": "dashpot.extensions.modes.figure:draw_masses",
        },
        "pole figure": {
            "dashpot.datamodel.frf:FRF": "dashpot.extensions.modes.figure:draw_poles",
        },
        "poles": {
            "dashpot.datamodel.frf:FRF": "dashpot.extensions.modes.figure:list_poles",
        },
        "plot": {
            "several_masses": "dashpot.extensions.modes.figure:several_masses",
            "stabilisation": "dashpot.extensions.modes.figure:stabilisation",
        },
        "document": {
            "dashpot/modes@2": "dashpot.extensions.modes.measured_modes:MeasuredModes",
        },
    },
    fits=(
        FitRow(
            "modes", "dashpot.extensions.modes.api:fit_modes",
            "dashpot.extensions.modes.fit_handler:run",
            "FRFs without a mass", "the modes of FRFs", order=3,
            options=("band", "motion"),
        ),
        FitRow(
            "masses", "dashpot.extensions.modes.api:fit_mass_series",
            "dashpot.extensions.modes.fit_handler:fit_mass_series",
            "FRFs under several masses", "FRFs under several masses", order=4,
            options=("mass", "seals", "band"),
        ),
    ),
)  # fmt: skip
