"""Wrong units and swapped columns: asked about, and read right with the option that is named."""

from __future__ import annotations

import re
import shlex
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from kit.mistakes import BENCH, bench, comma, hammer, quote_lines, rows, table

from dashpot.base.errors import ReadError
from dashpot.reading.read_options import ReadOptions, parse_units
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation

UNITS = {
    "metres under mm": ((1, 1e-3, 1), "", "displacement=m"),
    "millimetres under m": ((1, 1, 1), "displacement [m]", "displacement=mm"),
    "half a metre": ((1, 0.06, 0.06), "displacement [m]", "displacement=mm"),
    "micrometres under mm": ((1, 1e3, 1), "", "displacement=um"),
    "millimetres under um": ((1, 1, 1), "displacement [um]", "displacement=mm"),
    "newtons under mN": ((1, 1, 1), "force [mN]", "force=N"),
    "kilonewtons under N": ((1, 1, 1e-3), "", "force=kN"),
    "milliseconds under s": ((1e3, 1, 1), "", "time=ms"),
    "minutes under s": ((1 / 60, 1, 1), "", "time=min"),
    "seconds under ms": ((1, 1, 1), "time [ms]", "time=s"),
    "seconds under h": ((1, 1, 1), "time [h]", "time=s"),
}
"""What is done to the columns, the heading that is wrong, and the answer."""
NOTED = {
    "newtons under kN": ((1, 1, 1), "force [kN]", "force=N"),
    "millinewtons under N": ((1, 1, 1e3), "", "force=mN"),
}
"""So too, where the size is one of a press: large, and stated by the file."""
HITS = {
    "newtons under kN": ("hammer [kN]", "hammer=N"),
    "newtons under mN": ("hammer [mN]", "hammer=N"),
    "seconds under ms": ("time [ms]", "time=s"),
}
SWAPPED_BENCH = ("time [s]", "force [N]", "displacement [mm]")


def replace_heading(heading: str, head: tuple[str, ...]) -> list[str]:
    """A head with one heading changed."""
    word = heading.partition(" ")[0]
    return [heading if word and text.startswith(word) else text for text in head]


def answer(message: str) -> ReadOptions:
    """The options that a message proposes, as a user would paste them."""
    words = shlex.split(re.search(r"if so, add (.*)", message)[1])  # type: ignore[index]
    inputs: dict[str, list[str]] = {}
    units: dict[str, str] = {}
    for flag, value in zip(words[::2], words[1::2], strict=True):
        if flag == "--units":
            units = parse_units(value)
            continue
        assert flag == "--column"
        role, _, name = value.partition("=")
        inputs.setdefault(role, []).append(name)
    several = tuple(inputs.pop("acceleration", ()))
    named = {name: values[0] for name, values in inputs.items()}
    return ReadOptions(units=units, acceleration=several, **named)


@pytest.mark.parametrize(("factors", "heading", "meant"), NOTED.values(), ids=NOTED.keys())
def test_a_large_force_is_a_note(
    tmp_path: Path, factors: tuple[float, ...], heading: str, meant: str
) -> None:
    path = tmp_path / "seal.csv"
    path.write_text(
        bench(
            *factors, head=replace_heading(heading, ("time [s]", "displacement [mm]", "force [N]"))
        )
    )
    source = read_relaxation(path).source
    assert source is not None
    assert any(f"--units {meant}" in note for note in source.notes)
    answered = read_relaxation(path, options=ReadOptions(units=parse_units(meant))).source
    assert answered is not None
    assert not any("--units" in note for note in answered.notes)


