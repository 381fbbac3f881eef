"""What public names were called before the verbs, and what is typed now."""

from collections.abc import Mapping
from types import MappingProxyType

_READ, _FIT, _SOLIDS, _SYSTEMS, _FILES = "dp.read", "dp.fit", "dp.solids", "dp.systems", "dp.files"

FORMER: Mapping[str, str] = MappingProxyType({
    **dict.fromkeys(
        ("read_bench", "read_cld", "read_creep", "read_door", "read_dynamic", "read_frf",
         "read_frfs", "read_impact", "read_indentation", "read_modulus", "read_relaxation",
         "read_stress_strain", "from_json"), _READ),
    **dict.fromkeys(
        ("fit_amplitude", "fit_creep", "fit_depths", "fit_dynamic", "fit_hyperelastic",
         "fit_indentation", "fit_levels", "fit_modulus", "fit_rate", "fit_speeds", "identify",
         "cld", "relaxed_law", "rod_modulus", "several_masses"), _FIT),
    **{name: f"{_SOLIDS}.{name}" for name in (
        "Arrhenius", "FractionalZener", "FreeShifts", "Hyperelastic", "Parallel", "WLF",
        "compare_with_curve", "dynamic_master_curve", "friction", "master_curve", "networks",
        "superpose", "Superposition")},
    **{name: f"{_SYSTEMS}.{name}" for name in (
        "Body", "Closing", "ClosingDoor", "ClosingSetup", "FreeModes", "Joint", "Mount",
        "SealLine", "SealSection", "System", "close_door", "energy_shares", "infer_mass",
        "isolation_frequency", "mac", "planar_body", "point_mass", "predict_frf", "random_base",
        "random_response", "response_at_level", "stabilisation")},
    **{name: f"{_FILES}.{name}" for name in (
        "Trajectory", "planned_trajectory", "read_modes", "read_shifts", "read_trajectory")},
    "fit_exponential_sum": "dp.solids.exponential_sum",
    "fit_many": 'dp.batch: dp.batch(forces, time=t, displacement=x, units="s, mm, N")',
    "inspect_file": "dp.inspect",
    "to_json": "dp.save",
    "characterise": "dp.report",
    "prepare": "test.prepare()",
    "estimate_frf": "hits.frf()",
    "dynamic_stiffness": "frf.stiffness(mass=...)",
    "unseen_arm_band": "dp.predict(fit, mass=..., record=test).limits",
    "frf_band": "dp.predict(fit, mass=..., record=test).limits",
    "measured_compliance": "dp.fit",
    "Bench": "dp.plan(frequency=..., ramp=..., hold=...)",
    "HammerPlan": "dp.plan(frequency=..., mass=...)",
    "SupposedSeal": "dp.plan(frequency=..., seal=...)",
    "HammerRig": "dp.fit(hits, mass=...)",
    "KnownSolid": "dp.fit(hits, mass=..., known=...)",
    "Indenter": "dp.read(FILE, mass=..., radius=...)",
    "CLD": "dp.Pieces",
    "RateLaw": "dp.Pieces.rate",
    "RelaxedLaw": "dp.Pieces.relaxed",
    "LevelFit": "dp.Levels.fit",
    "Status": "fit.status",
})  # fmt: skip
"""The former name, and the new call."""
