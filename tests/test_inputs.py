"""Inputs are declared once; command line, app and Python agree with the declaration."""

from __future__ import annotations

import inspect
import re
import shlex
import string
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import MISSING, Field, fields, replace
from pathlib import Path
from typing import Any
from unittest.mock import patch

import click
import pytest
from hypothesis import given
from hypothesis import strategies as st

import dashpot as dp
from dashpot import workflow
from dashpot.base.option_fields import (
    Driver,
    OverBase,
    get_choice_values,
    get_option_flag,
    get_option_key,
    is_path_field,
    iterate_option_fields,
)
from dashpot.cli import COMMANDS, main
from dashpot.cli._param_types import Keyed, Scoped
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.amplitude import fit_handler as level_handler
from dashpot.extensions.amplitude.fit_files import level_files
from dashpot.extensions.app.command_lines import format_job_command, format_options
from dashpot.extensions.app.page_form import fill_form, get_job_defaults
from dashpot.extensions.app.request_parsing import (
    build_from_request,
    build_job,
    convert_to_request,
    describe_job,
)
from dashpot.extensions.app.upload_store import Store
from dashpot.extensions.batch import batch_run
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.batch.batch_run import batch
from dashpot.extensions.batch.lot_options import HAMMER_ONLY
from dashpot.extensions.materials.indentation.indenter import Indenter
from dashpot.extensions.materials.options import Measures, RodChoices
from dashpot.extensions.materials.rod.datamodel import RodErrors
from dashpot.extensions.modes import fit_handler as modes_handler
from dashpot.extensions.modes.job import ModesJob
from dashpot.extensions.modes.mass_series_files import modes_by_mass
from dashpot.extensions.modes.measured_modes import modes_files
from dashpot.fitting.identification.prior_knowledge import SolidPrior
from dashpot.reading.columns.file_kinds import RecognisedKind
from dashpot.reading.read_options import OF_HAMMER, ReadOptions
from dashpot.reading.readers import detect_kind
from dashpot.workflow.bench_tests import BenchFitOptions
from dashpot.workflow.job import (
    HammerChoices,
    Job,
    LevelChoices,
    LevelJob,
    PartChoices,
    ShiftChoices,
    TimeLimits,
)
from dashpot.workflow.study import characterise

RIG = ("seal_mass", "seals", "compression")
TESTED = tuple(
    field.name for field in iterate_option_fields(Specimen) if field.name != "temperature"
)
"""Of several tests each has a temperature of its own: a job's, not the specimen's."""
INDENTER = tuple(field.name for field in iterate_option_fields(Indenter) if field.name != "mass")
"""Its mass is the mass of the block of other tests."""
FACES: dict[str, dict[type, tuple[str, ...]]] = {
    "report": {
        Job: (), TimeLimits: (), Machine: (), HammerChoices: (), ReadOptions: (), Specimen: TESTED,
    },
    "fit": {
        Job: (*RIG, "arms", "method", "filter", "band", "temperatures", "impact_temperature"),
        TimeLimits: (), Machine: (), HammerChoices: (), ReadOptions: (), Specimen: TESTED,
        LevelJob: ("levels", "at"), ModesJob: ("masses", "band"), RodChoices: (),
        ShiftChoices: (), Measures: (), SolidPrior: (), Indenter: INDENTER,
    },
    "predict": {
        Job: (*RIG, "mass", "band"), HammerChoices: ("motion",), Machine: (), ReadOptions: (),
        PartChoices: (), LevelChoices: (),
    },
    "compare": {Job: (*RIG, "mass", "band"), HammerChoices: (), ReadOptions: ()},
    "inspect": {ReadOptions: ()},
    "batch": {BatchOptions: (), ReadOptions: ()},
    "export": {Job: ("seals",), Specimen: ()},
}  # fmt: skip
"""Options of the commands; () is all that the dataclass declares."""
OTHER_SOURCES = {
    "seal_mass": "of a seal that weighs something", "band": "the page compares every line",
    "filter": "nothing is filtered here", "title": "of a report", "logo": "of a report",
    "impact_temperature": "of several tests", "joint": "a button that fits both",
    "temperatures": "of each file, in the field of the one that is shown",
    "machine": "of the command line", "reading": "asked of each file",
    "reading_impact": "asked of each file",
}  # fmt: skip
"""What of a job stands in no field of the page, and why."""