@pytest.mark.parametrize(("factors", "heading", "meant"), UNITS.values(), ids=UNITS.keys())
def test_read_relaxation_asks_about_an_implausible_unit(
    tmp_path: Path, factors: tuple[float, ...], heading: str, meant: str
) -> None:
    path = tmp_path / "seal.csv"
    path.write_text(
        bench(
            *factors, head=replace_heading(heading, ("time [s]", "displacement [mm]", "force [N]"))
        )
    )
    with pytest.raises(ReadError, match=f"--units {meant}"):
        read_relaxation(path)
    test = read_relaxation(path, options=ReadOptions(units=parse_units(meant)))
    wanted = [
        factor * column
        for factor, column in zip(factors, np.array(rows("seal_8mm.csv")).T, strict=True)
    ]
    scale = {
        "m": 1.0,
        "mm": 1e-3,
        "um": 1e-6,
        "N": 1.0,
        "mN": 1e-3,
        "kN": 1e3,
        "s": 1.0,
        "ms": 1e-3,
        "min": 60.0,
    }
    role, _, unit = meant.partition("=")
    column = ("time", "displacement", "force").index(role)
    np.testing.assert_allclose(getattr(test, role), wanted[column] * scale[unit])


def _role(mistake: str) -> str:
    return UNITS[mistake][2].partition("=")[0]


@pytest.mark.parametrize(
    ("name", "other"),
    [(a, b) for a, b in combinations(UNITS, 2) if _role(a) != _role(b)],
)
def test_answered_question_leads_to_no_other(tmp_path: Path, name: str, other: str) -> None:
    """Two columns in wrong units: what is asked together is answered together."""
    path = tmp_path / "seal.csv"
    factors = tuple(a * b for a, b in zip(UNITS[name][0], UNITS[other][0], strict=True))
    head = replace_heading(UNITS[other][1], tuple(replace_heading(UNITS[name][1], BENCH)))
    path.write_text(bench(*factors, head=tuple(head)))
    try:
        read_relaxation(path)
    except ReadError as error:
        read_options = ReadOptions(
            units=parse_units(",".join(re.findall(r"--units (\S+=\w+)", str(error))))
        )
        read_relaxation(path, options=read_options)


def test_read_relaxation_accepts_a_unit_stated_by_option(tmp_path: Path) -> None:
    path = tmp_path / "seal.csv"
    path.write_text(bench(1, 1e-3, 1))
    test = read_relaxation(path, options=ReadOptions(units={"displacement": "mm"}))
    assert np.ptp(test.displacement) == pytest.approx(8.04e-6, rel=0.01)


def test_read_relaxation_accepts_a_probe_in_micro_units(tmp_path: Path) -> None:
    """Micrometres and micronewtons, or metres and newtons as an AFM writes them."""
    path = tmp_path / "probe.csv"
    for head, factors in (
        (("time [s]", "displacement [um]", "force [uN]"), (1, 1, 1)),
        (("time [s]", "displacement [m]", "force [N]"), (1, 1e-6, 1e-6)),
    ):
        path.write_text(bench(*factors, head=head))
        assert np.ptp(read_relaxation(path).displacement) < 1e-5


@pytest.mark.parametrize(("heading", "meant"), HITS.values(), ids=HITS.keys())
def test_read_impact_asks_about_an_implausible_unit(
    tmp_path: Path, heading: str, meant: str
) -> None:
    path = tmp_path / "hammer.csv"
    head = replace_heading(
        heading, ("time [s]", "hammer [N]", "acceleration 1 [m/s^2]", "acceleration 2 [m/s^2]")
    )
    path.write_text(hammer(head=head))
    with pytest.raises(ReadError, match=f"--units {meant}"):
        read_impact(path)
    test = read_impact(path, options=ReadOptions(units=parse_units(meant)))
    np.testing.assert_allclose(test.force, np.array(rows("hammer.csv"))[:, 1])


def test_swapped_headings_end_with_the_options_proposed(tmp_path: Path) -> None:
    path = tmp_path / "seal.csv"
    for head in (SWAPPED_BENCH, ("time [s]", "force", "displacement")):
        path.write_text(bench(head=head))
        with pytest.raises(ReadError, match=r"look swapped|has no unit") as caught:
            read_relaxation(path)
        if "no unit" in str(caught.value):
            units = ReadOptions(units={"displacement": "mm", "force": "N"})
            with pytest.raises(ReadError, match="look swapped") as caught:
                read_relaxation(path, options=units)
        test = read_relaxation(path, options=answer(str(caught.value)))
        np.testing.assert_allclose(test.force, np.array(rows("seal_8mm.csv"))[:, 2])
        np.testing.assert_allclose(test.displacement, 1e-3 * np.array(rows("seal_8mm.csv"))[:, 1])


