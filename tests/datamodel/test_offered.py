"""Output of results: summary, figure, and tables for pandas and xarray."""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
import sys
import textwrap
from html.parser import HTMLParser
from types import SimpleNamespace
from typing import Any, get_args, get_type_hints

import numpy as np
import pytest
from kit import handmade

import dashpot as dp
from dashpot.base.result_mixins import MAX_LINES, HasSummary, HasVerdict, Plottable
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.write import write_relaxation
from dashpot.registry import FIGURES
from dashpot.report.result_output import picture
from dashpot.simulation.impact import Hammer, simulate_impact
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import PAPER
from dashpot.workflow.dataframes import frame


@pytest.fixture(scope="module")
def nouns(tmp_path_factory):
    path = tmp_path_factory.mktemp("seen") / "seal <b>&.csv"
    path.write_text(write_relaxation(handmade.raw_test()))
    study = handmade.study()
    f = np.geomspace(1.0, 100.0, 9)
    K = PAPER.complex_stiffness(omega=2 * np.pi * f)
    return {
        "Fit": study.fit,
        "FRF": study.measured,
        "Comparison": study.comparison,
        "Study": study,
        "Inspection": inspect_file(path),
        "RampHold": study.prepared,
        "RelaxationTest": study.test,
        "ImpactTest": study.impact,
        "DynamicTest": dp.DynamicTest(
            f, K.real, K.imag, temperature=f + 280.0, unit="N/m", units="SI"
        ),
        "RelaxationModulus": dp.RelaxationModulus(f, PAPER.relaxation(f), unit="N/m", units="SI"),
    }


PICTURED = ("Fit", "FRF", "Comparison", "Study", "Inspection", "RampHold")
EVERY = (*PICTURED, "RelaxationTest", "ImpactTest", "DynamicTest", "RelaxationModulus")


@pytest.mark.parametrize("name", EVERY)
def test_a_shell_shows_a_few_lines(nouns, name):
    text = repr(nouns[name])
    assert text.startswith(f"{name}: ")
    assert len(text.splitlines()) <= MAX_LINES
    assert len(text) < 2000
    assert "array(" not in text


def test_a_long_description_is_cut():
    class Long(HasSummary):
        _summary_lines = tuple(f"line {i}" for i in range(40))

    assert len(repr(Long()).splitlines()) == MAX_LINES
    assert repr(Long()).endswith("\n...")
    Long._summary_lines = Long._summary_lines[:MAX_LINES]
    assert repr(Long()).endswith(f"line {MAX_LINES - 1}")


def test_verdicts_lead(nouns):
    for name in ("Fit", "Comparison", "Study"):
        verdict = nouns[name].verdict
        assert repr(nouns[name]).startswith(f"{name}: {verdict}")


class Tags(HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.seen = [], []

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)
        self.seen.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.mark.parametrize("name", PICTURED)
def test_a_notebook_shows_words_and_picture(nouns, name):
    page = nouns[name]._repr_html_()
    tags = Tags()
    tags.feed(page)
    assert tags.open == []
    assert {"pre", "svg", "path"} <= set(tags.seen)
    assert not {"b", "script"} & set(tags.seen)  # a file's name is no markup
    assert page == nouns[name]._repr_html_()
    assert nouns[name].plot().panels


def test_every_plottable_class_has_a_figure() -> None:
    choices = {kind for kind in descendants(Plottable) if kind is not HasVerdict}
    assert len(choices) > 15
    bare = {kind.__name__ for kind in choices if picture.dispatch(kind) is picture.dispatch(object)}
    assert bare <= {name.rpartition(":")[2] for name, figure in FIGURES.items() if figure}


def descendants(kind):
    """Every class that inherits from one."""
    for module in pkgutil.walk_packages(dp.__path__, "dashpot."):
        # the app's values are those of the workflow
        if not module.name.endswith("__main__") and ".web" not in module.name:
            importlib.import_module(module.name)
    result = {kind}
    while new := {subclass for item in result for subclass in item.__subclasses__()} - result:
        result |= new
    return result - {kind}


def test_an_inspection_draws_its_columns_along_the_time(nouns):
    made = nouns["Inspection"].plot()
    assert [panel.y.label for panel in made.panels] == ["displacement [mm]", "force [N]"]
    assert {panel.x.label for panel in made.panels} == {"time [s]"}
    (line,) = made.panels[0].marks
    raw = handmade.raw_test()
    assert line.x[-1] == pytest.approx(raw.time[-1])
    assert line.y[-1] == pytest.approx(1e3 * raw.displacement[-1])
    assert made.stamp.startswith("seal <b>&.csv")


def test_columns_without_numbers_have_no_picture():
    with pytest.raises(dp.DataError, match="no column of numbers"):
        dp.plot.columns(["name", "time [s]"], [None, "time"], np.array([[np.nan, 1.0]] * 3))
    made = dp.plot.columns(["force [N]"], ["force"], np.array([[1.0], [2.0], [np.nan]]))
    assert made.panels[0].x.label.startswith("row")


# -- tables ----------------------------------------------------------------------------------------


def test_every_class_with_a_summary_has_a_table() -> None:
    ours = {kind for kind in descendants(HasSummary) if kind.__module__.startswith("dashpot.")}
    choices = ours - {Plottable, HasVerdict}
    assert len(choices) > 40
    inputs = {
        kind
        for kind in choices
        if kind._table_columns is not HasSummary._table_columns
        or frame.dispatch(kind) is not frame.dispatch(object)
    }
    facts = {
        kind for kind in choices if getattr(kind, "facts", None) not in {None, HasVerdict.facts}
    }
    assert choices == inputs | facts


