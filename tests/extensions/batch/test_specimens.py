"""Batch rows of a file that holds several specimens: one each, with what chooses it."""

from __future__ import annotations

import h5py
import numpy as np
import pytest
from kit.kinds import files
from scipy.io import savemat

from dashpot.cli import main
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.batch.batch_run import batch
from dashpot.extensions.batch.input_files import Entry
from dashpot.extensions.batch.table_row import build_rows
from dashpot.reading.read_options import ReadOptions
from dashpot.workflow.bench_tests import fit_files

FACTORS = (1.0, 1.2, 0.8)
ONE_ARM = BatchOptions(arms=1, reading=ReadOptions())


def several(label: str = "Specimen") -> str:
    """Three records below each other, whose forces are known multiples of the first."""
    text = next(text for text, kind in files().values() if kind == "relaxation")
    rows = [line.replace("\t", ",").split(",") for line in text.splitlines() if line[:1].isdigit()]
    lines = [f"{label},time [s],displacement [mm],force [N]"]
    for number, factor in enumerate(FACTORS, start=1):
        lines += [f"S{number},{t},{x},{factor * float(f)!r}" for t, x, f in rows]
    return "\n".join(lines) + "\n"


@pytest.fixture(scope="module")
def seals(tmp_path_factory):
    path = tmp_path_factory.mktemp("lot") / "seals.csv"
    path.write_text(several())
    return path


def test_batch_takes_each_specimen_of_a_file_as_a_row(seals) -> None:
    entry = Entry(str(seals), lot="7")
    rows = build_rows(entry, entry.hashes(), ONE_ARM)
    assert [row["part"] for row in rows] == ["segment=1", "segment=2", "segment=3"]
    assert [row["file"] for row in rows] == [f"{seals} [segment={i} S{i}]" for i in (1, 2, 3)]
    assert {row["outcome"] for row in rows} == {"fitted"}
    assert {row["lot"] for row in rows} == {"7"}
    stiffness = np.array([row["k_0_N_per_m"] for row in rows])
    np.testing.assert_allclose(stiffness / stiffness[0], FACTORS, rtol=1e-6)
    single, _ = fit_files((seals,), arms=1, options=ReadOptions(segment=2))
    assert stiffness[1] == single.model.k_0


def test_batch_adds_the_specimen_to_a_named_seal(seals) -> None:
    entry = Entry(str(seals), seal="door")
    rows = build_rows(entry, entry.hashes(), ONE_ARM)
    assert [row["seal"] for row in rows] == ["door S1", "door S2", "door S3"]


def test_a_second_batch_takes_the_rows_of_specimens(seals, tmp_path) -> None:
    first = batch(seals, output=tmp_path / "lot", arms=1, jobs=1)
    assert (first.table.height, first.computed) == (3, 3)
    assert not first.copies
    assert first.rows_in_statistics.height == 3
    again = batch(seals, output=tmp_path / "lot", arms=1, jobs=1)
    assert (again.table.height, again.computed) == (3, 0)


def test_batch_without_a_fit_is_not_for_use(tmp_path, capsys) -> None:
    path = tmp_path / "seals.csv"
    lines = several().splitlines()
    # of each specimen a few samples of its rest alone
    keep = [line for i, line in enumerate(lines[1:]) if i % (len(lines) // 3) < 12]
    path.write_text("\n".join([lines[0], *keep]) + "\n")
    with pytest.raises(SystemExit) as ended:
        main(["batch", str(path), "-o", str(tmp_path / "lot"), "--jobs", "1"])
    assert ended.value.code == 2
    assert "Do not use: 0 of" in capsys.readouterr().out


@pytest.mark.parametrize("form", ["hdf5", "csv", "mat"])
def test_batch_parts_specimens_in_strain_and_stress(tmp_path, form) -> None:
    """Of an arm of 1 MPa and 10 s beside a spring of 3 MPa, each at its own size."""
    t = np.arange(0, 120, 0.2)
    strain, arm, decay = 0.1 * np.clip((t - 5) / 2, 0, 1), np.zeros_like(t), np.exp(-0.02)
    for i in range(1, len(t)):
        arm[i] = decay * arm[i - 1] + (strain[i] - strain[i - 1]) * 50 * (1 - decay)
    noise = np.random.default_rng(1).normal(0, 2e-4, len(t))
    stresses = {name: factor * (3 * strain + arm + noise) for name, factor in (("A", 1), ("B", 2))}
    path = tmp_path / f"two.{form}"
    if form == "hdf5":
        with h5py.File(path, "w") as file:
            for name, stress in stresses.items():
                for channel, values, unit in (
                    ("time", t, "s"), ("strain", strain, "1"), ("stress", stress, "MPa")
                ):  # fmt: skip
                    file[f"{name}/{channel}"] = values
                    file[f"{name}/{channel}"].attrs["units"] = unit
    elif form == "mat":
        for name in tuple(stresses):
            stresses[f"{name}_stress_MPa"] = stresses.pop(name)
            stresses |= {f"{name}_time_s": t, f"{name}_strain_percent": 100 * strain}
        savemat(path, stresses)
    else:
        head = "Time [s];A Strain [%];A Stress [MPa];B Strain [%];B Stress [MPa]"
        table = np.column_stack([t, 100 * strain, stresses["A"], 100 * strain, stresses["B"]])
        np.savetxt(path, table, fmt="%.9g", delimiter=";", header=head, comments="")
    entry = Entry(str(path))
    rows = build_rows(entry, entry.hashes(), ONE_ARM)
    assert [(row["outcome"], row["kind"]) for row in rows] == [("fitted", "modulus")] * 2
    np.testing.assert_allclose([row["E_inf_Pa"] for row in rows], [3e6, 6e6], rtol=0.02)