@pytest.mark.parametrize(
    "head",
    [
        ("time [s]", "acceleration 1 [m/s^2]", "hammer [N]", "acceleration 2 [m/s^2]"),
        ("time [s]", "acceleration 1 [m/s^2]", "acceleration 2 [m/s^2]", "hammer [N]"),
    ],
)
def test_a_hammer_that_rings_is_an_accelerometer(tmp_path: Path, head: tuple[str, ...]) -> None:
    path = tmp_path / "hammer.csv"
    path.write_text(hammer(head=head))
    with pytest.raises(ReadError, match="hammer and acceleration look swapped") as caught:
        read_impact(path)
    test = read_impact(path, options=answer(str(caught.value)))
    truth = np.array(rows("hammer.csv")).T
    np.testing.assert_allclose(test.force, truth[1])
    np.testing.assert_allclose(np.sort(test.acceleration, axis=0), np.sort(truth[2:], axis=0))


def test_units_of_a_role_hold_whatever_another_column_is_called() -> None:
    units = ReadOptions(units={"displacement": "mm", "force": "N", "Load": "kN"})
    assert units.unit_of("displacement", "force") == "mm"
    assert units.unit_of("force", "displacement") == "N"
    assert units.unit_of("force", "Load") == "kN"
    assert ReadOptions(units={"force": "mm"}).unit_of("displacement", "force") == "mm"


@pytest.mark.parametrize("sign", [";", "\t"])
@pytest.mark.parametrize("digits", [3, 5])
def test_three_decimals_behind_a_comma_are_no_thousands(
    tmp_path: Path, sign: str, digits: int
) -> None:
    """12,345 can be read two ways; 0,054 in the first rows cannot."""
    path = tmp_path / "seal.csv"
    path.write_text(table(BENCH, rows("seal_8mm.csv"), sign=sign, printed=comma(digits)))
    truth = np.array(rows("seal_8mm.csv"))[:, 2]
    np.testing.assert_allclose(read_relaxation(path).force, truth, atol=0.51 * 10**-digits)


def test_numbers_cut_in_two_at_their_comma_are_seen(tmp_path: Path) -> None:
    path = tmp_path / "seal.csv"
    path.write_text(table(BENCH, rows("seal_8mm.csv"), printed=comma(5)))
    with pytest.raises(
        ReadError, match=r"3 names for 6 columns .* cut in two at their decimal comma"
    ):
        read_relaxation(path)


def test_lines_in_quotes_are_seen(tmp_path: Path) -> None:
    path = tmp_path / "seal.csv"
    path.write_text(quote_lines(bench()))
    with pytest.raises(ReadError, match="every line stands in quotes as one cell"):
        read_relaxation(path)


@pytest.mark.parametrize("order", [(0, 1, 2, 2), (0, 1, 1, 3)])
def test_read_impact_refuses_a_duplicate_channel(tmp_path: Path, order: tuple[int, ...]) -> None:
    path = tmp_path / "hammer.csv"
    path.write_text(hammer(*order))
    with pytest.raises(ReadError, match="hold the same numbers: one channel stands there twice"):
        read_impact(path)


LINES = np.arange(4.0, 40.0, 0.5)
OF_A_MASS = 1 / (1 - (12.7 / LINES) ** 2 * (1 + 0.06j))


def frf(path: Path, head: str, *columns: np.ndarray) -> Path:
    rows = "\n".join(",".join(map(repr, row)) for row in np.column_stack(columns).tolist())
    path.write_text(f"{head}\n{rows}\n")
    return path


