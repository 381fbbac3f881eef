"""Former names in documents, and their conversion to the present ones on reading.

A document names its schema and version: ``"dashpot/fit@2"``. A former version holds the same values
under other keys, so that one conversion of keys and of names of checks, before the document is
decoded, is all that its reader needs. ``docs/documents.md`` is written from these tables.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dashpot.base.errors import ReadError

_VERDICT = {
    "verdict.use": "verdict_grade",
    "verdict.says": "message",
    "verdict.because": "failed_checks",
}
EVERYWHERE = {"checks.says": "message", "steps.says": "message", **_VERDICT}
"""Renamed keys of the checks, verdicts and steps of any document."""

_BOUNDS = {
    **{f"{name}.says": "message" for name in ("unseen", "parameters", "frf_band")},
    "frf_band.unseen": "unmeasured",
}
RENAMED_KEYS: dict[str, dict[str, str]] = {
    "dashpot/aged@1": {".answers": "values", ".furthest": "latest_time"},
    "dashpot/batch@1": {
        ".unlike": "dissimilar",
        ".lights": "summary",
        "lights.says": "message",
        "flags.says": "message",
        "copies.says": "reason",
        "unlike.says": "reason",
        "statistics.judged": "decisions",
        "gauge.left_out": "omitted_tests",
    },
    "dashpot/blank@1": {".found": "values"},
    "dashpot/cld@1": {
        ".pieces": "specimens",
        "relaxed.left": "residual_hysteresis",
        "rate.bic_over_memory": "bic_over_relaxation",
    },
    "dashpot/closing@1": {"scatter.leaking": "share_leaking", ".energy_left": "remaining_energy"},
    "dashpot/comparison@1": {".says": "message", ".unseen": "unmeasured"},
    "dashpot/csr@1": {".found": "values", "law.bound_alone": "is_lower_bound"},
    "dashpot/door@1": {"seal.sticks": "slip_limit"},
    "dashpot/error@1": {".says": "message"},
    "dashpot/fit@1": {
        ".says": "message",
        ".left_open": "end_of_hold_limits",
        "left_open.k_3end": "k_at_3_end",
        "left_open.k_10end": "k_at_10_end",
        "left_open.time": "end_time",
        "left_open.falling": "slope_limit",
        "left_open.named": "if_machine_named",
        "left_open.ended": "test_kind",
        ".of_noise": "noise_covariance",
        ".moved": "parameter_changes",
        "residual.kappa": "variance_inflation",
        "certificate.says": "message",
        "alternative.explains": "is_sufficient",
        "alternative.parts_at": "differs_from_hz",
        "alternative.says": "message",
        "explanations.departure": "relative_deviation",
        "explanations.fall": "deviance_fall",
        "explanations.explains": "is_sufficient",
        "explanations.says": "message",
    },
    "dashpot/frf@1": {},
    "dashpot/hyperelastic@1": {".found": "values"},
    "dashpot/impact@1": {},
    "dashpot/indentation@1": {".of": "quantity"},
    "dashpot/inspection@1": {},
    "dashpot/job@1": {
        ".cuts": "time_limits",
        ".further": "other_tests",
        "reading.own": "file_options",
        "reading_impact.own": "file_options",
    },
    "dashpot/levels@1": {
        ".k3_unseen": "k3_detection_limit",
        ".at": "peaks",
        ".of": "amplitude_unit",
    },
    "dashpot/load-hold@1": {},
    "dashpot/lot-comparison@1": {"differences.alike_within": "equivalence_margin"},
    "dashpot/modes-by-mass@1": {},
    "dashpot/modes@1": {".against": "matched_modes"},
    "dashpot/paper@1": {
        "rows.found": "reproduced",
        "rows.off": "difference",
        ".one_arm": "single_arm",
        "rows.holds": "within_interval",
    },
    "dashpot/plan@1": {"end.named": "if_machine_named"},
    "dashpot/plugged@1": {".found": "values", ".by": "package"},
    "dashpot/prediction@1": {"limits.unseen": "unmeasured", "random.of": "excitation"},
    "dashpot/ramp-hold@1": {".given": "machine_deflection"},
    "dashpot/result@1": {},
    "dashpot/rod@1": {".own_mass": "rod_mass"},
    "dashpot/slam@1": {".found": "values", "hits.lost_part": "lost_fraction"},
    "dashpot/slammed@1": {".answers": "values"},
    "dashpot/study@1": {
        ".unseen": "unmeasured",
        ".further": "other_tests",
        ".at_rest": "static_equilibrium",
        "point.given": "is_stated",
        **_BOUNDS,
    },
    "dashpot/verification@1": {},
}
"""New keys by former schema and former key, which follows the key of the object that holds it.

