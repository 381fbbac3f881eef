"""Grammar of the command line: tasks as commands, recognised kinds, options with one meaning."""

from __future__ import annotations

import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import click
import pytest
from kit.kinds import bench, files, ramp_and_hold
from kit.shell import ran, run_json

from dashpot import workflow
from dashpot.base.option_fields import get_choice_values
from dashpot.cli import COMMANDS, main
from dashpot.cli._command import MAX_HELP_LINES, WIDTH, CommandOption, DashpotCommand
from dashpot.cli._param_types import Keyed, Scoped, Units, format_suggestion
from dashpot.extensions.materials.hyperelastic.law_choices import ElasticKindOption
from dashpot.extensions.materials.options import MODES
from dashpot.reading.read_options import ReadOptions

VERBS = (
    "inspect", "fit", "predict", "compare", "report", "export", "import", "stiffness",
    "batch", "map", "verify", "plan",
    "record", "simulate", "demo", "app",
)  # fmt: skip
OTHER_THINGS = {"-o", "--output", "--port"}
"""What is written, and a line or a TCP port: the words of everyday."""
READING = (
    "--column",
    "--units",
    "--text-format",
    "--file-part",
    "--rate",
    "--calibration",
    "--profile",
    "--kind",
)


def verb(name: str) -> DashpotCommand:
    command = main.get_command(click.Context(main), name)
    assert isinstance(command, DashpotCommand)
    return command


