"""Each concept is implemented in one module; other places are listed with a reason.

A list here may only shrink: a line that is no longer needed fails, as one that is missing does.
"""

from __future__ import annotations

import re
from collections import defaultdict
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[1] / "src/dashpot"

_FACTOR = r"(?:(?<![\w.])(?:1e-?[369]|1000) \*|\* 1e-?[369]\b|/ 1e[369]\b)"
_UNIT = r"(?:[mµu]?m|[mµu]N|ms|g|N/mm|N s/mm|MPa|kHz|um/N|mm/N|1/MPa|mm/s|mJ)"
# beside its unit's word, in a row of a table, or known by its digits
_SCALED = (
    rf"{_FACTOR}[^\n]*[ \"']{_UNIT}(?![\w/])"
    rf"|\"{_UNIT}\"[:,] \(?1e-?\d|\(1e-?[369], \"{_UNIT}\"|273\.15|9\.80665"
)

#: idea -> what shows it, the packages where it lives, and the files that hold something else, with
#: why
IDEAS: dict[str, tuple[str, tuple[str, ...], dict[str, str]]] = {
    "a descent by a library": (
        r"least_squares\(|optimize import .*(nnls|least_squares)",
        # the sliders of one element
        ("extensions/amplitude/friction.py",),
        {},
    ),
    "a damped descent": (
        r"damping \*=|damping \*\*|lstsq\(.*damp|\bmarquardt",
        ("numerics/",),
        {},
    ),
    "a BIC": (
        r"np\.log\(.*(sse|rss|power)|\* np\.log\((n|effective|worth)",
        ("numerics/inference/",),
        {},
    ),
    "a covariance": (
        r"linalg\.pinv\(|linalg\.inv\(",
        ("numerics/", "extensions/batch/arrays/"),
        {
            "extensions/materials/csr/aging_information.py": "an expected covariance of a plan",
            "fitting/valid_band.py": "a posterior of unit priors, sixty times a fit",
            "extensions/systems/free_modes.py": "a change of coordinates",
            "extensions/paper/exponential_sum.py": "errors of a sum of exponentials of arrays",
            "vibration/modal/peaks.py": "a complex parabola, whose covariance is complex",
            "vibration/modal/pole_fit.py": "the information of channels, the inverse of a triangle",
            "extensions/systems/time_response.py": "a mass matrix",
            "extensions/amplitude/preloaded_response.py": "a parabola through three points",
            "extensions/blank_tests/estimation.py": "of a column that is read with noise itself",
            "extensions/preload_map/fit.py": "of groups of lines, with a part common to each sweep",
            "extensions/systems/multibody.py": "the FRF of a system is the inverse of its stiffness",
        },
    ),
    "a rule of correlated residuals": (
        r"1 - rho|def (auto)?correlation\(|def autocovariance\(|lag.?1",
        ("numerics/inference/",),
        {},
    ),
    "a quantile of t": (
        r"t_quantile\(",
        ("numerics/", "base/"),
        {
            "fitting/admissible_spectra.py": "a cut of a deviance, calibrated",
            "fitting/parameter_errors.py": "how deep a stored profile goes",
            "fitting/prediction_bounds.py": "the normal quantile of its limits",
            "extensions/materials/cld/fit_files.py": "a mean of pieces, not of residuals",
            "extensions/batch/acceptance.py": "a guard band of pieces, not of residuals",
            "extensions/batch/statistics/variance_components.py": "a chart of pieces, not of residuals",
            "datamodel/parameter_estimate.py": "a fit's own intervals, of what it keeps of its estimate",
            "vibration/impact/amplitude_trend.py": "the power of a test of a slope",
            "extensions/amplitude/hits_by_amplitude.py": "the interval of a line through hits",
            "extensions/blank_tests/fit.py": "a drift to come, by the few that were seen",
            "extensions/preload_map/fit.py": "lines and sweeps, each with degrees of freedom of its own",
            "extensions/preload_map/separability.py": "a limit of a departure, which is no parameter",
        },
    ),
    "non-negative columns": (
        r"\bnonnegative(_columns)?\(|\bnnls\(",
        ("numerics/", "extensions/batch/arrays/"),
        {"extensions/amplitude/friction.py": "the sliders of one element"},
    ),
    "a factor between units": (
        _SCALED,
        ("base/units.py",),
        {
            "base/value_ranges.py": "prefixes before any unit of SI",
            "extensions/paper/story_handler.py": "a refrigerator is at 0 degC",
            "reading/write.py": "an example of 0 degC",
            "planning/plan.py": "a refrigerator, and an example, are at 0 degC",
            "solids/shift_laws.py": "an example of 0 degC",
            "workflow/example_files.py": "degC into K, where tests are made",
            "extensions/curves/examples.py": "degC into K, where sweeps are made",
            "extensions/curves/datamodel/stress_relaxation.py": "a summary, and an example",
            "extensions/curves/modulus/stress_relaxation.py": "a length of 1 mm as a strain",
            "extensions/solver_inputs/cards/abaqus_cards.py": "what a card is asked to say",
        },
    ),
    "a set of names of checks": (
        r"failed = \{check\.name|check\.name (in|not in) |\.name in \{",
        (),
        {
            "extensions/materials/indentation/checks.py": "names of numbers, not of checks",
            "extensions/amplitude/page.py": "a loop over checks, none by its name",
            "extensions/materials/rod/fit_files.py": "a loop over checks, none by its name",
            "report/result_page.py": "a loop over checks, none by its name",
            "extensions/batch/summary.py": "which of four lights each check is of",
            "planning/plan.py": "the remedies of its own two checks",
            "extensions/materials/csr/lifetime_prediction.py": "which of its checks mark an interval",
            "report/first_screen.py": "checks of a document, which holds their names",
            "workflow/assumptions.py": "the page of assumptions names the checks that ask for each",
            "workflow/study.py": "checks of a document, which holds their names",
        },
    ),
}


def places(pattern: str, homes: tuple[str, ...]) -> set[str]:
    return {
        name
        for path in SOURCE.rglob("*.py")
        if not (name := path.relative_to(SOURCE).as_posix()).startswith(homes)
        and re.search(pattern, path.read_text(encoding="utf-8"))
    }


@pytest.mark.parametrize("idea", IDEAS)
def test_concept_is_implemented_only_in_its_module(idea: str) -> None:
    pattern, homes, others = IDEAS[idea]
    assert all(others.values()), "every other place says why"
    result = places(pattern, homes)
    assert result == set(others), (
        f"{idea} lives in {', '.join(homes)}: call it there; or, if it is another thing, say so"
    )


@pytest.mark.parametrize("idea", [name for name, (_, homes, _) in IDEAS.items() if homes])
def test_concept_pattern_matches_its_module(idea: str) -> None:
    pattern, homes, _ = IDEAS[idea]
    assert any(
        re.search(pattern, path.read_text(encoding="utf-8"))
        for home in homes
        for path in SOURCE.glob(f"{home}**/*.py" if home.endswith("/") else home)
    )


def test_class_name_is_unique() -> None:
    """An underscore makes no other word."""
    homes = defaultdict(list)
    for path in sorted(SOURCE.rglob("*.py")):
        for name in re.findall(r"(?m)^class _*(\w+)", path.read_text(encoding="utf-8")):
            homes[name].append(path.relative_to(SOURCE).as_posix())
    assert len(homes) > 300
    twice = {name: places for name, places in homes.items() if len(places) > 1}
    assert not twice, "two classes of one name: make them one, or say what each is"