``".says"`` stands in the document itself, ``"certificate.says"`` in the object, or in each of the
array, under ``"certificate"``.
"""

FORMER_PROJECT = "dashpot/project@1"

RENAMED_CHECKS: dict[str, str] = {
    "aging_answer_known": "aging_prediction_determined",
    "aging_beside_drift": "aging_exceeds_cell_drift",
    "asked_in_band": "frequencies_in_band",
    "bands_meet": "bands_overlap",
    "base_band_informed": "base_band_in_valid_band",
    "capability_as_asked": "capability_requirement_met",
    "causal": "stiffness_causal",
    "cell_holds": "load_cell_zero_stable",
    "chemistry_seen": "chemical_aging_resolved",
    "closing_informed": "closing_in_valid_band",
    "cold_bears_lower_energy": "robust_to_lower_activation_energy",
    "compliance_followed": "compliance_residual_small",
    "conditioned": "specimen_conditioned",
    "constants_known": "constants_determined",
    "contact_found": "contact_detected",
    "delay_believable": "delay_plausible",
    "displacement_followed": "displacement_residual_small",
    "door_held": "door_supported",
    "door_modes_informed": "door_modes_in_valid_band",
    "drift_believable": "drift_plausible",
    "drift_is_no_flow": "drift_distinguished_from_flow",
    "drift_told_from_arm": "drift_distinguished_from_arm",
    "earlier_fit_kept": "hammer_agrees_with_earlier_fit",
    "element_explains": "fractional_model_suffices",
    "end_level": "curve_level_at_end",
    "energy_lost": "no_energy_gained",
    "families_told_apart": "model_families_distinguished",
    "faster_doors_close": "faster_closings_latch",
    "few_arms_suffice": "few_arms_sufficient",
    "fit_is_tested": "measurement_independent_of_fit",
    "flow_prevails": "flow_exceeds_slow_retardation",
    "flow_told": "flow_distinguished",
    "foam_no_closer": "compressible_law_no_better",
    "force_followed": "force_residual_small",
    "former_result_recomputed": "earlier_result_reproduced",
    "frequencies_informed": "valid_band_exists",
    "gain_believable": "gain_plausible",
    "gauge_tells_apart": "gauge_discriminates",
    "gravity_known": "gravity_stated",
    "hammer_felt": "impact_force_measurable",
    "history_forgotten": "earlier_loading_negligible",
    "hold_followed": "hold_residual_small",
    "inside_identified_band": "inside_valid_band",
    "k_inf_believable": "k_inf_plausible",
    "k_inf_known": "k_end_determined",
    "law_followed": "law_residual_small",
    "leak_speed_known": "leak_speed_determined",
    "length_given": "length_stated",
    "level_covered": "amplitude_in_tested_range",
    "level_matters": "amplitude_dependence_detected",
    "levels_as_struck": "levels_as_stated",
    "levels_followed": "levels_residual_small",
    "levels_held": "levels_controlled",
    "line_holds_sideways": "lateral_restraint_present",
    "lines_of_one_solid": "single_solid_explains_lines",
    "loading_returned": "loading_reversible",
    "loss_factor_known": "loss_factor_determined",
    "loss_followed": "loss_residual_small",
    "losses_agree": "loss_factors_agree",
    "mass_believable": "mass_plausible",
    "mass_beside_rod": "mass_ratio_suitable",
    "mass_line": "high_frequency_mass_agrees",
    "memories_agree": "relaxation_tests_agree",
    "memory_explains": "relaxation_explains_hysteresis",
    "memory_kept": "arms_agree_with_relaxation_test",
    "memory_suffices": "single_relaxation_explains_speeds",
    "memory_told": "relaxation_times_determined",
    "modes_told": "unmeasured_modes_determined",
    "no_law_closer": "no_better_law",
    "no_unit_slip": "no_unit_error",
    "nominal_informed": "nominal_in_valid_band",
    "offset_believable": "offset_plausible",
    "one_solid": "single_solid_explains_masses",
    "optimum_found": "optimiser_converged",
    "ovens_on_a_line": "single_activation_energy_explains_ovens",
    "overlap": "isotherms_overlap",
    "parameters_known": "parameters_determined",
    "piece_length_given": "specimen_length_stated",
    "pieces_capable": "specimens_capable",
    "pieces_tested_alike": "specimens_tested_alike",
    "plateau_told": "plateau_determined",
    "prediction_informed": "prediction_in_valid_band",
    "ramp_followed": "ramp_residual_small",
    "range_used": "load_cell_range_used",
    "readings_close": "readings_residual_small",
    "readings_renewed": "readings_not_repeated",
    "readings_scatter": "readings_residuals_random",
    "relaxation_still_explained": "hammer_agrees_with_relaxation_test",
    "released_freely": "no_adhesion_on_release",
    "repeatability_known": "repeatability_determined",
    "residuals_random": "residuals_white",
    "rod_usable": "modulus_determined_near_resonance",
    "rows_informed": "rows_in_valid_band",
    "scatter_known": "line_errors_stated",
    "separable": "depth_and_time_separable",
    "shapes_known_there": "mode_shapes_cover_points",
    "shear_usual": "shear_stiffness_plausible",
    "shifts_told_apart": "shifts_distinguished",
    "sideways_agrees": "lateral_swelling_agrees",
    "slam_mass_agrees": "impact_mass_agrees",
    "slam_speeds_agree": "impact_speeds_agree",
    "slam_speeds_spread": "impact_speeds_spread",
    "slam_within_band": "impact_in_valid_band",
    "slam_within_law": "impact_within_measured_depth",
    "slams_apart": "impacts_separated",
    "slams_followed": "impacts_residual_small",
    "slams_sampled": "impacts_sampled",
    "slams_without_more": "impact_residual_structureless",
    "slope_known": "fractional_slope_determined",
    "slow_arms_known": "slow_arms_determined",
    "slowest_relaxed": "slowest_stroke_quasi_static",
    "speed_even": "plate_speed_constant",
    "speeds_followed": "speeds_residual_small",
    "spring_unseen": "no_hidden_cubic_spring",
    "stands_out_of_lot": "no_lot_outlier",
    "step_bias": "ramp_accounted_for",
    "steps_of_one_unit": "clock_unit_constant",
    "stiffness_believable": "stiffness_plausible",
    "stiffness_of_one_seal": "vertical_shift_plausible",
    "stroke_within_memory": "stroke_within_relaxation_times",
    "tangent_told": "tangent_determined",
    "temperatures_in_line": "no_temperature_outlier",
    "travel_renewed": "displacement_samples_not_repeated",
    "use_measured": "use_range_measured",
    "vertical_shift_known": "vertical_shift_determined",
    "volume_known": "bulk_modulus_determined",
    "ways_agree": "up_and_down_sweeps_agree",
    "window_known": "window_decay_determined",
    "zero_known": "zero_stress_at_zero_strain",
}
"""New names of checks by former name."""


def name_present_schema(schema: str) -> str:
    """Return the name of the version that is written now of a schema.

    >>> name_present_schema("dashpot/fit@1"), name_present_schema("dashpot/model@1")
    ('dashpot/fit@2', 'dashpot/model@1')
    """
    if schema in RENAMED_KEYS or schema == FORMER_PROJECT:
        return f"{schema.partition('@')[0]}@2"
    return schema


def convert_document(document: Any) -> Any:
    """Return a document, or part of one, under the present keys, schemas and names of checks.

    A digest of a former version is omitted: its input no longer exists.
    """
    return _convert(document, "", "", is_former=False)


def _convert(value: Any, schema: str, parent: str, *, is_former: bool) -> Any:
    if isinstance(value, list):
        return [_convert(item, schema, parent, is_former=is_former) for item in value]
    if not isinstance(value, dict):
        return RENAMED_CHECKS.get(value, value) if is_former and parent == _FAILED else value
    stated_schema = value.get("schema")
    if isinstance(stated_schema, str):
        schema, parent, is_former = stated_schema, "", stated_schema in RENAMED_KEYS
    if not is_former:
        return {key: _convert(item, schema, key, is_former=False) for key, item in value.items()}
    keys = {**EVERYWHERE, **RENAMED_KEYS[schema]}
    entries = {}
    for key, item in value.items():
        if key == "schema" and parent == "":
            entries[key] = name_present_schema(schema)
        elif key != "digest" or parent:
            key_path = f"{parent}.{key}"
            child = _FAILED if key_path == "verdict.because" else key
            name = keys.get(key_path, key)
            if name in entries or (name != key and name in value):
                raise ReadError(f'the keys "{key}" and "{name}" of the document are one: drop one')
            entries[name] = _convert(item, schema, child, is_former=True)
    return _name_check(entries) if parent == "checks" else entries


_FAILED = "verdict.because"


def _name_check(check: Mapping[str, Any]) -> dict[str, Any]:
    name = check.get("name")
    return {**check, "name": RENAMED_CHECKS.get(name, name) if isinstance(name, str) else name}