def list_fields(cls: type, names: tuple[str, ...]) -> list[Field[Any]]:
    return [field for field in iterate_option_fields(cls) if not names or field.name in names]


@pytest.mark.parametrize(
    ("command", "cls", "field"),
    [
        pytest.param(command, cls, field, id=f"{command}{get_option_flag(field)}")
        for command, instances in FACES.items()
        for cls, names in instances.items()
        for field in list_fields(cls, names)
    ],
)
def test_an_input_is_an_option_of_its_commands(command: str, cls: type, field: Field[Any]) -> None:
    result = main.get_command(click.Context(main), command)
    assert result is not None
    (requested,) = [
        parameter for parameter in result.params if get_option_flag(field) in parameter.opts
    ]
    assert isinstance(requested, click.Option)
    how = field.metadata
    # a command may say of a shared input what it does with it
    assert requested.help
    if isinstance(requested.type, Keyed):
        assert requested.type.fields[get_option_key(field)] == field
        return
    if isinstance(requested.type, Scoped):  # for all files, or for some
        return
    assert requested.multiple is ("multiple" in how)
    assert bool(requested.is_flag) is ("is_flag" in how)
    assert getattr(requested.type, "dimension", None) == how.get("unit")
    if "choices" in how:
        assert isinstance(requested.type, click.Choice)
        assert tuple(requested.type.choices) == tuple(how["choices"])
    if field.default not in (None, MISSING) and not {"multiple", "is_flag"} & how.keys():
        assert requested.default == field.default


def test_no_command_lists_the_words_of_a_choice_by_hand() -> None:
    for path in Path(dp.__file__).parent.glob("cli/*.py"):
        assert 'click.Choice(["' not in path.read_text(encoding="utf-8"), path.name


@pytest.mark.parametrize(
    ("cls", "function"),
    [
        (Job, BenchFitOptions), (LevelJob, level_files),
        (ModesJob, modes_files), (ModesJob, modes_by_mass),
        (BatchOptions, batch), (Job, characterise),
    ],
)  # fmt: skip
def test_python_defaults_equal_option_defaults(cls: type, function: Callable[..., Any]) -> None:
    usually = {
        field.name: field.default
        for field in iterate_option_fields(cls)
        if not is_path_field(field)
    }
    shared = inspect.signature(function).parameters.items()
    wrong = [
        name for name, item in shared
        if name in usually and item.default not in (inspect.Parameter.empty, usually[name])
    ]  # fmt: skip
    assert not wrong


def test_rod_defaults_equal_those_of_rod_errors() -> None:
    rod_choices = RodChoices()
    assert (rod_choices.gain_error, rod_choices.phase_error) == (RodErrors.gain, RodErrors.phase)


@pytest.mark.once
def test_no_page_of_help_needs_numpy() -> None:
    text = (
        "import sys\nfrom dashpot.cli import main\n"
        f"for one in {sorted(COMMANDS)}: main.get_command(None, one)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", text + "assert 'numpy' not in sys.modules"], check=False
    )
    assert done.returncode == 0


# -- the app --------------------------------------------------------------------------------------


def page() -> str:
    static = Path(dp.__file__).parent / "extensions/app/static/index.html"
    return fill_form(static.read_text(encoding="utf-8"))


def test_every_job_field_is_in_the_form_or_listed_as_absent() -> None:
    text = page()
    names = {field.name for field in fields(Job) if "argument" not in field.metadata}
    in_form = {name for name in names if f'id="{name}"' in text or f"data-{name}=" in text}
    in_form |= {"specimen"} if 'id="specimen-name"' in text else set()
    # a table of hits, which the server draws
    assert names - in_form - {"hammer"} == set(OTHER_SOURCES)


@pytest.mark.parametrize("name", ["method", "law", "family"])
def test_the_buttons_of_a_choice_are_its_words(name: str) -> None:
    (item,) = [field for field in fields(Job) if field.name == name]
    assert tuple(re.findall(f'data-{name}="([^"]*)"', page())) == item.metadata["choices"]
    assert f'data-{name}="{item.default}" aria-pressed="true"' in page()


