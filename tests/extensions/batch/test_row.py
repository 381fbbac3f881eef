"""Batch rows: every kind of file has one, with its fit or the reason for none."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from kit.cld import press_cycles
from kit.kinds import ARMS, MASS, STIFFNESS, files
from kit.shell import did

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.datamodel.machine import HAMMER_RIG_FIELDS, Machine
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.batch.batch_run import batch
from dashpot.extensions.batch.columns import RETRIED_OUTCOMES
from dashpot.extensions.batch.input_files import Entry
from dashpot.extensions.batch.limits import read_limits
from dashpot.extensions.batch.summary import summary
from dashpot.extensions.batch.table_row import make_row
from dashpot.extensions.materials.cld.preprocess import cld
from dashpot.extensions.materials.cld.read import read_cld
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.reading.write import write_frf
from dashpot.workflow import compare_files
from dashpot.workflow.example_files import EXAMPLES
from dashpot.workflow.job import BlockOnSeals, HammerChoices

pytestmark = pytest.mark.once

FITTED = {"relaxation", "creep", "dma", "master-curve", "modulus"}
ONE_ARM = BatchOptions(arms=1, reading=ReadOptions(modulus="Relaxation modulus"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("kinds")
    for name, (text, _) in files().items():
        (place / name).write_text(text)
    return place


def row_of(entry, choices=ONE_ARM):
    return make_row(entry, entry.hashes(), choices)


@pytest.mark.parametrize("name", sorted(set(files()) - {"trios.txt"}))
def test_batch_row_of_every_kind_has_a_fit_or_a_reason(folder, name):
    kind = files()[name][1]
    result = row_of(Entry(str(folder / name)))
    assert result["kind"] == kind
    others = {"cld", "csr", "cyclic"}
    assert result["outcome"] == ("fitted" if kind in {*FITTED, *others} else "other")
    if kind == "cld":
        assert result["cld_force_N"] > 0
        assert result["cld_hysteresis"] > 0
        assert result["k_inf_N_per_m"] is None
    elif kind == "cyclic":
        assert result["loop_storage_N_per_m"] > 0
        assert result["loop_loss_factor"] > 0
    elif kind == "csr":
        assert result["csr_chemical_time_low_s"] > 0
    elif kind in FITTED:
        material = result["k_inf_N_per_m"] is None
        assert material == (kind not in {"relaxation", "creep"} or name == "compliance.csv")
        assert result["E_inf_Pa" if material else "k_inf_N_per_m"] >= 0
        assert (result["E_1_Pa" if material else "k_1_N_per_m"], result["tau_1_s"]) > (0, 0)
        assert (result["rms_N"] is None) == (kind != "relaxation")
    else:
        assert result["reason"].startswith("it is ")
        assert result["k_inf_N_per_m"] is None
    if kind in {"impact", "frf"}:
        assert result["measured_Hz"] == pytest.approx(14.6, abs=0.1)


def test_batch_row_is_fitted_with_the_machine_of_its_manifest(folder, tmp_path):
    (tmp_path / "rig.toml").write_text('[machine]\ncompliance = "3e-4m/N"\n')
    names = {"seal.csv": "", "a.csv": "compliance=0.3mm/N; sync=1ms", "b.csv": "rig.toml"}
    whole = (folder / "seal.csv").read_text()
    for name in names:
        (tmp_path / name).write_text(whole)
    lines = [f"{name},{machine}" for name, machine in names.items()]
    (tmp_path / "tests.csv").write_text("\n".join(["file,machine", *lines]) + "\n")
    made = batch(
        (), manifest=tmp_path / "tests.csv", arms=1, jobs=1,
        machine=Machine(compliance="0.1mm/N"),
    )  # fmt: skip
    result = {Path(entry["file"]).name: entry for entry in made.table.iter_rows(named=True)}
    for name, machine in zip(names, ("0.1mm/N", "0.3mm/N", "0.3mm/N"), strict=True):
        sync = "1ms" if name == "a.csv" else None
        stated = Machine(compliance=machine, sync=sync)
        test = read_relaxation(tmp_path / name).prepare(machine=stated)
        assert result[name]["k_inf_N_per_m"] == fit_tests(test, arms=1).model.k_inf
    assert result["a.csv"]["k_inf_N_per_m"] != result["seal.csv"]["k_inf_N_per_m"]


@pytest.mark.parametrize("name", sorted(set(files()) - {"trios.txt"}))
def test_batch_row_is_refused_for_a_machine_that_its_kind_ignores(folder, name):
    """A row says what it was asked for in vain: no option does nothing."""
    stated = replace(ONE_ARM, machine=Machine(compliance="50um/N"))
    result = row_of(Entry(str(folder / name)), stated)
    if result["outcome"] == "refused":
        assert "--machine" in result["reason"]
    else:
        assert result["outcome"] == "other" or result["kind"] == "relaxation"
    for field in HAMMER_RIG_FIELDS:
        entry = Entry(str(folder / name), machine=json.dumps({field: 0.01}))
        assert "--joint" in row_of(entry)["reason"] or result["outcome"] == "other"


def test_batch_of_python_writes_what_the_command_writes(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "seal.csv").write_text((folder / "seal.csv").read_text())
    made = dp.batch("seal.csv", to="lot", arms=1, jobs=1)
    names = ["lot.csv", "lot.html", "lot.json", "lot.xlsx"]
    by_python = {name: (tmp_path / "lot" / name).read_bytes() for name in names}
    assert by_python["lot.csv"].decode() == made.csv()
    did("batch", "seal.csv", "-o", "lot", "--arms", "1", "--jobs", "1")
    assert (tmp_path / "lot" / "lot.csv").read_bytes() == by_python["lot.csv"]
    assert (tmp_path / "lot" / "lot.html").read_bytes() == by_python["lot.html"]
    # without a folder nothing is written
    dp.batch("seal.csv", arms=1, jobs=1)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["lot", "seal.csv"]
    (tmp_path / "lot" / "lot.csv").write_text("my own table\n")
    with pytest.raises(dp.ExportError, match="was not written by dashpot"):
        dp.batch("seal.csv", to="lot", arms=1, jobs=1)


def test_quick_batch_row_evaluates_no_checks(folder, monkeypatch):
    def refuse_checks(*_args, **_how):
        raise DataError("judged")

    monkeypatch.setattr("dashpot.preprocessing.checks.motion_resolved", refuse_checks)
    name = "seal.csv"
    assert row_of(Entry(str(folder / name)), replace(ONE_ARM, quick=True))["outcome"] == "fitted"
    assert row_of(Entry(str(folder / name)))["reason"] == "judged"


@pytest.mark.parametrize("name", ["seal.csv", "frf.csv", "triangle.csv"])
def test_batch_row_states_whether_its_file_is_simulated(folder, tmp_path, name):
    text = (folder / name).read_text()
    lines = [line for line in text.splitlines(keepends=True) if "simulated" not in line]
    for head, origin in (("", ""), ("# simulated\n", "simulated")):
        (tmp_path / name).write_text(head + "".join(lines))
        assert row_of(Entry(str(tmp_path / name)))["origin"] == origin


def test_batch_row_of_load_deflection_equals_its_command(tmp_path):
    path = press_cycles(softening=0.05).write(tmp_path / "p1.csv")
    choices = BatchOptions(compression=(6e-3,), length=0.05)
    result = row_of(Entry(str(path)), choices)
    single = cld(read_cld(path, specimen=dp.Specimen(length="50mm")), at="6mm")
    assert result["cld_force_N"] == single.nominal.loading
    assert result["cld_per_100mm_N"] == 2 * single.nominal.loading
    assert (result["cld_at_m"], result["cld_set_m"]) == (6e-3, single.set)
    assert result["cld_hysteresis"] == single.cycle.hysteresis
    assert result["verdict"] == single.verdict.use
    short = row_of(Entry(str(path)), BatchOptions(compression=(12e-3,)))
    assert short["outcome"] == "refused"
    assert "12 mm was asked for" in short["reason"]
    assert short["kind"] == "cld"


def test_lot_of_load_deflection_pieces_is_evaluated_by_force(tmp_path):
    for number, scale in enumerate((1.0, 1.04, 0.97), start=1):
        truth = press_cycles(scale=scale, seed=number, softening=0.05, cycles=2)
        truth.write(tmp_path / f"p{number}.csv")
    lot = batch(tmp_path, length="50mm", compression="6mm", jobs=1)
    assert lot.main == "cld_per_100mm"
    forces = [float(seal.mean) for seal in lot.seals(lot.main)]
    assert forces[1] / forces[0] == pytest.approx(1.04, abs=0.01)
    (limits,) = read_limits(write_specimen(tmp_path), lot.table.columns)
    result = summary(lot, quantity=lot.main, limits=[limits])
    assert result.main.lowest[1].cpk > 0


def write_specimen(folder):
    path = folder / "limits.toml"
    path.write_text('[cld_per_100mm]\nlower = "2N"\nupper = "3N"\n')
    return path


def test_batch_row_of_a_hit_needs_the_indenter_mass(tmp_path):
    path = tmp_path / "hit.csv"
    path.write_text(EXAMPLES["hit.csv"]())
    result = row_of(Entry(str(path), mass=5e-3), BatchOptions(radius=5e-3))
    assert result["outcome"] == "fitted"
    assert result["indent_modulus_Pa"] == pytest.approx(4e6, rel=0.02)
    assert result["indent_modulus_low_Pa"] < result["indent_modulus_Pa"]
    assert result["restitution"] == pytest.approx(0.7935, abs=0.003)
    assert "indenter's mass" in row_of(Entry(str(path)))["reason"]


def test_a_modulus_finds_its_column_by_itself(folder):
    result = row_of(Entry(str(folder / "modulus.csv")), BatchOptions(arms=1))
    assert (result["kind"], result["outcome"]) == ("modulus", "fitted")


def test_a_file_of_no_kind_is_refused_in_the_words_of_its_reader(folder):
    result = row_of(Entry(str(folder / "trios.txt")))
    assert (result["kind"], result["outcome"]) == ("creep", "refused")
    assert "no force is held" in result["reason"]


def test_a_hammer_is_held_against_its_test_as_the_comparison_does_it(folder):
    bench, hammer = str(folder / "seal.csv"), str(folder / "hammer.csv")
    result = row_of(Entry(bench, hammer=(hammer,), mass=MASS), replace(ONE_ARM, seals=2))
    fit = fit_tests(read_relaxation(bench), arms=1)
    agreed = compare_files(
        fit, [hammer], BlockOnSeals(MASS, 2), hammer=HammerChoices(), options=ReadOptions()
    )
    held = agreed.comparison
    assert (result["predicted_Hz"], result["measured_Hz"]) == (held.predicted_hz, held.measured_hz)
    assert result["predicted_damping_ratio"] == held.predicted_damping
    assert result["measured_damping_ratio"] == held.measured_damping
    assert (result["peak_dB"], result["frac"]) == (held.ratio_db, held.frac)
    assert result["k_inf_N_per_m"] == fit.model.k_inf
    assert result["agreement"] == held.verdict.use == "do not use"
    assert "hammer: " in result["reason"]
    assert result["verdict"] == fit.verdict.use


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mass": None}, "hammer: no mass is known"),
        ({"file": "dma.csv"}, "hammer: a test of a material"),
        ({"hammer": ("nowhere.csv",)}, "hammer: "),
        ({"hammer": ("triangle.csv",)}, "hammer: "),
    ],
)
def test_a_hammer_that_cannot_be_held_against_it_leaves_the_fit(
    folder, monkeypatch, changes, message
):
    monkeypatch.chdir(folder)
    entry = replace(Entry("seal.csv", hammer=("frf.csv",), mass=MASS), **changes)
    result = row_of(entry)
    assert (result["outcome"], result["agreement"]) == ("fitted", "")
    assert message in result["reason"]


@pytest.mark.parametrize(("separate", "compared"), [(0.0, True), (30.0, False)])
def test_a_hammer_at_another_temperature_says_its_resonance_and_no_agreement(
    folder, separate, compared
):
    entry = Entry(str(folder / "seal.csv"), hammer=(str(folder / "frf.csv"),), mass=MASS)
    same = row_of(replace(entry, temperature=296.15))
    result = row_of(replace(entry, temperature=296.15, hammer_temperature=296.15 + separate))
    assert result["measured_Hz"] == same["measured_Hz"]
    assert (result["predicted_Hz"] is not None, result["agreement"] != "") == (compared, compared)
    assert ("nothing says how the model shifts to 53" in result["reason"]) != compared


@pytest.mark.once
def test_batch_joint_fit_includes_damping_of_the_hammer_test(folder, tmp_path):
    """Beside the arms of the bench's file the hammer's seals have one of 10 ms."""
    seal = dp.GeneralizedMaxwell(STIFFNESS, (40.0, *(k for k, _ in ARMS)), (0.01, 0.5, 16.0))
    frf = dp.systems.predict_frf(2 * seal, mass=MASS, frequency=np.linspace(6, 30, 60))
    noise = np.random.default_rng(7).standard_normal((2, 60)) * abs(frf.value) / 200
    hammer = tmp_path / "frf.csv"
    hammer.write_text(write_frf(replace(frf, value=frf.value + noise[0] + 1j * noise[1])))
    entry = Entry(str(folder / "seal.csv"), hammer=(str(hammer),), mass=MASS)
    result = row_of(entry, BatchOptions(arms=2, seals=2, joint=True))
    (mode,) = frf.modes()
    assert (result["method"], result["agreement"]) == ("joint", "use with care")
    assert result["measured_damping_ratio"] == pytest.approx(mode.damping_ratio, rel=0.02)
    assert result["damping_ratio"] == pytest.approx(mode.damping_ratio, rel=0.02)
    assert result["frequency_Hz"] == pytest.approx(mode.frequency, rel=2e-3)
    assert result["predicted_damping_ratio"] < mode.damping_ratio / 2


@pytest.mark.parametrize("which", [0, 1])
def test_a_file_that_changed_since_it_was_hashed_is_tried_again(folder, which):
    entry = Entry(str(folder / "seal.csv"), hammer=(str(folder / "frf.csv"),))
    hashes = list(entry.hashes())
    hashes[which] = "another"
    result = make_row(entry, hashes, ONE_ARM)
    assert result["outcome"] in RETRIED_OUTCOMES
    assert f"{(entry.file, *entry.hammer)[which]} changed while" in result["reason"]


def test_a_file_that_went_since_it_was_hashed_is_tried_again(tmp_path):
    result = make_row(Entry(str(tmp_path / "gone.csv")), ("hash",), ONE_ARM)
    assert result["outcome"] == "changed"
    assert result["reason"].endswith("gone.csv went while the batch ran; run it again")
