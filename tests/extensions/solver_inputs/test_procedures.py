"""Each procedure that a header names is run: right is right, and wrong is still wrong."""

from __future__ import annotations

import pytest
from kit import procedures
from kit.procedures import PAGE, SEAL, TASKS, Missing

from dashpot.export import NEEDS, TARGETS
from dashpot.extensions.solver_inputs.procedures import format_procedures, read_runs
from dashpot.solids.maxwell import GeneralizedMaxwell


@pytest.mark.parametrize("task", list(TASKS), ids=" ".join)
def test_every_procedure_is_as_the_table_says(task):
    (run,) = [run for run in read_runs() if (run.target, run.form, *run[3:5]) == task]
    try:
        measure = procedures.measure(*task)
    except Missing as missing:
        pytest.skip(str(missing))
    print(f"{measure:.2e}, in the table {run.deviation:.2e}")
    assert measure <= 1.2 * run.deviation + 1e-6
    if not run.is_right:
        assert measure >= 0.8 * run.deviation, "it is better than the header says: write the table"


def test_the_table_has_what_is_run_and_no_more():
    assert [(run.target, run.form, *run[3:5]) for run in read_runs()] == list(TASKS)


def test_the_page_shows_the_table():
    """``python tests/kit/procedures.py`` writes both."""
    page = PAGE.read_text(encoding="utf-8")
    assert page == procedures.place_matrix(page)


@pytest.mark.parametrize(
    ("target", "form"), sorted({(run.target, run.form) for run in read_runs()})
)
@pytest.mark.parametrize("b", [0.0, 20.0])
def test_the_header_says_what_the_table_says(target, form, b):
    if b and form == "prony":
        pytest.skip("a Prony series holds no parallel dashpot")
    solid = SEAL + GeneralizedMaxwell(0.0, b=b)
    more = dict.fromkeys(NEEDS[target].get(form, ()), 1e6)
    header = TARGETS[target](solid, units="SI", form=form, **more)
    runs = [run for run in read_runs() if (run.target, run.form) == (target, form)]
    damped = any(run.case.endswith("with b") for run in runs)
    for run in runs:
        if damped and run.case.endswith("with b") != (b > 0):
            continue
        (line,) = [
            line for line in header.splitlines()
            if f" {'right' if run.is_right else 'WRONG'} under " in line
        ]  # fmt: skip
        assert run.solver in header
        (message,) = [
            part for part in line.partition(" under ")[2].split("; ")
            if part.startswith(f"{run.procedure}: ")
        ]  # fmt: skip
        assert f"{run.deviation:.1e} {run.case.partition(',')[0]}" in message


def test_where_no_solver_ran_the_header_says_so():
    (message,) = format_procedures("opensees", "of nobody")
    assert message.startswith("not solver-verified: only read")
