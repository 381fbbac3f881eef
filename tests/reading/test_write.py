"""What is written is read back."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from kit.instruments import frf

from dashpot.base.errors import DataError, ReadError
from dashpot.base.plain_text import escape_formula, format_csv_comment
from dashpot.base.provenance import Source
from dashpot.datamodel.frf import Kind
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.extensions.formats.write_uff import frf_uff
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.reading.write import write_frf, write_impact, write_relaxation

# what a test writes: nines alone are a logger's mark of no reading, and 1e-150 N no force
finite = st.floats(-1e6, 1e6, allow_nan=False, width=64).filter(
    lambda value: (
        value == 0
        or (abs(value) > 1e-20 and set(f"{abs(value):.9e}".split("e")[0].rstrip("0")) - set("9."))
    )
)


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(finite, finite), min_size=8, max_size=30))
def test_relaxation_round_trip(tmp_path_factory: pytest.TempPathFactory, pairs) -> None:
    displacement, force = np.array(pairs).T
    displacement, force = 1e-7 * displacement, 0.1 * force  # of sizes that a test may have
    assume(np.ptp(displacement) == 0 or np.ptp(displacement) > 1e-6)
    assume(np.ptp(force) == 0 or np.abs(force).max() > 1e-12)
    test = RelaxationTest(np.arange(len(displacement)) / 7.0, displacement, force, units="SI")
    path = tmp_path_factory.mktemp("w") / "a.csv"
    text = write_relaxation(test, path)
    assert text == path.read_text()
    assert text.splitlines()[0] == "time [s],displacement [mm],force [N]"
    sizes = ReadOptions(
        displacement="displacement", force="force", units={"displacement": "mm", "force": "N"}
    )
    back = read_relaxation(path, options=sizes)
    np.testing.assert_array_equal(back.time, test.time)
    np.testing.assert_array_equal(back.force, test.force)
    # millimetres and back: one unit in the last place
    np.testing.assert_allclose(back.displacement, test.displacement, rtol=4.5e-16)


def test_impact_round_trip_keeps_records_and_names(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    time = np.concatenate([np.arange(50) / 100, np.arange(70) / 100, 3 + np.arange(30) / 100])
    test = ImpactTest(
        time,
        rng.normal(size=150),
        rng.normal(size=(2, 150)),
        (0, 50, 120),
        ("left", "right 2"),
        units="SI",
    )
    write_impact(test, tmp_path / "a.csv")
    assert replace(read_impact(tmp_path / "a.csv"), source=()) == test
    plain = ImpactTest(time[:50], test.force[:50], test.acceleration[:, :50], units="SI")
    head = write_impact(plain).splitlines()[0]
    assert head == "time [s],hammer [N],acceleration 1 [m/s^2],acceleration 2 [m/s^2]"


def test_several_impact_files_are_records(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    record = ImpactTest(
        np.arange(50) / 100, rng.normal(size=50), rng.normal(size=(1, 50)), units="SI"
    )
    paths = [tmp_path / "a.csv", tmp_path / "b.csv"]
    for path in paths:
        write_impact(record, path)
        record = replace(record, force=2 * record.force)
    test = read_impact(paths)
    assert test.starts == (0, 50)
    assert [source.file for source in test.source] == ["a.csv", "b.csv"]
    with pytest.raises(ReadError, match=r"same bytes as .*a\.csv: its hits would count twice"):
        read_impact([paths[0], paths[0]])
    write_impact(replace(record, channels=("other",)), paths[1])
    with pytest.raises(ReadError, match="give files of one set-up"):
        read_impact(paths)
    with pytest.raises(ReadError, match="no impact file given"):
        read_impact([])
    with pytest.raises(ReadError, match="holds hits, no loadings"):
        read_impact(paths[0], options=ReadOptions(cycle=2))


@pytest.mark.parametrize(("rate", "item"), [(100.5, True), (102.0, False), (400.0, False)])
def test_read_impact_refuses_files_of_two_rates(tmp_path: Path, rate: float, item: bool) -> None:
    # read at the rate of the first, hits of four times as many samples ring four times as slowly
    signal = np.random.default_rng(1).normal(size=(2, 50))
    paths = [tmp_path / "a.csv", tmp_path / "b.csv"]
    for path, value, sign in zip(paths, (100.0, rate), (1, -1), strict=True):
        time = np.arange(50) / value
        write_impact(ImpactTest(time, sign * signal[0], signal[1:], units="SI"), path)
    if item:  # as 50 samples show it
        assert read_impact(paths).rate == pytest.approx(100)
        return
    with pytest.raises(ReadError, match=rf"b\.csv is sampled at {rate:g} Hz, but .*at 100 Hz"):
        read_impact(paths)
    clock = np.concatenate([np.arange(50) / 100, 10 + np.arange(50) / rate])
    with pytest.raises(
        DataError, match=f"begins at sample 50 is sampled at {rate:g} Hz, the first"
    ):
        ImpactTest(clock, np.tile(signal[0], 2), np.tile(signal[1:], 2), starts=(0, 50), units="SI")


def test_a_jump_of_the_clock_starts_a_record(tmp_path: Path) -> None:
    rows = "".join(f"{t:.3f},0.0,1.0\n" for t in [*np.arange(20) / 100, *(5 + np.arange(20) / 100)])
    path = tmp_path / "a.csv"
    path.write_text("time [s],hammer [N],acceleration 1 [m/s^2]\n" + rows)
    test = read_impact(path)
    assert test.starts == (0, 20)
    assert any("clock jumps at line 22" in note for note in test.source[0].notes)


@pytest.mark.parametrize("kind", sorted(set(Kind) - {Kind.TRANSMISSIBILITY}))
@pytest.mark.parametrize("measured", [True, False])
def test_frf_round_trip(tmp_path: Path, kind: Kind, measured: bool) -> None:
    written = frf(kind, measured=measured)
    write_frf(written, tmp_path / "a.csv", comments=["a comment"])
    assert replace(read_frf(tmp_path / "a.csv"), source=()) == written
    retained = "transmissibility" if kind.over_base else "frf"
    assert inspect_file(tmp_path / "a.csv").kind == retained


def test_frf_of_another_origin(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    rows = "".join(f"{f};{f / 10};{-90}\n" for f in range(1, 20))
    path.write_text("Frequency (Hz);Magnitude (g/N);Phase (deg)\n" + rows)
    result = read_frf(path)
    assert result.quantity is Kind.ACCELERANCE
    np.testing.assert_allclose(result.value, -1j * np.arange(1, 20) / 10 * 9.80665)
    path.write_text("Frequency (Hz);Magnitude;Phase (deg)\n" + rows)
    with pytest.raises(ReadError, match=r"no unit, and so makes no FRF; expected motion per force"):
        read_frf(path)
    read_options = ReadOptions(units={"magnitude": "(m/s^2)/N"})
    np.testing.assert_allclose(read_frf(path, options=read_options).value[0], -0.1j)
    path.write_text("Frequency (Hz);Magnitude (dB);Phase (deg)\n" + rows)
    with pytest.raises(ReadError, match=r"--units \"magnitude=\(m/s\^2\)/N\""):
        read_frf(path)
    np.testing.assert_allclose(
        read_frf(path, options=read_options).value[0], -1j * 10 ** (0.1 / 20)
    )
    path.write_text("Frequency (Hz);Magnitude (m/N);Phase\n" + rows)
    with pytest.raises(ReadError, match=r"'Phase' \(phase\) has no unit; add --units \"phase=deg"):
        read_frf(path)
    path.write_text("# kind: mobility\nFrequency (Hz);Magnitude (m/N);Phase (deg)\n" + rows)
    with pytest.raises(ReadError, match="the comment says mobility"):
        read_frf(path)
    path.write_text("time (s);Magnitude (m/N);Phase (deg)\n" + rows)
    with pytest.raises(ReadError, match="no frequency response found"):
        read_frf(path)


@pytest.mark.parametrize("kind", [Kind.RECEPTANCE, Kind.MOBILITY, Kind.ACCELERANCE])
def test_uff_round_trip(tmp_path: Path, kind: Kind) -> None:
    written = frf(kind)
    (tmp_path / "a.uff").write_bytes(frf_uff(written))
    result = read_frf(tmp_path / "a.uff")
    assert (result.quantity, result.shift, result.record, result.averages) == (kind, 0.25, 8.0, 5)
    np.testing.assert_allclose(result.frequency, written.frequency, rtol=1e-6)
    np.testing.assert_allclose(result.value, written.value, rtol=1e-10)
    np.testing.assert_allclose(result.coherence, written.coherence, rtol=1e-6)
    assert inspect_file(tmp_path / "a.uff").kind == "frf"
    assert any("SI: m, N, K" in note for note in result.source[0].notes)


def test_uff_keeps_what_pyuff_reads(tmp_path: Path) -> None:
    import pyuff

    (tmp_path / "a.uff").write_bytes(frf_uff(frf(Kind.DYNAMIC_STIFFNESS)))
    sets = pyuff.UFF(str(tmp_path / "a.uff")).read_sets()
    assert [entry["type"] for entry in sets] == [151, 164, 58, 58]
    assert sets[1]["units_code"] == 1
    assert (sets[2]["func_type"], sets[3]["func_type"]) == (4, 6)
    assert (sets[2]["ordinate_spec_data_type"], sets[2]["orddenom_spec_data_type"]) == (8, 13)
    assert (sets[2]["ordinate_axis_units_lab"], sets[2]["orddenom_axis_units_lab"]) == ("m", "N")


def test_uneven_uff(tmp_path: Path) -> None:
    written = replace(frf(measured=False), frequency=np.geomspace(1, 40, 40))
    (tmp_path / "a.uff").write_bytes(frf_uff(written))
    np.testing.assert_allclose(read_frf(tmp_path / "a.uff").frequency, written.frequency, rtol=1e-5)


def test_read_frf_asks_which_of_several(tmp_path: Path) -> None:
    import pyuff

    (tmp_path / "a.uff").write_bytes(frf_uff(frf()))
    file = pyuff.UFF(str(tmp_path / "a.uff"))
    file.write_sets([file.read_sets(2)], mode="add")
    with pytest.raises(ReadError, match="2 FRFs in the file"):
        read_frf(tmp_path / "a.uff")
    assert read_frf(tmp_path / "a.uff", options=ReadOptions(segment=2)).averages == 5


def test_the_stamp_stays(tmp_path: Path) -> None:
    source = Source("x", "0" * 64, simulated=True)
    time = np.arange(10.0)
    relaxation = RelaxationTest(time, 1e-3 * time, time, source=source, units="SI")
    assert write_relaxation(relaxation).startswith("# simulated\n")
    stamped = write_relaxation(relaxation, comments=["simulated by the virtual rig"])
    assert stamped.count("simulated") == 1
    (tmp_path / "a.csv").write_text(stamped)
    assert read_relaxation(tmp_path / "a.csv").source.simulated
    (tmp_path / "a.uff").write_bytes(frf_uff(replace(frf(), source=(source,))))
    assert read_frf(tmp_path / "a.uff").source[0].simulated


@pytest.mark.parametrize("cell", ["=1+1", "+1", "-1", "@cmd", "|calc", "%x"])
def test_formulas_are_neutralised(cell: str) -> None:
    assert escape_formula(cell) == "'" + cell
    test = ImpactTest(np.arange(8.0), np.zeros(8), np.zeros((1, 8)), channels=(cell,), units="SI")
    assert f",{cell}" not in write_impact(test).splitlines()[0]
    assert f",{cell}" not in write_impact(test, comments=[f"a seal,{cell}"])
    assert format_csv_comment(f'1, {cell}; "{cell}') == f"1, '{cell}; \"'{cell}"


def test_stdin_can_be_looked_at_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    time = np.arange(10.0)
    text = write_relaxation(RelaxationTest(time, 1e-3 * time, time, units="SI"))
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(text.encode())))
    assert inspect_file("-").kind == "relaxation"
    assert read_relaxation("-").source.file == "stdin"