def option(name: str, flag: str) -> CommandOption:
    (result,) = [item for item in verb(name).options if flag in item.opts]
    return result


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a small file of each kind."""
    folder = tmp_path_factory.mktemp("lab")
    for name, (text, _) in files().items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def lab_folder(lab: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(lab)
    return lab


def get_refusal(*typed: object) -> str:
    """The one sentence by which a line is refused."""
    done = ran(*typed)
    assert done.exit_code == 2, done.output
    assert done.stdout == ""
    assert "Traceback" not in done.stderr
    return " ".join(done.stderr.split())


# -- verbs, options and their help ----------------------------------------------------------------


def test_there_are_sixteen_verbs() -> None:
    assert tuple(COMMANDS) == VERBS


@pytest.mark.parametrize("name", VERBS)
def test_the_help_of_a_verb_fits_a_screen(name: str) -> None:
    text = ran(name, "--help").stdout
    lines = text.splitlines()
    assert len(lines) <= MAX_HELP_LINES
    assert max(map(len, lines)) <= WIDTH
    assert "\b" not in text
    assert "\\b" not in text
    whole = ran(name, "--help-all").stdout
    assert max(map(len, whole.splitlines())) <= WIDTH
    assert all(f" {item.flag}" in f" {whole}" for item in verb(name).options)
    hidden = [item for item in verb(name).options if item.is_advanced]
    assert (f"{len(hidden)} more: dashpot {name} --help-all" in text) is bool(hidden)


@pytest.mark.parametrize("name", VERBS)
def test_an_option_says_in_a_line_what_it_does(name: str) -> None:
    for match in verb(name).options:
        message = match.help or ""
        listed = set(re.findall(r"[a-z]+", message)) - {"or"} == set(
            getattr(match.type, "choices", ())
        )
        assert 0 < len(message) <= 60 or listed, (match.flag, message)
        assert not message.startswith("Of "), match.flag
        assert message.endswith("."), (match.flag, message)
        assert match.group, match.flag


def test_option_has_one_meaning_in_every_command() -> None:
    taken: dict[str, set[object]] = defaultdict(set)
    for name in VERBS:
        for item in verb(name).options:
            for word in set(item.opts) - OTHER_THINGS:
                taken[word].add(item.metavar)
    assert {word: every for word, every in taken.items() if len(every) > 1} == {}


def test_reading_is_the_same_seven_options_and_the_kind_wherever_files_are_read() -> None:
    for name in ("inspect", "fit", "predict", "compare", "report", "batch"):
        for flag in READING:
            assert option(name, flag).help == option("inspect", flag).help


@pytest.mark.once
def test_no_help_needs_numpy() -> None:
    text = (
        "import sys\nfrom click.testing import CliRunner\nfrom dashpot.cli import main\n"
        f"for name in ('', {', '.join(map(repr, VERBS))}):\n"
        "    done = CliRunner().invoke(main, [name, '--help'] if name else ['--help'])\n"
        "    assert done.exit_code == 0, done.output\n"
        "assert 'numpy' not in sys.modules"
    )
    assert subprocess.run([sys.executable, "-c", text], check=False).returncode == 0


@pytest.mark.once
@pytest.mark.parametrize("name", workflow.EXAMPLES)
def test_the_help_of_a_file_shows_the_options_of_its_kind(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_text(workflow.EXAMPLES[name](), encoding="utf-8")
    (result,) = (
        run_json("inspect", path)["files"] if path.suffix != ".toml" else ({"kind": "door"},)
    )
    text = ran("fit", path, "--help").stdout
    assert max(map(len, text.splitlines())) <= WIDTH
    if result["kind"] in {"unclear", "not-a-test"}:
        return
    assert f"{name} is " in text
    for item in verb("fit").options:
        suits = result["kind"] in (item.kinds or {result["kind"]} - item.excluded_kinds)
        assert (f" {item.flag} " in f"{text}\n".replace("\n", " ")) is suits, item.flag


# -- KEY=VALUE, and for some files alone ----------------------------------------------------------


@pytest.mark.parametrize(
    ("flag", "typed", "means"),
    [
        ("--column", "force=Kraft", ("", {"force": "Kraft"})),
        ("--column", "force=3,displacement=2", ("", {"force": "3", "displacement": "2"})),
        ("--column", "force=Kraft, N", ("", {"force": "Kraft, N"})),
        ("--column", "force=a=b", ("", {"force": "a=b"})),
        ("--column", "hammer*.csv:force=F: raw", ("hammer*.csv", {"force": "F: raw"})),
        ("--column", "force=F: raw", ("", {"force": "F: raw"})),
        ("--column", r"C:\lab\h.csv:hammer=F", (r"C:\lab\h.csv", {"hammer": "F"})),
        ("--column", "h.csv:acceleration=a,acceleration=b",
         ("h.csv", {"acceleration": ("a", "b")})),
        ("--column", "Loss factor=tan d", ("", {"loss_factor": "tan d"})),
        ("--text-format", "delimiter=;,decimal=comma", ("", {"delimiter": ";",
         "decimal": "comma"})),
        ("--text-format", "delimiter=,,decimal=.", ("", {"delimiter": ",", "decimal": "."})),
        ("--text-format", "raw.txt:skip=3", ("raw.txt", {"skip_rows": 3})),
        ("--file-part", "segment=2,sheet=Run 1", ("", {"segment": 2, "sheet": "Run 1"})),
        ("--file-part", "cycle=1", ("", {"cycle": 1})),
        ("--calibration", "FT1.cal", ("", {"calibration": "FT1.cal"})),
        ("--calibration", "FT1.cal,axis=Tx", ("", {"calibration": "FT1.cal", "axis": "Tx"})),
        ("--calibration", "axis=Tx", ("", {"axis": "Tx"})),
        ("--calibration", r"C:\ati\FT1.cal", ("", {"calibration": r"C:\ati\FT1.cal"})),
        ("--calibration", r"a.csv:C:\FT1.cal", ("a.csv", {"calibration": r"C:\FT1.cal"})),
        ("--machine", "sync=1s,drift=2N/s", ("", {"sync": 1.0, "drift": 2.0})),
        ("--time-limits", "onset=1s,ramp-end=2s", ("", {"onset": 1.0, "ramp_end": 2.0})),
        ("--label", "name=left, upper,lot=7", ("", {"name": "left, upper", "lot": "7"})),
    ],
)  # fmt: skip
def test_what_is_typed_as_key_and_value(flag: str, typed: str, means: object) -> None:
    kind = option("fit", flag).type
    assert isinstance(kind, Keyed)
    assert kind.convert(typed, None, None) == means


@pytest.mark.parametrize(
    ("typed", "means"),
    [
        ("force=N,time=s", ("", {"force": "N", "time": "s"})),
        ("hammer*.csv:force=N", ("hammer*.csv", {"force": "N"})),
        ("ch1: load=mV", ("", {"ch1: load": "mV"})),
        ("ch1.raw: load=mV", ("", {"ch1.raw: load": "mV"})),
        ("seal.csv:ch1: load=mV", ("seal.csv", {"ch1: load": "mV"})),
        (r"C:\lab\seal.csv:force=N", (r"C:\lab\seal.csv", {"force": "N"})),
        ("acc=g,a.b=m/s^2", ("", {"acc": "g", "a.b": "m/s^2"})),
    ],
)
def test_units_are_of_a_role_or_a_column(typed: str, means: tuple[str, dict[str, str]]) -> None:
    assert Units().convert(typed, None, None) == means


@pytest.mark.parametrize(
    ("typed", "means"),
    [
        ("lab.toml", ("", "lab.toml")),
        ("raw.txt:lab.toml", ("raw.txt", "lab.toml")),
        (r"C:\lab\lab.toml", ("", r"C:\lab\lab.toml")),
        (r"raw*.txt:C:\lab.toml", ("raw*.txt", r"C:\lab.toml")),
    ],
)
def test_scoped_option_parses_its_file_pattern(typed: str, means: tuple[str, str]) -> None:
    assert Scoped(click.STRING).convert(typed, None, None) == means


def test_a_column_whose_name_has_a_colon_keeps_its_unit(tmp_path: Path) -> None:
    path = tmp_path / "seal.csv"
    path.write_text(bench(ramp_and_hold(), head="time [s],displacement [mm],ch1: load"))
    (result,) = run_json("inspect", path, "--column", "force=ch1: load", "--units", "ch1: load=N")[
        "files"
    ]
    assert result["columns"][2]["role"] == "force"
    assert result["questions"] == []
    assert result["preparation"]["ramp_time"] == pytest.approx(1, abs=0.05)


@pytest.mark.usefixtures("lab_folder")
def test_an_answer_is_for_the_files_that_its_pattern_matches() -> None:
    requested = ("--kind", "c*.csv:relaxation", "--column", "s*.csv:force=2,displacement=3")
    result = run_json("inspect", "creep.csv", "triangle.csv", "seal.csv", *requested)["files"]
    assert [entry["kind"] for entry in result[:2]] == ["relaxation", "cld"]
    roles = [[column["role"] for column in entry["columns"]] for entry in result]
    assert roles[0] == roles[1] == ["time", "displacement", "force"]
    assert roles[2] == ["time", "force", "displacement"]


@pytest.mark.usefixtures("lab_folder")
@pytest.mark.parametrize("flag", ["--column", "--kind", "--units"])
def test_a_pattern_that_matches_no_file_is_refused(flag: str) -> None:
    value = {"--column": "force=3", "--kind": "cld", "--units": "force=N"}[flag]
    refusal = get_refusal("fit", "seal.csv", flag, f"seel*.csv:{value}")
    assert "'seel*.csv:' matches none of the files seal.csv" in refusal


def test_read_options_apply_per_file_overrides() -> None:
    read_options = ReadOptions(force="F", file_options=(("h*.csv", ReadOptions(hammer="H")),))
    assert (
        read_options.for_file("lab/h1.csv").hammer,
        read_options.for_file("lab/seal.csv").hammer,
    ) == ("H", None)
    assert read_options.for_file("lab/h1.csv").force == "F"


# -- what a file is, and what suits it ------------------------------------------------------------


@pytest.mark.usefixtures("lab_folder")
def test_fit_states_the_recognised_kind_and_accepts_another() -> None:
    assert ran("fit", "triangle.csv").stderr.startswith("recognised triangle.csv: a compression")
    for message in ("relaxation", "triangle.csv:relaxation", "*.csv:relaxation"):
        done = ran("fit", "triangle.csv", "--kind", message)
        assert done.stderr.startswith("recognised triangle.csv: a relaxation test")


SUITS = (
    ("--radius 5mm", "hammer.csv", "--radius is for a rebound indentation. hammer.csv is a"),
    ("--drop-height 5cm", "seal.csv", "--drop-height is for a rebound indentation. seal.csv"),
    ("--terms 2", "seal.csv", "--terms is for stress over strain of a material. seal.csv is a"),
    (
        "--compression-limits 4:8mm",
        "seal.csv",
        "--compression-limits is for a compression load deflection",
    ),
    ("--relaxation fit.json", "seal.csv", "--relaxation is for"),
    (
        "--time-limits onset=1s",
        "hammer.csv",
        "--time-limits is for a relaxation test. hammer.csv is a hammer",
    ),
    ("--machine sync=1ms", "dma.csv", "or a transmissibility. dma.csv is a dynamic"),
    ("--reference 23degC", "hammer.csv", "--reference is for"),
    ("--window none", "frf.csv", "--window is for"),
    ("--amplitude 1N", "strain.csv", "--amplitude is for"),
    ("--density 1000", "tension.csv", "--density is for"),
    ("--test planar", "dma.csv", "--test is for stress over strain"),
    ("--arms 2", "tension.csv", "--arms is for"),
    ("--seals 2", "ball.csv", "--seals is for"),
    ("--elastic linear", "triangle.csv", "--elastic is for a relaxation test. triangle.csv is a"),
)


@pytest.mark.usefixtures("lab_folder")
@pytest.mark.parametrize(("typed", "file", "message"), SUITS)
def test_an_option_of_another_kind_is_refused_by_name(typed: str, file: str, message: str) -> None:
    assert message in get_refusal("fit", file, *typed.split())


@pytest.mark.usefixtures("lab_folder")
@pytest.mark.parametrize(
    ("typed", "message"),
    [
        ("inspct seal.csv", "There is no command 'inspct'. Did you mean 'inspect'?"),
        ("fti seal.csv", "Did you mean 'fit'?"),
        ("seal.csv", "There is no command 'seal.csv'. To see what it is: dashpot inspect seal.csv"),
        ("fit seal.csv --arm 2", "--arms"),
        ("fit seal.csv --colunm force=3", "--column"),
        ("fit seal.csv --column forc=3", "'forc' is unknown. Did you mean 'force'?"),
        ("fit seal.csv --text-format delimeter=;",
         "'delimeter' is unknown. Did you mean 'delimiter'?"),
        ("fit seal.csv --machine synch=1ms", "'synch' is unknown. Did you mean 'sync'?"),
        ("fit seal.csv --time-limits hold_ende=9s", "Did you mean 'hold-end'?"),
        ("fit seal.csv --kind relaxtion", "relaxation"),
        ("fit seal.csv --kind seal.csv:relaxtion", "relaxation"),
        ("fit seal.csv --model fractionl", "'fractionl' is unknown. Did you mean 'fractional'?"),
        ("fit ball.csv --mass 5g --model herz", "hertz"),
        ("fit tension.csv --model ogdn", "ogden"),
        ("fit tension.csv --test biaxal", "'biaxal' is unknown. Did you mean 'biaxial'?"),
        ("fit seal.csv --elastic by-dept", "'by-dept' is unknown. Did you mean 'by-depth'?"),
        ("fit seal.csv --method qqq", "Known are full and hold."),
        ("simulate relaxtion -o x.csv", "'relaxtion' is unknown. Did you mean 'relaxation'?"),
        ("export fit.json --to nastrn", "'nastrn' is unknown. Did you mean 'nastran'?"),
        ("export fit.json --to kratos", "depends on the number of steps"),
        ("export fit.json --to Marc", "--to csv"),
        ("record --driver serail -o x.csv", "'serail' is unknown. Did you mean 'serial'?"),
        ("fit seal.csv --column force", "write --column force=VALUE"),
    ],
)  # fmt: skip
def test_a_word_that_is_misspelt_is_answered_with_the_nearest(typed: str, message: str) -> None:
    assert message in get_refusal(*typed.split())


def test_the_nearest_word_is_named_or_all_are() -> None:
    assert format_suggestion("biaxal", MODES) == "Did you mean 'biaxial'?"
    assert format_suggestion("qqq", ["full", "hold"]) == "Known are full and hold."
    assert format_suggestion("qqq", ["one"]) == ""
    assert all(
        format_suggestion(word, get_choice_values(ElasticKindOption)) for word in ("ogdn", "qqq")
    )
