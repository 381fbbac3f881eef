"""What a file is: one answer for whoever asks, and its table parsed once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from kit.fits import a_fit
from kit.foreign.files import format_table as table_of
from kit.foreign.files import press_and_hold
from kit.kinds import ARMS, CLOCK, answer, csv, ramp_and_hold

from dashpot.base.errors import ReadError
from dashpot.extensions.curves.creep.read import read_creep
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.extensions.curves.modulus.read import read_modulus
from dashpot.reading.columns.file_kinds import KINDS_OF_FILE, get_kind_label
from dashpot.reading.formats import text
from dashpot.reading.read_options import PROFILE, ReadOptions, dump_profile
from dashpot.reading.readers import channels
from dashpot.reading.readers.detect_kind import recognise, suggest_relaxation_options
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.signals.segments import MAX_HELD_CHANGE, MIN_CREEP
from dashpot.solids.demo_seals import PAPER
from dashpot.workflow.example_files import FILES
from dashpot.workflow.json_archive import to_json

RAMP = ramp_and_hold()
RAMPED = answer(CLOCK, RAMP)
SPREAD = np.geomspace(0.1, 50, len(CLOCK))
BOTH = "f [Hz],K' [N/mm],K'' [N/mm],time [s],displacement [mm],force [N]"
"""What a machine that sweeps and records writes into one table."""


def write_content(folder: Path, content: str, name: str = "a.csv") -> Path:
    path = folder / name
    path.write_text(content, encoding="utf-8")
    return path


def format_both_moduli(*, swept: float = 1.0, frequency: np.ndarray = SPREAD) -> str:
    return csv(
        BOTH, swept * frequency, swept * (1 + SPREAD), swept * SPREAD / 9, CLOCK, 1e3 * RAMP, RAMPED
    )


@pytest.mark.parametrize("name", FILES)
def test_every_example_is_its_kind_to_whoever_asks(tmp_path: Path, name: str) -> None:
    path = write_content(tmp_path, FILES[name].write(), name)
    recognised = recognise(path)
    # a blank test has the columns of a relaxation test: the user says that it is one
    kind = "relaxation" if name.startswith("rig_") else FILES[name].kind
    assert recognised.kind == kind == inspect_file(path).kind
    assert recognised.kind_title == get_kind_label(recognised.kind)
    assert recognised.use == inspect_file(path).use != ""


# -- a sweep that holds the record behind it, too --------------------------------------------------


@pytest.mark.parametrize(
    ("options", "kind"),
    [
        ({}, "dma"),
        ({"storage": "K'", "force": "force"}, "dma"),
        ({"frequency": "f", "temperature": "time"}, "dma"),
        ({"force": "force"}, "relaxation"),
        ({"time": "time"}, "relaxation"),
        ({"displacement": "displacement"}, "relaxation"),
        ({"force": "of another file"}, "dma"),
    ],
)
def test_of_a_sweep_with_its_record_the_columns_named_decide(
    tmp_path: Path, options: dict[str, str], kind: str
) -> None:
    path, read_options = write_content(tmp_path, format_both_moduli()), ReadOptions(**options)
    assert (
        recognise(path, read_options).kind == inspect_file(path, options=read_options).kind == kind
    )


def test_both_are_read_by_who_takes_them(tmp_path: Path) -> None:
    path = write_content(tmp_path, format_both_moduli())
    assert len(read_dynamic(path).frequency) == len(CLOCK)
    assert len(read_relaxation(path, options=ReadOptions(force="force")).time) == len(CLOCK)


@pytest.mark.parametrize(("swept", "kind"), [(1.0, "dma"), (0.0, "relaxation")])
def test_empty_columns_of_a_sweep_make_none(tmp_path: Path, swept: float, kind: str) -> None:
    assert recognise(write_content(tmp_path, format_both_moduli(swept=swept))).kind == kind


def test_a_displacement_that_is_named_may_be_the_amplitude(tmp_path: Path) -> None:
    path = write_content(tmp_path, format_both_moduli(frequency=np.full(len(CLOCK), 5.0)))
    assert recognise(path, ReadOptions(displacement="displacement")).kind == "strain-sweep"


# -- what moves decides ----------------------------------------------------------------------------


def crept(part: float, *, header: str = "time [s],displacement [mm],force [N]") -> str:
    """A load of 1.6 N held from 2 s on, under which so much of the travel goes on."""
    # from the first to the last tenth of 18 s a time constant of 4 s shows .79 of it
    part /= 0.79
    risen = np.clip(CLOCK - 1, 0, 1)
    onward = part * (1 - np.exp(-np.clip(CLOCK - 2, 0, None) / 4))
    return csv(header, CLOCK, 8 * risen * (1 - part) + 8 * onward, 1.6 * risen)


@pytest.mark.parametrize(
    ("part", "kind"), [(1.1 * MIN_CREEP, "creep"), (0.9 * MIN_CREEP, "relaxation")]
)
def test_creep_is_a_force_that_is_held_while_the_displacement_goes_on(
    tmp_path: Path, part: float, kind: str
) -> None:
    assert recognise(write_content(tmp_path, crept(part))).kind == kind


@pytest.mark.parametrize(
    ("part", "kind"), [(1.1 * MIN_CREEP, "creep"), (0.9 * MIN_CREEP, "modulus")]
)
def test_so_is_a_stress_under_which_a_strain_goes_on(
    tmp_path: Path, part: float, kind: str
) -> None:
    path = write_content(tmp_path, crept(part, header="time [s],strain [%],stress [MPa]"))
    assert recognise(path).kind == kind
    if kind == "creep":
        assert read_creep(path).unit == "Pa"


@pytest.mark.parametrize(
    ("part", "kind"),
    [(1.05 * MAX_HELD_CHANGE, "creep"), (1.15 * MAX_HELD_CHANGE, "stress-strain")],
)
def test_a_stress_that_was_on_from_the_first_sample_makes_it_creep(
    tmp_path: Path, part: float, kind: str
) -> None:
    # the means of the first and the last tenth are 0.9 of it apart
    stress = 1 - part / 2 + part * CLOCK / CLOCK[-1]
    stress[::2] += 0.04  # however much the samples scatter
    going_on = csv("time [s],strain [%],stress [MPa]", CLOCK, 1 + np.sqrt(CLOCK), stress)
    assert recognise(write_content(tmp_path, going_on)).kind == kind


@pytest.mark.parametrize(
    ("part", "onward", "kind"),
    [
        (1.05 * MAX_HELD_CHANGE, 1.0, "creep"), (1.15 * MAX_HELD_CHANGE, 1.0, "relaxation"),
        (1.05 * MAX_HELD_CHANGE, 0.0, "relaxation"),
    ],
)  # fmt: skip
def test_so_does_a_force_where_the_displacement_goes_on(
    tmp_path: Path, part: float, onward: float, kind: str
) -> None:
    """Of a plate that only shakes no load is held."""
    force = 1 - part / 2 + part * CLOCK / CLOCK[-1]
    displacement = 3 + onward * np.sqrt(CLOCK) + 1e-3 * np.sin(40 * CLOCK)
    path = write_content(
        tmp_path, csv("time [s],displacement [mm],force [N]", CLOCK, displacement, force)
    )
    assert recognise(path).kind == kind


@pytest.mark.parametrize(
    ("base", "what"), [("a0", "a shaken base with its mass"), (None, "a hammer test")]
)
def test_a_base_that_shakes_is_not_called_a_hammer_file(
    tmp_path: Path, base: str | None, what: str
) -> None:
    motion = np.sin(30 * CLOCK)
    path = write_content(tmp_path, csv("time [s],a0 [m/s^2],a1 [m/s^2]", CLOCK, motion, 2 * motion))
    assert recognise(path, ReadOptions(base_acceleration=base)).kind_title == what


def test_a_tension_test_with_a_clock_is_none(tmp_path: Path) -> None:
    pulled = csv("time [s],strain [%],stress [MPa]", CLOCK, 2 * CLOCK, np.sqrt(CLOCK))
    assert recognise(write_content(tmp_path, pulled)).kind == "stress-strain"


@pytest.mark.parametrize(("word", "kind"), [("creep", "creep"), ("creep and relax", "relaxation")])
def test_a_header_that_says_creep_is_believed_until_columns_are_named(
    tmp_path: Path, word: str, kind: str
) -> None:
    ramp = csv("time [s],displacement [mm],force [N]", CLOCK, 1e3 * RAMP, RAMPED)
    path = write_content(tmp_path, f"Procedure: {word}\n{ramp}")
    assert recognise(path).kind == kind
    assert recognise(path, ReadOptions(force="force")).kind == "relaxation"


@pytest.mark.parametrize("content", [",0.0,0.0", "0.0,,0.0"])
def test_a_column_that_is_named_may_be_empty(tmp_path: Path, content: str) -> None:
    named = ReadOptions(time="1", displacement="2", force="3")
    assert inspect_file(write_content(tmp_path, content), options=named).kind == "relaxation"


# -- who names a column, or a kind -----------------------------------------------------------------


def test_recognise_takes_a_modulus_column_only_if_named(tmp_path: Path) -> None:
    time = 1 + CLOCK
    modulus = 0.2 + sum(k / 1e3 * np.exp(-time / tau) for k, tau in ARMS)
    head = "time [s],displacement [mm],force [N],E(t) [MPa]"
    path = write_content(tmp_path, csv(head, time, 1e3 * RAMP, RAMPED, modulus))
    assert recognise(path).kind == "relaxation"
    named = ReadOptions(modulus="E(t)")
    assert recognise(path, named).kind == "modulus"
    assert read_modulus(path, options=named).unit == "Pa"


def test_recognise_accepts_a_requested_kind(tmp_path: Path) -> None:
    path = write_content(tmp_path, FILES["cld_1.csv"].write())
    assert recognise(path).kind == "cld"
    recognised = recognise(path, kind="relaxation")
    assert (recognised.kind, recognised.reason) == ("relaxation", "as stated")
    assert inspect_file(path, options=ReadOptions(kind="relaxation")).kind == "relaxation"


@pytest.mark.parametrize(
    ("word", "message"),
    [("relaxtion", "Did you mean 'relaxation'"), ("zzz", f"Kinds are {', '.join(KINDS_OF_FILE)}")],
)
def test_a_kind_that_there_is_not_is_answered_with_the_nearest(
    tmp_path: Path, word: str, message: str
) -> None:
    with pytest.raises(ReadError, match=message):
        recognise(write_content(tmp_path, format_both_moduli()), kind=word)


# -- what is no table ------------------------------------------------------------------------------


def test_recognise_identifies_documents_by_schema(tmp_path: Path) -> None:
    path = write_content(tmp_path, to_json(a_fit(PAPER)), "fit.json")
    recognised = recognise(path)
    assert (recognised.kind, recognised.stored, recognised.kind_title) == ("fit", True, "a fit")
    assert inspect_file(path).sha256
    other = write_content(tmp_path, '{\n"schema" : "dashpot/hyperelastic@2"}', "law.json")
    assert recognise(other).kind == "hyperelastic"


def test_json_of_others_is_read_as_a_table(tmp_path: Path) -> None:
    path = write_content(tmp_path, '{"schema": "other/fit@1"}', "other.json")
    with pytest.raises(ReadError):
        recognise(path)


@pytest.mark.parametrize(
    ("content", "kind"),
    [
        ("[door]\nmass = '25kg'\n", "door"),
        (dump_profile(ReadOptions(force="Kraft", rate=1e3, units={"force": "N"})), "profile"),
        ("\n".join(f"[{item}]" for item in sorted(PROFILE)), "profile"),
        ("[k_end]\nlower = '2N/mm'\n", "limits"),
        ("[k_end]\nleast = '2N/mm'\n", "unclear"),
    ],
)
def test_toml_is_a_door_or_a_profile(tmp_path: Path, content: str, kind: str) -> None:
    path = write_content(tmp_path, content, "a.toml")
    assert recognise(path).kind == inspect_file(path).kind == kind


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("dashpot.toml", "project"),
        ("part-0123456789abcdef.parquet", "lot"),
        ("seal.csv", "folder"),
    ],
)
def test_recognise_identifies_a_folder_by_its_content(tmp_path: Path, name: str, kind: str) -> None:
    (tmp_path / name).touch()
    assert recognise(tmp_path).kind == inspect_file(tmp_path).kind == kind


# -- parsed once -----------------------------------------------------------------------------------


@pytest.fixture
def parsed_files(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The names of the text files that were parsed, each time."""
    names: list[str] = []
    plain = text.read

    def count_parse(raw, options):
        names.append(raw.name)
        return plain(raw, options)

    monkeypatch.setattr(text, "read", count_parse)
    return names


