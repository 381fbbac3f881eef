# ruff: noqa: E501  names of tests
"""Dear tests: how many cases of each run every time; the others wait for ``pytest -m slow``.

Measured on two cores; a test with many cases keeps some from both ends and the middle. What is cut
to none is a study or a story whose parts cheaper tests beside it hold.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any

KEPT: Mapping[str, int] = MappingProxyType({
    "base/test_capability.py::test_the_interval_of_cpk_holds_the_truth_as_often_as_it_says": 3,
    "cli/test_cld.py::test_records_at_several_speeds_are_one_seal": 0,
    "cli/test_closing.py::test_every_term_has_its_table": 0,
    "cli/test_example.py::test_three_depths_have_one_elastic_law": 0,
    "cli/test_level.py::test_frfs_of_three_levels_foretell_a_fourth": 0,
    "cli/test_level.py::test_what_a_lag_between_the_channels_does_to_loops_is_said": 0,
    "cli/test_mistakes.py::test_a_mistake_is_answered_with_what_to_do": 97,
    "cli/test_rod.py::test_complex_columns_and_two_accelerometers_tell_the_same": 0,
    "cli/test_rod.py::test_what_is_spoilt_is_named": 3,
    "cli/test_wrong_files.py::test_a_comparison_draws_the_bound_where_the_record_is_at_hand": 0,
    "cli/test_wrong_files.py::test_predict_reads_its_record_as_it_is_told": 0,
    "cli/test_wrong_files.py::test_units_of_columns_of_either_file_are_known": 0,
    "door/test_closing.py::test_half_the_step_and_the_order_of_stations_change_nothing": 0,
    "door/test_closing.py::test_the_interval_holds_a_seal_whose_fast_arms_look_like_clocks": 2,
    "engine/test_batch.py::test_doubtful_records_have_the_optimum_of_their_own_fit": 3,
    "engine/test_reduced.py::test_the_band_on_an_uneven_clock": 0,
    "engine/test_separable.py::test_no_order_left_out_could_have_gained": 6,
    "engine/test_whitening.py::test_the_fall_of_the_deviance_under_slow_noise_is_chance": 0,
    "export/test_calculix.py::test_frf_within_1e_4_of_the_model": 5,
    "export/test_calculix.py::test_pressed_far_it_pushes_as_the_model_does": 1,
    "export/test_levels.py::test_calculix_follows_the_loops": 1,
    "export/test_levels.py::test_calculix_marches_arms_and_sliders": 0,
    "fitting/test_bands.py::test_the_bands_hold_the_truth": 1,
    "fitting/test_bands.py::test_the_measured_frf_lies_in_the_band": 0,
    "fitting/test_bounds_on_trials.py::test_the_bounds_hold_on_a_few_kinds": 1,
    "fitting/test_creep.py::test_noise_of_the_load_is_in_the_errors": 0,
    "fitting/test_depth.py::test_noise_alone_does_not_make_depths_differ": 0,
    "fitting/test_dynamic.py::test_large_noise_brings_no_bias": 0,
    "fitting/test_explanations.py::test_a_wrong_mass_is_found_whatever_else_is_held": 1,
    "fitting/test_explanations.py::test_seals_that_harden_agree_at_the_masss_own_compression": 0,
    "fitting/test_explanations.py::test_stiffer_seals_under_the_hammer_are_told_as_that": 1,
    "fitting/test_explanations.py::test_two_causes_at_once_are_not_explained_by_one": 0,
    "fitting/test_fitting_rig.py::test_intervals_bear_a_wander_that_the_scatter_hides": 1,
    "fitting/test_fitting_rig.py::test_intervals_cover_the_truth_under_correlated_noise": 1,
    "fitting/test_fitting_rig.py::test_no_arm_too_many_under_slow_noise_at_any_rate": 2,
    "fitting/test_fitting_rig.py::test_the_right_number_of_arms": 6,
    "fitting/test_fractional.py::test_a_fault_of_the_bench_leaves_a_fractional_seal_one": 1,
    "fitting/test_fractional.py::test_a_fractional_seal_is_found_and_its_loss_foretold": 2,
    "fitting/test_fractional.py::test_a_seal_of_arms_keeps_them": 2,
    "fitting/test_fractional.py::test_a_seal_that_is_not_linear_is_not_called_fractional": 2,
    "fitting/test_fractional.py::test_its_intervals_hold_it_in_thirty_records": 0,
    "fitting/test_joint.py::test_tests_that_contradict_each_other_are_noticed": 0,
    "fitting/test_left_open.py::test_an_arm_slower_than_the_hold_is_left_open": 3,
    "fitting/test_left_open.py::test_several_depths_leave_open_what_the_deepest_feels": 0,
    "fitting/test_nonlinear_ramp.py::test_muscle_gives_the_k_inf_of_its_hold": 4,
    "fitting/test_spectrum.py::test_large_noise_brings_no_bias": 0,
    "fitting/test_temperatures.py::test_a_cold_test_narrows_what_unseen_arms_may_do": 0,
    "fitting/test_temperatures.py::test_a_temperature_that_was_noted_wrong_is_no_law": 1,
    "fitting/test_temperatures.py::test_quasi_random_starts_find_the_same_solid": 0,
    "fitting/test_temperatures.py::test_what_is_no_one_solid_is_not_passed_as_one": 1,
    "io/test_bombs.py::test_a_bomb_costs_a_gibibyte_and_half_a_minute_at_most": 4,
    "io/test_bombs.py::test_what_is_linked_twice_is_read_once": 0,
    "io/test_fuzz.py::test_long_and_strange": 2,
    "io/test_patterns.py::test_a_quadratic_one_is_caught": 0,
    "io/test_patterns.py::test_every_pattern_takes_a_time_in_proportion_to_its_text": 0,
    "io/test_silently_wrong.py::test_marks_are_judged_by_every_row": 0,
    "kinds/hyperelastic/test_fit.py::test_intervals_hold_the_truth_nineteen_times_in_twenty": 0,
    "kinds/hyperelastic/test_fit.py::test_modes_that_part_by_a_factor_are_told": 2,
    "kinds/indentation/test_collision.py::test_what_is_no_collision": 0,
    "kinds/indentation/test_fit.py::TestTruths::test_a_fall_is_pulled_on": 0,
    "kinds/indentation/test_fit.py::test_no_valley_of_a_relaxing_contact_is_lower": 0,
    "kinds/indentation/test_fit.py::test_slopes_are_those_of_the_model": 4,
    "kinds/indentation/test_fit.py::test_the_interval_is_that_of_all_valleys": 0,
    "kinds/level/test_fit.py::TestLevels::test_a_spring_that_stiffens_is_told_from_friction": 2,
    "kinds/level/test_fit.py::TestLevels::test_its_intervals_hold_the_truth": 0,
    "kinds/level/test_fit.py::TestLevels::test_what_is_told_wrong_or_lies_outside_is_no_use": 5,
    "kinds/level/test_fit.py::TestSweep::test_a_spring_that_is_not_seen_lies_below_its_bound": 1,
    "kinds/level/test_fit.py::TestSweep::test_a_spring_that_stiffens_is_no_friction": 0,
    "kinds/level/test_fit.py::TestSweep::test_friction_that_is_not_the_laws_is_no_spring": 1,
    "kinds/level/test_fit.py::TestSweep::test_its_errors_hold_the_truth": 0,
    "kinds/rod/test_prepare.py::test_sensors_apart_are_put_right_at_rest": 2,
    "lots/statistics/test_gauge.py::test_intervals_hold_the_truth_as_often_as_they_say": 1,
    "lots/statistics/test_scatter.py::test_an_unbalanced_design_is_unbiased": 0,
    "lots/statistics/test_scatter.py::test_intervals_hold_the_truth_as_often_as_they_say": 1,
    "lots/test_cluster.py::test_a_cluster_makes_the_same_table_though_a_worker_is_killed": 0,
    "lots/test_lot.py::test_a_file_that_its_workers_die_of_is_a_row_and_is_tried_again": 0,
    "lots/test_lot.py::test_a_part_that_is_damaged_is_made_again": 0,
    "lots/test_lot.py::test_interrupted_it_says_what_is_kept_and_goes_on_from_there": 0,
    "lots/test_lot.py::test_killed_at_random_and_run_again_the_table_is_the_same": 0,
    "lots/test_row.py::test_a_lot_of_pieces_is_judged_by_their_force": 0,
    "lots/test_watching.py::test_many_tests_one_by_one_end_in_few_parts": 0,
    "lots/test_watching.py::test_the_command_keeps_the_page_and_ends_on_a_signal": 0,
    "preparation/test_machine.py::test_a_motion_that_was_sampled_well_is_not_doubted": 1,
    "preparation/test_preparation.py::test_onset_ramp_depth_and_hold_of_the_virtual_rig": 12,
    "report/test_in_browser.py::test_a_phone_shows_all_of_it_in_letters_that_can_be_read": 1,
    "report/test_in_browser.py::test_a_phone_shows_the_first_number_on_its_first_screen": 1,
    "solids/test_friction.py::TestSeries::test_a_bare_slider_behind_arms_is_what_its_path_settles_to": 2,
    "solids/test_friction.py::test_the_equivalent_stiffness_is_that_of_the_path": 8,
    "test_facts.py::test_levels_say_the_same_on_page_and_in_app": 1,
    "test_public_face.py::test_every_public_name_is_there_first_and_alone": 0,
    "test_sentences.py::test_a_disturbed_record_is_answered_in_words": 0,
    "test_sentences.py::test_every_simulated_kind_is_answered_in_words": 2,
    "test_sentences.py::test_two_tests_that_disagree_are_answered_in_words": 0,
    "test_verdict.py::test_a_noise_free_perfect_pair_fails_nothing": 0,
    "verbs/test_verbs.py::test_a_file_is_read_and_fitted_as_what_it_is": 3,
    "verbs/test_verbs.py::test_vibration_under_a_mass_is_one_solid": 0,
    "vibration/test_impact.py::test_a_mode_lies_within_its_error": 0,
    "vibration/test_impact.py::test_drifting_accelerometers_are_not_of_opposite_polarity": 0,
    "vibration/test_impact.py::test_offsets_do_not_reach_the_frf": 2,
    "vibration/test_impact.py::test_the_random_error_is_the_scatter": 0,
    "vibration/test_impact.py::test_the_simulated_seals_come_back": 2,
    "vibration/test_impact.py::test_without_an_anti_alias_filter_the_edges_of_the_pulse_alias": 0,
    "vibration/test_level.py::TestPublished::test_one_harmonic_and_three": 2,
    "vibration/test_modes.py::test_every_method_reads_a_long_record": 2,
    "vibration/test_modes.py::test_every_method_takes_noise_and_says_its_error": 2,
    "vibration/test_modes.py::test_the_exponential_window_leaves_no_trace": 2,
    "vibration/test_part.py::TestCommand::test_a_geometry_that_is_none": 5,
    "vibration/test_relative.py::test_the_command_line_takes_it": 0,
    "vibration/test_relative.py::test_what_a_file_of_a_relative_motion_gets_wrong": 5,
    "vibration/test_rocking.py::test_damping_survives_hits_off_centre": 0,
    "vibration/test_rocking.py::test_the_mean_hears_no_rocking_where_one_accelerometer_is_deaf_for_it": 0,
    "vibration/test_systems.py::test_two_ways_to_the_same_modes": 0,
    "vibration/test_transmissibility.py::TestRandomBase::test_limits_of_white_noise_say_which_part_they_count": 0,
    "vibration/test_transmissibility.py::TestRandomBase::test_the_limits_hold_what_the_test_cannot_see": 0,
    "vibration/test_transmissibility.py::test_a_file_of_another_lab_is_compared_and_identified": 1,
    "vibration/test_transmissibility.py::test_a_solid_is_identified_on_a_base_whatever_its_sensors_gain_and_delay": 1,
    "vibration/test_transmissibility.py::test_the_first_lines_say_what_a_degree_and_a_percent_do": 0,
    "vibration/test_transmissibility.py::test_the_limits_are_those_of_what_is_predicted": 0,
    "web/test_journeys.py::test_a_warm_and_a_cold_test_are_fitted_together": 0,
    "web/test_journeys.py::test_nothing_is_cut_at_any_width": 0,
    "web/test_journeys.py::test_words_are_readable": 1,
    "web/test_work.py::test_a_deck_is_refused_as_on_the_command_line_and_written_anyway": 0,
    "web/test_work.py::test_a_hit_is_left_out_by_hand": 0,
    "web/test_work.py::test_a_warm_and_a_cold_test_share_one_solid": 0,
    "web/test_work.py::test_the_command_line_gives_the_pages_numbers": 1,
    "workflow/test_left_out.py::test_hits_left_out_in_turn_are_predicted": 0,
    "workflow/test_project.py::test_killed_at_any_write_nothing_is_lost": 2,
    "workflow/test_project.py::test_what_was_said_of_reading_is_kept_as_a_profile": 0,
    "workflow/test_project.py::test_who_notes_the_head_misses_even_a_forged_end": 0,
    "workflow/test_study.py::test_a_mass_that_is_not_given_is_inferred_and_labelled": 0,
    "workflow/test_temperatures.py::test_a_hammer_joins_tests_at_several_temperatures": 0,
    "workflow/test_temperatures.py::test_a_hammer_of_another_temperature_has_its_own_shift": 0,
    "workflow/test_temperatures.py::test_a_prediction_at_a_temperature_is_within_its_bounds": 1,
    "workflow/test_temperatures.py::test_the_main_job_takes_a_cold_test_too": 0,
})  # fmt: skip
"""Cases of each dear test that run every time."""


def waiting(items: Iterable[Any], root: str = "tests/") -> list[Any]:
    """The cases among collected tests that are not run every time."""
    cases: dict[str, list[Any]] = defaultdict(list)
    for item in items:
        name = item.nodeid.partition("[")[0].removeprefix(root)
        if name in KEPT:
            cases[name].append(item)
    found = []
    for name, each in cases.items():
        kept = spread(len(each), KEPT[name])
        found += [item for i, item in enumerate(each) if i not in kept]
    return found


def spread(count: int, kept: int) -> set[int]:
    """So many of the numbers below a count, from both ends and between.

    >>> sorted(spread(7, 3)), spread(5, 1), spread(3, 0)
    ([0, 3, 6], {0}, set())
    """
    if kept < 2:
        return set(range(min(kept, count)))
    return {round(i * (count - 1) / (kept - 1)) for i in range(kept)}