def test_the_laws_of_amplitude_are_those_of_the_command() -> None:
    (item,) = [field for field in fields(LevelJob) if field.name == "law"]
    listed = re.search(r'id="amplitude-law">(.*?)</select>', page())
    assert listed is not None
    assert tuple(re.findall("<option>(.*?)<", listed[1])) == item.metadata["choices"]


def test_the_instruments_of_the_page_are_those_of_the_command() -> None:
    text = (Path(dp.__file__).parent / "extensions/app/static/record.html").read_text(
        encoding="utf-8"
    )
    listed = re.search('id="driver">(.*?)</select>', text)
    assert listed is not None
    assert tuple(re.findall('value="(.*?)"', listed[1])) == get_choice_values(Driver)


@pytest.mark.parametrize(
    ("name", "unit"), [("mass", "g"), ("compression", "mm"), ("specimen-length", "mm")]
)
def test_a_field_says_the_unit_that_a_command_line_would(name: str, unit: str) -> None:
    (item,) = [field for cls in (Job, Specimen) for field in iterate_option_fields(cls)
              if field.name == name.removeprefix("specimen-")]  # fmt: skip
    assert format_options(replace(Job("x"), mass=0.1))[1].endswith("g")
    assert item.metadata["unit"] in {"mass", "length"}
    assert re.search(rf'id="{name}"[^>]*><i>{unit}</i>', page())


def test_form_defaults_make_the_default_job(tmp_path: Path) -> None:
    store = Store()
    try:
        file = store.put("a.csv", b"")
        job = build_job(_convert_to_json(get_job_defaults()) | {"relaxation": file}, store.folder)
        assert replace(job, relaxation="a.csv") == Job("a.csv")
    finally:
        store.remove()


def _convert_to_json(message: dict[str, Any]) -> dict[str, Any]:
    """As JSON brings it."""
    return {key: list(item) if isinstance(item, tuple) else item for key, item in message.items()}


# -- any job --------------------------------------------------------------------------------------

# what begins with dashes is taken for an option, as by any command
TEXT = st.text(string.ascii_letters + string.digits + " -,'\"é", min_size=1).filter(
    lambda text: bool(text.strip()) and not text.startswith("--")
)
NAMES = st.text(string.ascii_lowercase, min_size=1, max_size=5).map(lambda name: f"{name}.csv")
HITS = st.lists(NAMES.map(lambda name: f"hits [{name}"), max_size=3, unique=True).map(tuple)
POSITIVE = st.floats(1e-6, 1e6)
RANGES_BY_FIELD: dict[tuple[str, str], st.SearchStrategy[Any]] = {
    ("Job", "impact"): HITS,
    ("HammerChoices", "motion"): st.sampled_from(get_choice_values(OverBase)),
    ("LevelJob", "motion"): st.sampled_from(get_choice_values(OverBase)),
    ("ModesJob", "motion"): st.sampled_from(get_choice_values(OverBase)),
    ("Specimen", "temperature"): st.none(),  # a job says it for each of its tests
    ("Specimen", "date"): st.dates().map(lambda day: day.isoformat()),
    ("ReadOptions", "delimiter"): st.sampled_from([";", ",", "\t", "fixed"]),
    ("ReadOptions", "decimal"): st.sampled_from([".", ","]),
    ("ReadOptions", "encoding"): st.sampled_from(["utf-8", "cp1252"]),
    ("ReadOptions", "units"): st.fixed_dictionaries(  # of a role's own dimension
        {}, optional={
            "force": st.sampled_from(["N", "kN", "V"]), "time": st.sampled_from(["s", "ms"]),
            "my column": st.sampled_from(["N", "s", "m/s^2"]),
        },
    ).map(lambda units: tuple(units.items())),
    ("HammerChoices", "polarity"): st.lists(st.sampled_from([1, -1]), min_size=1).map(tuple),
    ("ShiftChoices", "vertical"): st.sampled_from(["auto", "1", "T/T_r", "free"]),
}  # fmt: skip
"""Values that a dataclass validates beyond its declaration."""