def test_recognise_and_read_parse_a_file_once(tmp_path: Path, parsed_files: list[str]) -> None:
    path = write_content(tmp_path, FILES["seal_8mm.csv"].write())
    assert recognise(path).kind == recognise(path).kind == "relaxation"
    first = read_relaxation(path)
    assert parsed_files == ["a.csv"]
    second = read_relaxation(path)
    assert parsed_files == ["a.csv", "a.csv"]
    assert first == second


def test_what_is_read_with_other_answers_is_parsed_again(
    tmp_path: Path, parsed_files: list[str]
) -> None:
    path = write_content(tmp_path, FILES["seal_8mm.csv"].write())
    recognise(path)
    read_relaxation(path, options=ReadOptions(skip_rows=1))
    assert len(parsed_files) == 2


def test_a_file_that_was_written_to_is_read_as_it_is(tmp_path: Path) -> None:
    path = write_content(tmp_path, format_both_moduli())
    recognise(path)
    write_content(tmp_path, FILES["seal_8mm.csv"].write())
    assert recognise(path).kind == "relaxation"


def test_recognise_caches_few_files(tmp_path: Path) -> None:
    for number in range(channels._MAX_OPEN_FILES + 3):
        recognise(write_content(tmp_path, format_both_moduli(), f"{number}.csv"))
    assert len(channels._OPEN_FILES) == channels._MAX_OPEN_FILES


