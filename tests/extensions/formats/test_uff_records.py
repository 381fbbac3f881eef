"""UFF files of a hammer whose every hit is a record of its own: one test, a segment for each."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import dashpot as dp
from dashpot.reading.readers.impact import read_impact

RATE, SAMPLES, HITS = 1024.0, 2048, 4
_TYPES = {"Force": (13, "N"), "Acceleration": (12, "m/s^2")}


def _dataset(label: str, values: np.ndarray, *, point: int = 1, hit: int = 0) -> str:
    """Return a dataset 58 in ASCII, single precision, as analysers write a time record."""
    kind, unit = _TYPES[label]
    rows = [values[i : i + 6] for i in range(0, len(values), 6)]
    end = f"{0:5d}{0:5d}{0:5d}"
    return "\n".join([
        f"{-1:6d}", f"{58:6d}", f"{label} of hit {hit}", "NONE", *3 * ["NONE"],
        f"{1:5d}{0:10d}{1:5d}{0:10d} {'NONE':<10}{point:10d}{3:4d} {'NONE':<10}{1:10d}{3:4d}",
        f"{2:10d}{len(values):10d}{1:10d}{0.0:13.5e}{1 / RATE:13.5e}{0.0:13.5e}",
        f"{17:10d}{end} {'Time':<20} {'s':<20}",
        f"{kind:10d}{end} {label:<20} {unit:<20}",
        *2 * [f"{0:10d}{end} {'NONE':<20} {'NONE':<20}"],
        *("".join(f"{value:13.5e}" for value in row) for row in rows),
        f"{-1:6d}", "",
    ])  # fmt: skip


def _hit(number: int) -> tuple[np.ndarray, np.ndarray]:
    """Force of a half sine, and the acceleration of 0.1 kg on a spring, 12 Hz, 3 % damping."""
    t = np.arange(SAMPLES) / RATE
    force = np.where((t > 0.1) & (t < 0.104), (3 + number) * np.sin(np.pi * (t - 0.1) / 0.004), 0.0)
    omega, ratio = 2 * np.pi * 12, 0.03
    s = 2j * np.pi * np.fft.rfftfreq(16 * SAMPLES, 1 / RATE)
    response = s**2 / (0.1 * (s**2 + 2 * ratio * omega * s + omega**2))
    motion = np.fft.irfft(np.fft.rfft(force, 16 * SAMPLES) * response, 16 * SAMPLES)[:SAMPLES]
    random = np.random.default_rng(number)
    return force + random.normal(0, 1e-3, SAMPLES), motion + random.normal(0, 1e-3, SAMPLES)


@pytest.mark.parametrize("order", ["hit after hit", "channel after channel"])
def test_records_of_hits_are_segments_of_one_test(tmp_path: Path, order: str) -> None:
    hits = [_hit(i) for i in range(HITS)]
    forces = [_dataset("Force", force, hit=i) for i, (force, _) in enumerate(hits)]
    motions = [_dataset("Acceleration", motion, hit=i) for i, (_, motion) in enumerate(hits)]
    pairs = [text for pair in zip(forces, motions, strict=True) for text in pair]
    path = tmp_path / "hits.uff"
    path.write_text("".join(pairs if order == "hit after hit" else [*forces, *motions]))

    test = read_impact(path)
    assert test.starts == tuple(SAMPLES * i for i in range(HITS))
    assert test.channels == ("Acceleration",)
    assert test.force == pytest.approx(np.concatenate([f for f, _ in hits]), rel=1e-5, abs=1e-8)
    assert test.acceleration[0] == pytest.approx(
        np.concatenate([a for _, a in hits]), rel=1e-5, abs=1e-8
    )
    frf = test.frf()
    assert len(frf.hits) == HITS
    assert frf.modes()[0].frequency == pytest.approx(12.0, rel=1e-3)
    assert frf.modes()[0].damping_ratio == pytest.approx(0.03, rel=1e-2)


def test_accelerations_of_several_points_stay_channels_of_one_record(tmp_path: Path) -> None:
    force, motion = _hit(0)
    path = tmp_path / "points.uff"
    path.write_text(
        _dataset("Force", force)
        + _dataset("Acceleration", motion)
        + _dataset("Acceleration", 0.5 * motion, point=2)
    )
    test = read_impact(path)
    assert test.starts == (0,)
    assert len(test.channels) == 2


def test_roving_accelerometer_leaves_the_hammer_open(tmp_path: Path) -> None:
    """A roving accelerometer is no repetition: an average over its points would be wrong."""
    force, motion = _hit(0)
    path = tmp_path / "roving.uff"
    path.write_text(
        "".join(
            _dataset("Force", force + 0.01 * k) + _dataset("Acceleration", motion, point=k)
            for k in (1, 2)
        )
    )
    assert any("hammer force" in question for question in map(str, dp.inspect(path).questions))
