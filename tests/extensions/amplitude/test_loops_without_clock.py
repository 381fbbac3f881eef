"""Loops in displacement and force without a clock, few loops, and their row in a lot."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import dashpot as dp
from dashpot.base.errors import DataError, FitError, ReadError
from dashpot.extensions.amplitude.fit_files import level_files
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.batch.input_files import Entry
from dashpot.extensions.batch.table_row import make_row
from dashpot.extensions.materials.cld.preprocess import cld
from dashpot.extensions.materials.cld.read import read_cld
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.detect_kind import recognise
from dashpot.reading.readers.inspect import inspect_file

HERTZ, K, LOSS = 2.0, 3.0, 0.36
"""Hz, N/mm, N/mm."""


def write_loops(
    path: Path,
    *,
    shape: str = "sine",
    cycles: int = 8,
    mean: float = 3.0,
    start: float = 0.0,
    amplitudes: tuple[float, ...] = (0.5,),
    samples: int = 100,
    clock: bool = False,
    unit: float = 1.0,
) -> Path:
    """Loops about a mean; `start` is the part of a cycle with which they begin; mm and N."""
    turns = np.arange(cycles * len(amplitudes) * samples) / samples
    size = np.repeat(amplitudes, cycles * samples)
    phase = 2 * np.pi * (turns + start)
    x, v = np.sin(phase), np.cos(phase)
    if shape == "triangle":
        x = 2 / np.pi * np.arcsin(x)
    noise = 1e-4 * np.random.default_rng(1).standard_normal((2, len(turns)))
    shifted = mean + size * x + noise[0]
    force = unit * (K * (mean + size * x) + LOSS * size * v + 1.0 * bool(mean) + noise[1])
    table = np.column_stack([turns / HERTZ, shifted, force])[:, not clock :]
    head = ["time [s],", ""][not clock] + "displacement [mm],force [N]"
    path.write_text("\n".join([head, *(",".join(f"{v:.7g}" for v in item) for item in table), ""]))
    return path


@pytest.mark.parametrize(
    ("loops", "kind"),
    [
        ({}, "cyclic"),
        ({"start": -0.25}, "cyclic"),
        ({"amplitudes": (0.1, 0.3, 0.5)}, "cyclic"),
        ({"samples": 8}, "cyclic"),
        ({"shape": "triangle", "mean": 0.5, "start": -0.25, "cycles": 3}, "cld"),
        ({"shape": "triangle", "mean": 0.5, "start": -0.25, "cycles": 1}, "cld"),
        ({"mean": 0.5, "start": -0.25, "cycles": 1}, "cld"),
    ],
)
def test_harmonic_cycles_without_a_clock_are_loops_and_triangles_a_load_deflection(
    tmp_path: Path, loops: dict, kind: str
) -> None:
    path = write_loops(tmp_path / "a.csv", **loops)
    assert recognise(path).kind == kind
    requested = inspect_file(path).questions
    assert bool(requested) == (kind == "cyclic")
    if requested:
        assert "--rate 1000Hz" in requested[0].message


def test_loops_without_a_clock_have_the_numbers_of_their_rate(tmp_path: Path) -> None:
    path = write_loops(tmp_path / "a.csv")
    with pytest.raises(ReadError, match="--rate 1000Hz"):
        level_files((path,))
    (line,) = level_files((path,), options=ReadOptions(rate=HERTZ * 100)).fit.lines
    assert (line.frequency_hz, line.storage, line.loss) == pytest.approx(
        (HERTZ, 1e3 * K, 1e3 * LOSS), rel=2e-3
    )


@pytest.mark.parametrize("clock", [True, False])
@pytest.mark.parametrize("start", [0.0, 0.5])
def test_cycles_about_a_mean_are_no_load_deflection(
    tmp_path: Path, clock: bool, start: float
) -> None:
    path = write_loops(tmp_path / "a.csv", shape="triangle", start=start, clock=clock)
    with pytest.raises(DataError, match=r"loops about a mean.*--kind cyclic") as error:
        cld(read_cld(path))
    assert ("--rate 1000Hz" in str(error.value)) is not clock
    message = ReadOptions(kind="cyclic", rate=None if clock else HERTZ * 100)
    (line,) = level_files((path,), options=message).fit.lines
    assert line.frequency_hz == pytest.approx(HERTZ, rel=1e-3)


def test_a_load_deflection_that_is_released_into_air_is_none_of_them(tmp_path: Path) -> None:
    x = np.concatenate([np.linspace(0, 6, 200), np.linspace(6, -3, 300)])
    rows = "\n".join(f"{a:.4f},{max(3 * a - 3, 0):.4f}" for a in x)
    (tmp_path / "a.csv").write_text(f"displacement [mm],force [N]\n{rows}\n")
    assert cld(read_cld(tmp_path / "a.csv")).nominal.loading == pytest.approx(15, rel=0.02)


@pytest.mark.parametrize(("cycles", "loops"), [(5, 3), (4, 2), (3, 1)])
def test_two_loops_at_one_amplitude_are_enough(tmp_path: Path, cycles: int, loops: int) -> None:
    path = write_loops(tmp_path / "a.csv", cycles=cycles, clock=True, start=0.1)
    if loops < 2:
        with pytest.raises((FitError, DataError), match="at one amplitude"):
            level_files((path,))
        return
    fit = level_files((path,)).fit
    (line,) = fit.lines
    assert (line.storage, line.loss) == pytest.approx((1e3 * K, 1e3 * LOSS), rel=5e-3)
    assert fit.verdict.use != "use"  # one amplitude distinguishes friction from no spring


ROW = {"loop_frequency_Hz": HERTZ, "loop_amplitude_m": 5e-4, "loop_storage_N_per_m": 3e3,
       "loop_loss_N_per_m": 360.0, "loop_loss_factor": 0.12}  # fmt: skip


@pytest.mark.parametrize("amplitudes", [(0.5,), (0.1, 0.3, 0.5)])
def test_batch_row_of_loops_has_storage_and_loss_at_the_largest_amplitude(
    tmp_path: Path, amplitudes: tuple[float, ...]
) -> None:
    path = write_loops(tmp_path / "a.csv", amplitudes=amplitudes, clock=True, samples=200)
    entry = Entry(str(path))
    result = make_row(entry, entry.hashes(), BatchOptions())
    assert (result["kind"], result["outcome"]) == ("cyclic", "fitted")
    assert {name: result[name] for name in ROW} == pytest.approx(ROW, rel=2e-3)
    turn = 2 * np.pi * HERTZ * 5e-3  # a delay of 5 ms, the usual one, turns storage into loss
    assert result["loop_loss_se_N_per_m"] == pytest.approx(turn * 3e3, rel=0.05)
    assert result["verdict"] == level_files((path,)).verdict.use
    softening = result["loop_softening"]
    assert softening is None if len(amplitudes) == 1 else abs(softening) < 2e-3


def test_lot_of_loops_is_evaluated_by_storage(tmp_path: Path) -> None:
    for number, unit in enumerate((1.0, 1.04, 0.97), start=1):
        write_loops(tmp_path / f"p{number}.csv", clock=True, unit=unit)
    lot = dp.batch(tmp_path, jobs=1)
    assert lot.main == "loop_storage"
    values = [float(seal.mean) for seal in lot.seals(lot.main)]
    assert values[1] / values[0] == pytest.approx(1.04, abs=1e-3)


def test_batch_row_of_loops_of_a_material_is_in_pascals(tmp_path: Path) -> None:
    t = np.arange(1200) / 100
    strain = 10 + 2 * np.sin(2 * np.pi * t)
    stress = 0.5 + 0.06 * np.sin(2 * np.pi * t + 0.1)
    lines = [f"{a:.3f};{b:.6f};{c:.7f}" for a, b, c in zip(t, strain, stress, strict=True)]
    (tmp_path / "m.csv").write_text("\n".join(["Time [s];Strain [%];Stress [MPa]", *lines, ""]))
    entry = Entry(str(tmp_path / "m.csv"))
    result = make_row(entry, entry.hashes(), BatchOptions())
    assert result["loop_storage_Pa"] == pytest.approx(3e6 * np.cos(0.1), rel=1e-3)
    assert result["loop_loss_factor"] == pytest.approx(np.tan(0.1), rel=5e-3)
    assert result["loop_amplitude"] == pytest.approx(0.02, rel=1e-3)