@pytest.mark.parametrize(
    ("unit", "phase", "requested", "meant"),
    [
        ("deg", np.angle(OF_A_MASS), "rad", "deg"),
        ("rad", np.angle(OF_A_MASS, deg=True), "deg", "rad"),
    ],
)
def test_read_frf_asks_about_a_phase_in_the_other_unit(
    tmp_path: Path, unit: str, phase: np.ndarray, requested: str, meant: str
) -> None:
    head = f"frequency [Hz],magnitude [(m/s^2)/N],phase [{unit}]"
    path = frf(tmp_path / "frf.csv", head, LINES, np.abs(OF_A_MASS), phase)
    with pytest.raises(ReadError, match=f'Then add --units "phase={requested}"'):
        read_frf(path)
    read_frf(path, options=ReadOptions(units={"phase": meant}))
    result = read_frf(path, options=ReadOptions(units={"phase": requested}))
    np.testing.assert_allclose(result.value, OF_A_MASS)


def test_decibels_and_per_cents_are_no_plain_numbers(tmp_path: Path) -> None:
    path, polar = tmp_path / "frf.csv", "magnitude [(m/s^2)/N],phase [deg]"
    phase = np.angle(OF_A_MASS, deg=True)
    decibels = 20 * np.log10(np.abs(OF_A_MASS))
    with pytest.raises(ReadError, match="falls below 0, as decibels do"):
        read_frf(frf(path, f"frequency [Hz],{polar}", LINES, decibels, phase))
    shares = np.full(len(LINES), 99.0)
    columns = (LINES, np.abs(OF_A_MASS), phase, shares)
    with pytest.raises(ReadError, match=r"the coherence reaches 99; .* --units \"coherence=%\""):
        read_frf(frf(path, f"frequency [Hz],{polar},coherence", *columns))
    in_parts = read_frf(path, options=ReadOptions(units={"coherence": "%"}))
    assert in_parts.coherence is not None
    np.testing.assert_allclose(in_parts.coherence, 0.99)


def test_read_frf_asks_about_kilohertz(tmp_path: Path) -> None:
    head = "frequency [kHz],real [(m/s^2)/N],imaginary [(m/s^2)/N]"
    path = frf(tmp_path / "frf.csv", head, LINES, OF_A_MASS.real, OF_A_MASS.imag)
    with pytest.raises(ReadError, match="is the unit of frequency Hz"):
        read_frf(path)
    for unit, top in (("Hz", 39.5), ("kHz", 39500.0)):
        read_options = ReadOptions(units={"frequency": unit})
        assert read_frf(path, options=read_options).frequency[-1] == pytest.approx(top)


@pytest.mark.parametrize("roles", list(combinations(("time", "displacement", "force"), 2)))
def test_inspect_asks_as_the_reader_about_a_column_with_two_roles(
    tmp_path: Path, roles: tuple[str, str]
) -> None:
    place = tmp_path / "a.txt"
    place.write_text("t;x;F\n" + "".join(f"{i};{min(i, 2)};{2 - i / 9}\n" for i in range(9)))
    named = {"time": "t", "displacement": "x", "force": "F", roles[0]: "x", roles[1]: "x"}
    options = ReadOptions(**named, units={"time": "s", "displacement": "mm", "force": "N"})
    message = f"'x' would be both {roles[0]} and {roles[1]}"
    inspection = inspect_file(place, options=options)
    assert message in [question.message.partition(";")[0] for question in inspection.questions]
    with pytest.raises(ReadError, match="'x' would be both"):
        read_relaxation(place, options=options)


def test_a_column_that_is_something_else_is_not_proposed(tmp_path: Path) -> None:
    path = tmp_path / "half.csv"
    path.write_text("time [s],acceleration [g]\n" + "".join(f"{i},{i % 3}\n" for i in range(9)))
    (question,) = inspect_file(path).questions
    assert "looks like hammer force. Export it beside them, or name" in question.message
    assert question.message.endswith("misleads: --column hammer=NAME")