def values(cls: type, field: Field[Any]) -> st.SearchStrategy[Any]:
    """Any value of a declared field, by its declaration."""
    how = field.metadata
    if "options_class" in how:
        return instances(how["options_class"])
    if (cls.__name__, field.name) in RANGES_BY_FIELD:
        return RANGES_BY_FIELD[cls.__name__, field.name]
    if "choices" in how:
        return st.sampled_from(how["choices"])
    if "is_flag" in how:
        return st.booleans()
    if "is_range" in how:
        return st.tuples(st.just(0.0) | st.floats(1e-6, 10), st.floats(11, 1e3))
    if "minimum" in how:
        return st.integers(how["minimum"], 9)
    values = NAMES if is_path_field(field) else TEXT
    if "unit" in how:
        values = st.floats(100, 550) if how["unit"] == "temperature" else POSITIVE
        if "size" in how:
            least, largest = how["size"].hard
            values = st.floats(max(least, 1e-6), largest)
    elif isinstance(field.default, float):
        values = POSITIVE
    return st.lists(values, max_size=3).map(tuple) if isinstance(field.default, tuple) else values


def instances(cls: Any, *names: str) -> st.SearchStrategy[Any]:
    """Return a value with any of its declared fields stated, or with these."""
    requested = {
        field.name: values(cls, field)
        for field in fields(cls)
        if ({"help", "options_class"} & field.metadata.keys())
        and (not names or field.name in names)
    }
    must = {name for name in requested if cls is Job and name == "relaxation"}
    inputs = {name: requested[name] for name in must}
    rest = {name: item for name, item in requested.items() if name not in must}
    return st.fixed_dictionaries(inputs, optional=rest).map(lambda message: cls(**message))


def make_shared_reading(batch_options: BatchOptions) -> BatchOptions:
    """A batch has one set of reading options: what is said of the hammer's files by theirs."""
    bench = batch_options.reading.drop_fields(HAMMER_ONLY)
    impact = replace(
        batch_options.reading_impact.select_fields(OF_HAMMER), frequency=bench.frequency
    )
    return replace(
        batch_options, reading=bench, reading_impact=replace(impact, units=dict(bench.units))
    )


def drop_unused_options(job: Job) -> Job:
    """Nothing is said of a hammer's file where there is none, nor of hits in a bench's."""
    bench = job.reading.drop_fields(OF_HAMMER)
    impact = job.reading_impact if job.impact else bench.select_fields(("units",))
    job = replace(job, reading=bench, reading_impact=impact)
    usual = Job(job.relaxation)
    if not job.impact:
        job = replace(job, hammer=usual.hammer, joint=usual.joint, band=usual.band)
    if job.mass is None:
        job = replace(job, seal_mass=usual.seal_mass)
        if not job.impact:
            job = replace(job, compression=usual.compression)
    return job


class _HeardError(Exception):
    """Raised in place of the work, with what it was asked for."""

    def __init__(self, *heard: Any, **named: Any) -> None:
        self.heard, self.named = heard, named


def heard(place: Any, name: str, typed: str, kind: str = "") -> _HeardError:
    """Return what the work is asked for where a line is typed; files are of a kind, or as named."""

    def work(*message: Any, **named: Any) -> None:
        raise _HeardError(*message, **named)

    def recognise_by_name(path: str, _: ReadOptions) -> RecognisedKind:
        return RecognisedKind(
            kind or ("impact" if "hits" in path else "relaxation"), "it is said so"
        )

    with (
        patch.object(place, name, work),
        patch.object(detect_kind, "recognise", recognise_by_name),
        pytest.raises(_HeardError) as result,
    ):
        main.main(shlex.split(typed)[1:], standalone_mode=False)
    return result.value


@pytest.fixture(autouse=True, scope="module")
def _empty_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as at:
        at.chdir(tmp_path_factory.mktemp("lines"))
        yield


@given(instances(Job).map(drop_unused_options))
def test_a_report_is_typed_as_the_job_that_it_is(job: Job) -> None:
    messages = heard(workflow, "run", format_job_command("report", job))
    assert messages.heard == (job,)


