"""k_inf is an upper limit, and the same one, wherever a fit is read."""

from __future__ import annotations

import json
import math
import re
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from kit.fits import solid_errors, solid_intervals
from kit.foreign.slow_arms import SlowPair, slow_pairs
from kit.shell import ran

import dashpot as dp
from dashpot import workflow
from dashpot.datamodel.fit import (
    list_arm_values,
    list_model_values,
)
from dashpot.reading.read_options import ReadOptions
from dashpot.report.result_page import kind_page
from dashpot.text_output import results as text_of
from dashpot.workflow.json_archive import from_json, to_json

FILES = {
    "relaxation": ("seal_8mm.csv", {"arms": 2}),
    "hold alone": ("seal_8mm.csv", {"arms": 2, "method": "hold"}),
    "fractional": ("seal_8mm.csv", {"family": "fractional"}),
    "modulus": ("curve.csv", {"options": ReadOptions(modulus="E(t)")}),
    "sweep": ("sweep.csv", {}),
}
OTHERS = ("joint", "hammer", "in parallel", "at a compression", "temperatures", "warmer")
DECKS = (("nastran", "arms"), ("ansys", "prony"), ("csv", "arms"), ("statespace", "octave"))


def fits_of(pair: SlowPair, folder: Path) -> tuple[dp.Fit, dp.Fit]:
    """The joint fit of a bench and a hammer record, and that of the hammer alone."""
    file = folder / "hammer.csv"
    file.write_text(pair.hammer.text(), encoding="utf-8")
    hits, bench = dp.read(file), pair.bench
    test = dp.RelaxationTest(bench.time, bench.displacement, bench.force, units="SI")
    under = {"mass": pair.hammer.truth["mass"], "seals": pair.hammer.truth["seals"]}
    return dp.fit(test, hits, **under), dp.fit(hits, **under)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bench")
    assert ran("demo", "--files", "--all", "-o", folder).exit_code == 0
    fits = {
        name: workflow.fit_files((str(folder / file),), **how)[0]
        for name, (file, how) in FILES.items()
    }
    fits["joint"], fits["hammer"] = fits_of(next(slow_pairs(1, seed=1)), folder)
    fits["in parallel"] = fits["joint"].in_parallel(2)
    fits["at a compression"] = fits["relaxation"].at_compression(4e-3)
    cold = tuple(str(folder / f"at_{item}degC.csv") for item in ("23", "10", "0"))
    fits["temperatures"] = workflow.fit_files(cold)[0]
    fits["warmer"] = fits["temperatures"].at_temperature("15degC")
    return fits


@pytest.mark.parametrize("name", [*FILES, *OTHERS])
def test_every_output_states_the_same_limit_of_k_inf(results, name):
    fit = results[name]
    fact = next(value for value in list_model_values(fit) if value.name == "k_inf")
    most = fact.high
    assert fact.is_at_most
    assert most >= fit.model.k_inf
    # Python
    assert fit.intervals()["k_inf"] == (0, pytest.approx(most))
    assert solid_intervals(fit)["k_inf"] == (0, pytest.approx(most))
    assert math.isnan(fit.standard_error["k_inf"])
    assert math.isnan(solid_errors(fit)["k_inf"])
    if fit.stiffness_limits is not None:
        assert fit.stiffness_limits["k_inf"] == (0, pytest.approx(most))
    # documents, and what is read back
    document = json.loads(to_json(fit))
    assert document["standard_error"]["k_inf"] is None
    assert document["interval_95"]["k_inf"] == [0, pytest.approx(most)]
    again = from_json(to_json(fit))
    assert list_arm_values(again)[0] == list_arm_values(fit)[0]
    # text and page
    printed = f"{fact.cells.interval}"
    assert printed in "\n".join(text_of.render_fit(fit).lines)
    page = kind_page(fit)
    if page is not None:
        rows = [row for group in page.groups for row in group.rows]
        (stated,) = [row for row in rows if row.name in {"At rest, k∞", "Below the band"}]
        assert stated.low == "unknown"
        assert float(stated.high) == pytest.approx(fact.to_display_unit(most), rel=2e-3)
    # solver inputs
    specimen = dp.Specimen(temperature=fit.specimen.temperature or 296.15, length=0.1)
    for solver, form in DECKS:
        if fit.unit == "Pa" and form != "prony":
            continue
        deck = dp.export(
            fit, to=solver, form=form, unit_system="SI", specimen=specimen, allow="all"
        )
        line = next(line for line in str(deck).splitlines() if "k_inf is at most" in line)
        assert float(line.split("at most")[1].split()[0]) == pytest.approx(most, rel=1e-3)


@pytest.mark.parametrize("number", range(30))
def test_an_arm_slower_than_the_tests_leaves_k_inf_inside_its_limit(number, tmp_path):
    pair = next(islice(slow_pairs(number + 1, seed=2), number, None))
    for fit in fits_of(pair, tmp_path):
        low, high = fit.intervals()["k_inf"]
        assert low <= pair.seal.solid.k_inf <= high
        now = {
            parameter_change.name: parameter_change.now
            for parameter_change in fit.evidence.parameter_changes
        }.get("k_inf", fit.facts[0])
        assert now.error is None
        assert now.high == pytest.approx(high)
        assert not any("with a standard error" in check.message for check in fit.checks)


def test_a_fit_for_use_is_written_and_its_notes_are_no_failed_checks(results):
    for fit in results.values():
        if fit.verdict.use != "use" or fit.unit == "Pa":
            continue
        specimen = dp.Specimen(temperature=fit.specimen.temperature or 296.15, length=0.1)
        deck = str(dp.export(fit, to="nastran", form="arms", unit_system="SI", specimen=specimen))
        assert "CHECK FAILED" not in deck
        assert "USE: " in deck
        notes = [check for check in fit.checks if check.failed]
        assert deck.count("NOTE: ") == len(notes)
        counted = re.search(r"All \d+ checks passed|\d+ checks? passed", fit.verdict.message)
        assert counted is None or counted[0] in deck


def test_the_limit_moves_with_temperature_and_stiffness(results):
    cold, warm = results["temperatures"], results["warmer"]
    ends = cold.evidence.end_of_hold, warm.evidence.end_of_hold
    if ends[0] is None:
        assert ends[1] is None
        return
    b_t = warm.model.k_inf / cold.model.k_inf
    assert ends[1].k_inf[1] >= 0.999 * b_t * ends[0].k_inf[1]
    assert np.isclose(
        ends[1].compute_stiffness(warm.model),
        b_t * ends[0].compute_stiffness(cold.model),
        rtol=1e-3,
    )
    assert ends[1].end_time == pytest.approx(ends[0].end_time * cold.temperatures.law.a_t(288.15))
