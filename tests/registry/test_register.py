"""The registry of kinds: every row refers to functions, options and columns that exist."""

from __future__ import annotations

import ast
import inspect
import json
import re
from collections.abc import Callable
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import get_args

import pytest

import dashpot as dp
from dashpot.base.checks import REGISTER, Check, Remedy
from dashpot.base.reported_values import ReportedValue
from dashpot.base.serialisation import Serialisable
from dashpot.cli import COMMANDS
from dashpot.extensions.amplitude.fit_frfs import fit_levels
from dashpot.extensions.app.page_form import get_form
from dashpot.extensions.batch.columns import NUMBER_COLUMNS
from dashpot.extensions.blank_tests.fit_files import fit_blank_files
from dashpot.extensions.curves.creep.compliance import measured_compliance
from dashpot.extensions.curves.creep.preprocess import load_hold
from dashpot.extensions.curves.creep.simulation import simulate_creep
from dashpot.extensions.curves.datamodel.creep import CreepTest
from dashpot.extensions.curves.datamodel.stress_relaxation import StressRelaxationTest
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.extensions.materials.csr.aging_plan import plan_aging
from dashpot.extensions.materials.csr.fit_files import csr_files
from dashpot.extensions.materials.csr.lifetime_prediction import predict_aging
from dashpot.extensions.materials.hyperelastic.fit import fit_hyperelastic
from dashpot.extensions.materials.hyperelastic.read import read_stress_strain
from dashpot.extensions.plugins.datamodel import PluginFit
from dashpot.extensions.preload_map.fit import fit_preload_map
from dashpot.extensions.preload_map.read import read_sweeps
from dashpot.plot.picture import Picture
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.columns.file_kinds import KINDS_OF_FILE, SWEEP_KINDS, FileKind
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.registry import (
    EXTENSIONS,
    KINDS,
    Extension,
    KindOfTest,
    LotSpecimen,
    figure_of,
    find_handler,
    find_kinds_by_option,
    list_names,
    load_object,
    row_of,
)
from dashpot.solids.demo_seals import PAPER
from dashpot.workflow.example_files import FILES
from dashpot.workflow.inspections import inspect_files
from dashpot.workflow.json_archive import from_json, schemas, to_json

ROWS = [pytest.param(kind, id=kind.name) for kind in KINDS.values()]
WITHOUT_FIT = {"rod"}
"""Kinds that a file is said to be, and not recognised as."""
NO_EXAMPLE = {
    "master-curve",
    "strain-sweep",
    "temperature-sweep",
    "single-frequency",
    "creep",
    "rod",
    "plug-in",
    "blank",
}
EXTRA_ROWS = {
    "cld": LotSpecimen(ReadOptions()),
    "indentation": LotSpecimen(ReadOptions(), mass=5e-3, radius=5e-3),
    "csr": LotSpecimen(ReadOptions()),
    "cyclic": LotSpecimen(ReadOptions()),
}


def words(kind: KindOfTest) -> list[str]:
    return [
        word
        for word in (
            kind.reader, kind.fit, kind.lot_row, kind.examples, *kind.classes,
            *kind.classes.values(),
            *kind.pages, *kind.pages.values(),
        )
        if word
    ]  # fmt: skip


SOURCE = Path(dp.__file__).parent
NAMED = {
    "cli/": "a command is called so, too",
    "reading/columns/file_kinds.py": "names of kinds",
    "reading/columns/kind_detection.py": "what a table must hold",
    "reading/readers/": "which files a reader takes",
    "extensions/curves/": "each kind is its own",
    "extensions/materials/": "each kind is its own",
    "extensions/amplitude/": "each kind is its own",
    "extensions/guidance/": "what users call a kind",
    "signals/": "what the moves of a record show",
}
"""Where a kind of file is named, and why; everybody else asks the register."""