OF_FIT = tuple(field.name for field in fields(Job) if "stage" in field.metadata)


@given(instances(Job, *OF_FIT))
def test_a_fit_is_typed_as_the_job_that_it_is(job: Job) -> None:
    # a window is one of hits: of a test on a bench it is refused
    job = replace(job, reading=replace(job.reading, window_decay=None))
    messages = heard(workflow, "fit_files", format_job_command("fit", job))
    (files,), message = messages.heard, messages.named
    first, *extra = files
    named = {name: message[name] for name in OF_FIT if name in message}
    assert Job(first, other_tests=(*extra,), reading=message["options"], **named) == job


@given(instances(LevelJob).filter(lambda job: job.files))
def test_levels_are_typed_as_the_job_that_they_are(job: LevelJob) -> None:
    amplitude = job.levels or job.at
    if not amplitude:
        job = replace(job, options=replace(job.options, window_decay=None))
    message = job if amplitude else LevelJob(job.files, law=job.law, options=job.options)
    typed = format_job_command("fit", message)
    messages = heard(level_handler, "level_files", typed, "frf" if amplitude else "strain-sweep")
    assert LevelJob(*messages.heard, **messages.named) == message


@given(instances(ModesJob, "files", "band", "seals", "options"), st.lists(POSITIVE, min_size=2))
def test_modes_are_typed_as_the_job_that_they_are(job: ModesJob, masses: list[float]) -> None:
    bare = replace(job, files=job.files or ("frf.csv",), seals=1.0)  # seals are of masses
    messages = heard(modes_handler, "modes_files", format_job_command("fit", bare), "frf")
    assert ModesJob(*messages.heard, **messages.named) == bare
    weighed = replace(job, files=tuple(f"{n}.csv" for n in range(len(masses))), masses=(*masses,))
    messages = heard(modes_handler, "modes_by_mass", format_job_command("fit", weighed), "frf")
    files, under = messages.heard
    assert ModesJob(files, masses=under, **messages.named) == weighed


@st.composite
def batch_choices(draw: st.DrawFn) -> BatchOptions:
    quick = draw(st.booleans())
    arms = draw(st.integers(0, 6)) if quick else draw(st.just("auto") | st.integers(0, 6))
    rest = [
        field.name
        for field in fields(BatchOptions)
        if field.name not in ("quick", "arms", "joint", "machine")
    ]
    message = draw(instances(BatchOptions, *rest))
    machine = draw(instances(Machine)).on_bench  # that of a hammer's rig goes with --joint
    return make_shared_reading(replace(message, quick=quick, arms=arms, machine=machine))


@given(batch_choices())
def test_a_batch_is_typed_as_the_choices_that_it_has(said: BatchOptions) -> None:
    neighbour = said.reading_impact.select_fields(
        [name for name in OF_HAMMER if name != "frequency"]
    )
    typed = ["-o", "lot", *format_options(replace(said, reading_impact=neighbour))]
    messages = heard(batch_run, "run_batch", shlex.join(["dashpot", "batch", "tests", *typed]))
    assert messages.heard[0].choices == said


@given(instances(Job))
def test_a_page_says_a_job_back(job: Job) -> None:
    store = Store()
    try:
        file = store.put("a.csv", b"")
        at_hand = replace(
            job, relaxation=file, impact=(), other_tests=(), logo=None,
            reading=replace(job.reading, calibration=None),
            reading_impact=replace(job.reading_impact, calibration=None),
        )  # fmt: skip
        head = describe_job(at_hand)
        message = head.pop("job") | head | {"relaxation": file}
        result = build_job(_convert_to_json(message), store.folder)
        assert replace(result, relaxation=file) == at_hand
    finally:
        store.remove()


@given(st.sampled_from([LevelJob, ModesJob]).flatmap(instances))
def test_a_page_says_levels_and_modes_back(job: Any) -> None:
    requested = replace(job, files=(), options=replace(job.options, calibration=None))
    assert (
        build_from_request(type(job), _convert_to_json(convert_to_request(requested)), Path())
        == requested
    )