@pytest.mark.parametrize(("unit", "force"), [("lb", "lbf"), ("kg", "kgf"), ("lbs", "lbf")])
def test_a_load_in_a_unit_of_mass_is_proposed_as_a_weight(
    tmp_path: Path, unit: str, force: str
) -> None:
    time, displacement, pushed = press_and_hold(20.0)
    head = f"Time [s];Displacement [mm];Load [{unit}]"
    (tmp_path / "a.csv").write_text(table_of(head, [time, displacement, pushed]), "utf-8")
    assert f'--column force="Load" --units "force={force}"' in suggest_relaxation_options(
        tmp_path / "a.csv"
    )


@pytest.mark.parametrize(
    ("header", "kind"),
    [
        ("Elongation [%],Tensile stress [MPa]", "stress-strain"),
        ("Compression [%],Compressive stress [kPa]", "stress-strain"),
        ("Allongement (%),Contrainte (MPa)", "stress-strain"),
        ("Elongation [mm],Force [N]", "cld"),
        ("Compression [mm],Load [N]", "cld"),
    ],
)
def test_recognise_takes_an_elongation_by_its_unit(header: str, kind: str, tmp_path: Path) -> None:
    path = tmp_path / "pulled.csv"
    rows = (f"{0.5 * row},{0.02 * row + 1e-4 * row**2:.5f}" for row in range(60))
    path.write_text("\n".join((header, *rows)), encoding="utf-8")
    assert recognise(path).kind == kind