def test_nobody_else_names_a_kind() -> None:
    # such as "creep" are words of much else
    kinds = {"cld", "indentation", "stress-strain", "cyclic", "dma", "csr", *SWEEP_KINDS}
    texts = {path: path.read_text(encoding="utf-8") for path in SOURCE.rglob("*.py")}
    posixes = {
        path.relative_to(SOURCE).as_posix()
        for path, text in texts.items()
        if any(f'"{kind}"' in text for kind in kinds)  # to parse every file takes seconds
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Constant) and node.value in kinds
    }
    places = {
        next((reference for reference in NAMED if name.startswith(reference)), name)
        for name in posixes
    }
    assert places == set(NAMED)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("examples")
    for name, file in FILES.items():
        if file.kind or name.startswith("rig_"):
            (place / name).write_text(file.write(), encoding="utf-8")
    return place


def test_every_recognised_kind_is_registered() -> None:
    assert set(KINDS_OF_FILE) == set(get_args(FileKind)) - {"not-a-test", "unclear"}
    assert set(KINDS) - WITHOUT_FIT == set(KINDS_OF_FILE)


@pytest.mark.parametrize("kind", ROWS)
def test_every_reference_of_a_kind_resolves(kind: KindOfTest) -> None:
    for word in words(kind):
        assert load_object(word) is not None
    for result in kind.classes:
        assert isinstance(load_object(result), type)
    if kind.app_form:
        assert get_form(kind.name)
        assert callable(load_object(f"{kind.app_form}:fit_form_files"))
    assert not kind.alternative_kind or KINDS[kind.alternative_kind].app_form
    if kind.checks:
        stage = load_object(f"{kind.checks}:__name__")
        assert any(item.evaluate.__module__ == stage for item in REGISTER.values())


@pytest.mark.parametrize("kind", ROWS)
def test_commands_named_by_a_kind_exist(kind: KindOfTest) -> None:
    message = KINDS_OF_FILE[kind.name].usage if kind.name in KINDS_OF_FILE else ""
    matches = re.findall(r"dashpot ([a-z]+)", f"{message} {kind.lot_hint}")
    assert set(matches) <= set(COMMANDS)
    assert matches or not kind.fit_route or kind.name in WITHOUT_FIT
    assert bool(kind.fit_route) == bool(kind.fit)


@pytest.mark.parametrize("kind", ROWS)
def test_options_and_columns_named_by_a_kind_exist(kind: KindOfTest) -> None:
    assert not kind.required_value or kind.required_value in set(LotSpecimen._fields)
    assert set(kind.columns) <= set(NUMBER_COLUMNS)
    assert bool(kind.columns) == bool(kind.lot_row)


@pytest.mark.parametrize("name", [name for name, file in FILES.items() if file.kind])
def test_every_example_is_recognised_as_its_kind(folder: Path, name: str) -> None:
    (result,) = inspect_files([folder / name]).files
    assert result.kind == FILES[name].kind


def test_every_kind_that_is_fitted_has_an_example() -> None:
    without = set(KINDS) - {file.kind for file in FILES.values()}
    assert without == NO_EXAMPLE, "name its `examples` in its row"


@pytest.mark.parametrize("name", EXTRA_ROWS)
def test_batch_row_of_a_kind_fills_its_columns(folder: Path, name: str) -> None:
    kind, piece = KINDS[name], EXTRA_ROWS[name]
    file = next(file for file, item in FILES.items() if item.kind == name)
    result, numbers = load_object(kind.lot_row)(folder / file, piece)
    assert set(kind.columns) <= set(numbers)
    assert result.verdict.use
    assert row_of(result) is (None if name == "cyclic" else kind)  # as of an amplitude sweep
    assert isinstance(figure_of(result)(result), Picture)


def test_every_kind_with_a_batch_row_is_tested() -> None:
    assert {kind.name for kind in KINDS.values() if kind.lot_row} == set(EXTRA_ROWS)


READ = {
    "relaxation": "seal_8mm.csv", "impact": "hammer.csv", "frf": "shaker_20mN.csv",
    "dma": "sweep.csv", "cld": "cld_1.csv", "indentation": "hit.csv", "csr": "ovens.csv",
}  # fmt: skip


@pytest.mark.parametrize("name", READ)
def test_what_a_reader_returns_is_of_the_kind(folder: Path, name: str) -> None:
    record = load_object(KINDS[name].reader)(folder / READ[name])
    assert row_of(record) is KINDS[name]


@cache
def crept() -> CreepTest:
    return simulate_creep(PAPER, seed=1).test