@pytest.mark.parametrize("name", EVERY)
def test_table_columns_have_equal_length(nouns, name):
    result = frame(nouns[name])
    assert len({len(values) for values in result.columns.values()}) == 1
    assert set(result.units) == set(result.columns)


def types_of(node: ast.expr, names: dict[str, set[type]]) -> set[type]:
    """Return the types that an expression of fields and properties may have; of rows, of each."""
    if isinstance(node, ast.GeneratorExp):
        (loop,) = node.generators
        assert isinstance(loop.target, ast.Name)
        return types_of(node.elt, {**names, loop.target.id: types_of(loop.iter, names)})
    if isinstance(node, ast.Name):
        return names[node.id]
    assert isinstance(node, ast.Attribute)
    return {
        kind
        for owner in types_of(node.value, names)
        for kind in leaves(attribute_type(owner, node.attr))
    }


def attribute_type(owner: type, name: str) -> Any:
    """Return the annotation of a field or a property, None of a class that has neither."""
    declared = inspect.getattr_static(owner, name, None)
    getter = getattr(declared, "fget", None) or getattr(declared, "func", None)
    return get_type_hints(getter)["return"] if getter else get_type_hints(owner).get(name)


def leaves(hint: Any) -> set[type]:
    """Return the classes of an annotation: of a union, and of what a sequence holds."""
    inner = {kind for item in get_args(hint) for kind in leaves(item)}
    return inner or ({hint} if isinstance(hint, type) and hint is not type(None) else set())


def test_columns_of_tables_are_attributes_of_their_rows() -> None:
    count = 0
    for kind in descendants(HasSummary):
        if "_table_columns" not in vars(kind) or not kind.__module__.startswith("dashpot."):
            continue
        tree = ast.parse(textwrap.dedent(inspect.getsource(vars(kind)["_table_columns"].fget)))
        names: dict[str, set[type]] = {"self": {kind}}
        for node in ast.walk(tree):
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Attribute):
                (target,) = node.targets
                assert isinstance(target, ast.Name)
                names[target.id] = types_of(node.value, names)
        for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
            function = getattr(call.func, "id", "")
            if function not in {"collect_columns", "collect_arrays"}:
                continue
            rows = types_of(call.args[0], names)
            if function == "collect_columns" and rows == {kind}:
                rows = leaves(get_type_hints(kind.__getitem__)["return"])  # type: ignore[attr-defined]
            requested = {keyword.arg for keyword in call.keywords if keyword.arg is not None}
            missing = [requested - {*dir(row), *get_type_hints(row)} for row in rows]
            assert set() in missing, f"{kind.__name__}: {rows} has no {missing}"
            count += len(requested)
    assert count > 60


def test_the_table_of_a_fit_holds_its_intervals(nouns):
    fit = nouns["Fit"]
    columns = frame(fit).columns
    at = columns["parameter"].index("tau_2")
    assert columns["value"][at] == fit.model.tau[1]
    assert (columns["low"][at], columns["high"][at]) == fit.intervals()["tau"][1]
    assert columns["unit"][at] == "s"


def test_every_sample_of_an_impact_test_knows_its_record(tmp_path):
    test = simulate_impact(PAPER, mass=0.1, hits=2, rig=Hammer(record=1.0), seed=1).test
    assert [*np.flatnonzero(np.diff(frame(test).columns["record"])) + 1] == [*test.starts[1:]]


def test_without_the_library_the_extra_is_named(nouns, monkeypatch):
    for library in ("pandas", "xarray"):
        monkeypatch.setitem(sys.modules, library, None)  # as if it were not installed
        with pytest.raises(dp.DataError, match=f"{library} is not installed; install it with: "):
            getattr(nouns["FRF"], f"to_{library}")()


class Table(dict):
    """As much of a data frame as is asked for."""

    def __init__(self, columns):
        super().__init__(columns)
        self.attrs = {}

    def set_index(self, name):
        self.index = name
        return self


def test_to_pandas_sets_columns_index_and_units(nouns, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(DataFrame=Table))
    table = nouns["RelaxationTest"].to_pandas()
    assert table.index == "time"
    assert table.attrs["units"] == {"time": "s", "displacement": "m", "force": "N"}
    assert table["force"] is nouns["RelaxationTest"].force


@pytest.mark.parametrize("name", EVERY)
def test_to_pandas_and_to_xarray_accept_every_class(nouns, name):
    pandas, xarray = pytest.importorskip("pandas"), pytest.importorskip("xarray")
    table, data = nouns[name].to_pandas(), nouns[name].to_xarray()
    assert isinstance(table, pandas.DataFrame)
    assert isinstance(data, xarray.Dataset)
    (index,) = data.dims
    assert table.index.name == index
    for column in table.columns:
        np.testing.assert_array_equal(np.asarray(table[column]), data[column].values)
        assert data[column].attrs["units"] == table.attrs["units"][column]


# -- a record as read ------------------------------------------------------------------------------


def test_a_fit_of_a_record_as_read_says_that_it_prepared_it():
    test = simulate_relaxation(PAPER, hold_time=5.0, seed=1).test
    raw, prepared = fit_tests(test, arms=1), fit_tests(prepare(test), arms=1)
    assert raw.model == prepared.model
    assert raw.steps[0].name == "by_default"
    assert "prepared by default" in raw.steps[0].message
    assert raw.steps[1:] == prepared.steps
    both = fit_tests(
        [test, prepare(simulate_relaxation(PAPER, hold_time=5.0, seed=2).test)], arms=1
    )
    assert [step.name for step in both.steps].count("by_default") == 1
    with pytest.raises(dp.FitError, match="found a str"):
        fit_tests(["seal.csv"])