MADE: dict[str, Callable[[Path], object]] = {
    "RelaxationTest": lambda folder: read_relaxation(folder / "seal_8mm.csv"),
    "RampHold": lambda folder: prepare(read_relaxation(folder / "seal_8mm.csv")),
    "ImpactTest": lambda folder: read_impact(folder / "hammer.csv"),
    "FRF": lambda folder: read_frf(folder / "shaker_20mN.csv"),
    "DynamicTest": lambda folder: read_dynamic(folder / "sweep.csv"),
    "CreepTest": lambda _: crept(),
    "StressRelaxationTest": lambda _: StressRelaxationTest(
        range(20), [0.0, *19 * [10.0]], [3 + 1 / (1 + i) for i in range(20)], units="s, %, MPa"
    ),
    "LoadHold": lambda _: load_hold(crept()),
    "CreepCompliance": lambda _: measured_compliance(load_hold(crept())),
    "LevelFit": lambda folder: fit_levels(
        [read_frf(folder / f"shaker_{size}mN.csv") for size in (20, 500)],
        [0.02, 0.5], mass=0.1148, seals=2,
    ),
    "Aging": lambda folder: csr_files([folder / "ovens.csv"]),
    "AgingPlan": lambda _: plan_aging(use_at=358.15),
    "AgingPrediction": lambda folder: predict_aging(
        csr_files([folder / "ovens.csv"]), temperature=343.15
    ),
    "MachineFit": lambda folder: fit_blank_files(
        [folder / f"rig_{name}.csv" for name in ("stop", "spring", "empty")], spring_stiffness=1e3
    ),
    "PreloadMap": lambda folder: fit_preload_map(read_sweeps([folder / "preload_map.csv"])),
    "HyperelasticFit": lambda folder: fit_hyperelastic(
        [read_stress_strain(folder / "tension.csv", "uniaxial")]
    ),
    "PluginFit": lambda _: PluginFit(
        "peel", "labkit 0.1.0", (ReportedValue("peel_force", 1.5, 1.3, 1.7, "N"),),
        (Check("peel_steady", False, "It jerks.", remedy=Remedy("Peel more slowly.")),),
    ),
}  # fmt: skip
"""Return one result of every class with a schema that is of one kind."""


def test_every_class_with_a_schema_is_tested() -> None:
    nouns = [load_object(result) for kind in KINDS.values() for result in kind.classes]
    classes = [result for result in nouns if issubclass(result, Serialisable)]
    retained = {result.__name__ for result in classes if result.schema and result._is_loadable}
    assert retained == set(MADE), "add one of each to MADE"


@pytest.mark.parametrize("name", MADE)
def test_a_document_comes_back_as_it_was(folder: Path, name: str) -> None:
    result = MADE[name](folder)
    text = to_json(result)
    document = json.loads(text)
    assert schemas()[document["schema"]] is type(result)
    assert json.loads(to_json(from_json(text))) == document


def test_a_document_row_is_named_by_the_schema_of_its_class() -> None:
    assert all(find_handler("document", name).schema == name for name in list_names("document"))


def test_find_kinds_by_option_names_the_fits_that_take_it() -> None:
    assert find_kinds_by_option("compression") == "cld"
    assert find_kinds_by_option("mass") == "indentation drop"  # no file says it is a rod


def test_the_option_that_names_a_kind_is_taken_by_its_fit() -> None:
    named = [kind for kind in KINDS.values() if kind.kind_option]
    assert named
    assert all(kind.kind_option in kind.fit_options for kind in named)


def test_every_task_of_a_handler_stands_in_the_table_of_tasks() -> None:
    table = (Extension.__doc__ or "").split(" returns\n")[1].split("fits : tuple of FitRow")[0]
    rows = re.findall(r"^ +(\w[\w ,]*?) {2,}\S", table, re.MULTILINE)
    documented = {task.strip() for row in rows for task in row.split(",")}
    assert documented == {task for extension in EXTENSIONS for task in extension.handlers}


def test_module_of_each_file_format_reads() -> None:
    """A module without `read` was reported to its author as a fault of dashpot."""
    rows = [row for extension in EXTENSIONS for row in extension.formats]
    assert len(rows) > 10
    for row in rows:
        parameters = list(inspect.signature(import_module(row.module).read).parameters)
        assert parameters == ["raw", "options"], row.name
