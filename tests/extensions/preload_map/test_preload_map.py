"""Preload map: independent numbers, levels of the tests, limits on foreign truths, refusals."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from kit.bulkdata import read_cards, real
from kit.foreign.stiffness_maps import (
    AMPLITUDES,
    COMPRESSIONS,
    FREQUENCY,
    Line,
    Part,
    cubic_seal,
    draw_part,
    loop_record,
    measure,
    table,
)

import dashpot as dp
from dashpot.base.errors import DataError, ReadError
from dashpot.cli import main
from dashpot.extensions.preload_map.fit import fit_preload_map
from dashpot.extensions.preload_map.interpolation import compute_level_weights
from dashpot.extensions.preload_map.preload_map import PreloadMap
from dashpot.extensions.preload_map.preload_sweep import PreloadSweep
from dashpot.extensions.preload_map.read import read_sweeps
from dashpot.extensions.preload_map.text import format_preload_map

BROKEN = {
    "compression and frequency": (0.1, 0.2, 0.4),
    "amplitude and frequency": (0.2, 0.4, 0.8),
    "compression and amplitude": (0.1, 0.2, 0.4),
}
"""How far a pair is from separable, in the terms of `Part`."""


def sweeps_of(lines: list[Line]) -> list[PreloadSweep]:
    return [
        PreloadSweep(FREQUENCY, line.value, 1e-3 * line.compression, 1e-3 * line.amplitude)
        for line in lines
    ]


def measured_sweeps(seed: int) -> list[PreloadSweep]:
    """A separable part on a rig, both drawn."""
    r = np.random.default_rng(seed)
    return sweeps_of(measure(draw_part(r), r))


def cubic_map(**options: object) -> PreloadMap:
    f = np.geomspace(1.0, 50.0, 25)
    sweeps = [PreloadSweep(f, cubic_seal(f, c), f"{c}mm") for c in (4, 6, 8)]
    return fit_preload_map(sweeps, **options)


@pytest.mark.parametrize(
    ("compression", "stiffness", "resonance"),
    [
        ("4mm", 312.102 + 2.768j, 12.3301),
        ("6mm", 385.695 + 3.421j, 13.7069),
        ("8mm", 488.727 + 4.334j, 15.4295),
    ],
)
def test_cubic_law_has_the_independent_stiffness_and_resonance(
    compression: str, stiffness: complex, resonance: float
):
    preload_map = cubic_map(mass="104g", seals=2)
    value = preload_map.evaluate("12.71Hz", compression=compression).value[0]
    assert value == pytest.approx(stiffness, rel=5e-6)
    at = preload_map.find_resonance("104.0426g", seals=2, compression=compression)
    assert at.frequency == pytest.approx(resonance, abs=4e-3)
    low, high = at.frequency_limits
    assert low < at.frequency < high


def test_map_passes_through_its_levels_and_follows_a_cubic_law_between():
    preload_map = cubic_map()
    for c in (4.5, 5.0, 7.0, 7.6):
        truth = cubic_seal([10.0], c)[0]
        at = preload_map.evaluate(np.array([10.0]), compression=1e-3 * c)
        assert at.value[0] == pytest.approx(truth, rel=2e-3)
    weights = compute_level_weights(np.array([1.0, 2.0, 4.0, 5.0]), 4.0)
    np.testing.assert_allclose(weights.parabolic, [0, 0, 1, 0], atol=1e-12)
    # four levels of a parabola: between them the interpolation is exact
    nodes = np.array([1.0, 2.0, 4.0, 5.0])
    assert compute_level_weights(nodes, 3.1).parabolic @ nodes**2 == pytest.approx(3.1**2)


def test_chances_of_separable_parts_are_below_5_percent_in_one_of_20():
    """300 separable parts: the level of every pair, at 5 and at 1 %."""
    chances = np.array([
        [test.chance for test in fit_preload_map(measured_sweeps(seed)).pairs]
        for seed in range(300)
    ])  # fmt: skip
    # 300 draws: 5 % +- 1.26 % at one standard deviation
    assert np.all(np.abs((chances < 0.05).mean(axis=0) - 0.05) < 0.03)
    assert np.all((chances < 0.01).mean(axis=0) < 0.028)


@pytest.mark.parametrize(("repeats", "seeds"), [(1, 200), (2, 80)])
@pytest.mark.parametrize("common", [True, False])
def test_limits_hold_the_truth_in_19_of_20_parts(repeats: int, seeds: int, *, common: bool):
    """Storage, loss, loss factor and magnitude at every setting, off the measured lines."""
    inside, every = np.zeros(4), 0
    f = np.geomspace(1.2, 48.0, 9)
    errors = {} if common else {"gain_error": 0.0, "phase_error": 0.0}
    for seed in range(seeds):
        r = np.random.default_rng(seed)
        part = draw_part(r)
        lines = measure(part, r, repeats=repeats, common=common)
        preload_map = fit_preload_map(sweeps_of(lines), **errors)
        for c in COMPRESSIONS:
            for X in AMPLITUDES:
                inside += compute_held_shares(preload_map, part, f, c, X)
                every += 1
    assert np.all(inside / every >= 0.92), inside / every
    assert np.all(inside / every <= 0.98), inside / every


def compute_held_shares(
    preload_map: PreloadMap, part: Part, f: np.ndarray, c: float, X: float
) -> np.ndarray:
    """Shares of frequencies at which the limits hold the truth."""
    at = preload_map.evaluate(f, compression=1e-3 * c, amplitude=1e-3 * X)
    truth, eta = part.stiffness(f, c, X), at.value.imag / at.value.real
    return np.array([
        np.mean(np.abs(at.value.real - truth.real) <= at.storage_error),
        np.mean(np.abs(at.value.imag - truth.imag) <= at.loss_error),
        np.mean(np.abs(eta - truth.imag / truth.real) <= at.loss_factor_error),
        np.mean(np.abs(np.abs(at.value / truth) - 1) <= at.magnitude_error),
    ])  # fmt: skip


def test_limits_hold_between_levels_too():
    inside, every = np.zeros(4), 0
    f = np.geomspace(1.2, 48.0, 5)
    for seed in range(100):
        r = np.random.default_rng(seed)
        part = draw_part(r)
        preload_map = fit_preload_map(sweeps_of(measure(part, r)))
        for c, X in ((4.5, 0.07), (5.75, 0.15), (7.2, 0.32)):
            inside += compute_held_shares(preload_map, part, f, c, X)
            every += 1
    assert np.all(inside / every >= 0.92), inside / every


@pytest.mark.parametrize("broken", BROKEN)
def test_of_maps_to_be_used_none_is_of_a_part_that_is_not_separable(broken: str):
    """A miss is a use of a part that departs by more than 5 % or 0.02 rad."""
    used, missed, separate = 0, 0, 0
    for seed in range(60):
        r = np.random.default_rng(seed)
        part = draw_part(r, broken, by=BROKEN[broken][seed % 3])
        size, angle = part.departure
        excess = size > 0.05 or angle > 0.02
        verdict = fit_preload_map(sweeps_of(measure(part, r))).verdict
        used += verdict.use == "use"
        missed += verdict.use == "use" and excess
        separate += excess
    assert missed <= 0.04 * used
    assert separate >= 5


def test_separable_parts_are_used():
    verdicts = []
    for seed in range(40):
        preload_map = fit_preload_map(measured_sweeps(seed), phase_error="0.1deg")
        verdicts.append(preload_map.verdict.use)
    assert verdicts.count("use") >= 36


def test_scatter_between_sweeps_comes_from_repeats_or_the_user():
    """Settings that differ by 1 % are a departure, unless repeats or the user say that they do."""
    r = np.random.default_rng(4)
    part = draw_part(r)
    lines = [
        line._replace(value=line.value * np.exp(0.01 * r.standard_normal()))
        for line in measure(part, r)
    ]
    single, stated = (
        {test.pair: test.chance for test in fit_preload_map(sweeps_of(lines), **options).pairs}
        for options in ({}, {"repeatability": 0.01})
    )
    assert single["compression and amplitude"] < 1e-4
    assert stated["compression and amplitude"] > 0.01


def test_pairs_without_combinations_are_not_tested():
    r = np.random.default_rng(1)
    star = [
        line
        for line in measure(draw_part(r), r)
        if line.compression == COMPRESSIONS[1] or line.amplitude == AMPLITUDES[1]
    ]
    preload_map = fit_preload_map(sweeps_of(star))
    tested = {test.pair: test.tested for test in preload_map.pairs}
    assert tested == {
        "compression and frequency": True,
        "amplitude and frequency": True,
        "compression and amplitude": False,
    }
    assert preload_map.verdict.use == "use with care"
    assert "compression and amplitude" in str(preload_map.verdict)


def test_sweeps_may_have_different_frequencies():
    r = np.random.default_rng(3)
    part = draw_part(r)
    sweeps = []
    for i, c in enumerate(COMPRESSIONS):
        f = np.geomspace(1.0, 50.0, 20 + i)
        noise = 2e-3 * (r.standard_normal(len(f)) + 1j * r.standard_normal(len(f)))
        value = part.stiffness(f, c, 0.1) * np.exp(noise)
        sweeps.append(PreloadSweep(f, value, 1e-3 * c, 1e-4))
    preload_map = fit_preload_map(sweeps)
    at = preload_map.evaluate(np.array([10.0]), compression="5mm")
    assert at.value[0] == pytest.approx(part.stiffness([10.0], 5.0, 0.1)[0], rel=5e-3)


def test_pair_is_called_separable_where_its_check_passes():
    """A clear departure that is too small to matter is no reason against a map."""
    f = np.geomspace(1.0, 50.0, 25)
    sweeps = [
        PreloadSweep(f, cubic_seal(f, c) * np.exp(2e-4 * (c - 6) * np.log(f)), f"{c}mm")
        for c in (4, 6, 8)
    ]
    preload_map = fit_preload_map(sweeps)
    (pair,) = preload_map.pairs
    (check,) = (c for c in preload_map.checks if c.name == "compression_and_frequency_separable")
    assert pair.chance < 1e-3
    assert check.passed
    (row,) = (
        line for line in text_of(preload_map) if line.strip().startswith("compression and freq")
    )
    assert "yes" in row


def text_of(preload_map: PreloadMap) -> list[str]:
    return format_preload_map(preload_map).lines


def test_table_may_stand_for_its_sweeps(records: Path):
    table_of_sweeps = dp.read(records / "map.csv")
    direct, by_sweeps = (fit_preload_map(of) for of in (table_of_sweeps, table_of_sweeps.sweeps))
    assert direct == by_sweeps


# -- files and the command -------------------------------------------------------------------------


@pytest.fixture
def records(tmp_path: Path) -> Path:
    r = np.random.default_rng(7)
    (tmp_path / "map.csv").write_text(table(measure(draw_part(r), r)), encoding="utf-8")
    return tmp_path


def run(*words: object) -> tuple[int, str]:
    done = CliRunner().invoke(main, [str(word) for word in words])
    return done.exit_code, done.output


def test_command_writes_page_table_decks_and_document(records: Path):
    source = records / "map.csv"
    for name in ("map.html", "map.csv.csv", "map.m", "map.json"):
        code, text = run("map", source, "-o", records / name, "--phase-error", "0.1deg")
        assert code == 0, text
    document = json.loads((records / "map.json").read_text(encoding="utf-8"))
    assert document["schema"] == "dashpot/preload-map@1"
    again = dp.read(records / "map.json")
    assert again.evaluate("10Hz", compression="5mm").value[0].real > 0
    page = (records / "map.html").read_text(encoding="utf-8")
    assert "<svg" in page
    assert "compression and amplitude" in page
    rows = (records / "map.csv.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0].startswith("compression [m],amplitude [m],frequency [Hz],storage [N/m]")
    script = (records / "map.m").read_text(encoding="utf-8")
    assert script.count("K(:,") == len(COMPRESSIONS) * len(AMPLITUDES)


def test_solver_tables_hold_the_map(records: Path):
    preload_map = fit_preload_map(read_sweeps([records / "map.csv"]))
    code, text = run("map", records / "map.csv", "--unit-system", "mm-t-s",
                     "-o", records / "seal.inp")  # fmt: skip
    assert code == 0, text
    deck = (records / "seal.inp").read_text(encoding="utf-8")
    stiff, damped = (
        [tuple(map(float, re.sub(r", ,", ",", row).split(","))) for row in part.splitlines()
         if re.match(r"^-?\d", row)]
        for part in deck.split("*CONNECTOR DAMPING")
    )  # fmt: skip
    assert len(stiff) == len(damped)
    for (k, f, c, X), (eta, *_) in list(zip(stiff, damped, strict=True))[::97]:
        at = preload_map.evaluate(np.array([f]), compression=1e-3 * c, amplitude=1e-3 * X).value[0]
        assert 1e3 * k == pytest.approx(at.real, rel=1e-7)
        assert eta == pytest.approx(at.imag / at.real, rel=1e-7)
    code, text = run("map", records / "map.csv", "--unit-system", "mm-t-s",
                     "-o", records / "seal.bdf")  # fmt: skip
    assert code == 0, text
    bulk = (records / "seal.bdf").read_text(encoding="utf-8")
    cards = read_cards(bulk)
    tables = {
        int(fields[0]): np.array([real(field) for field in fields[8:] if field not in {"", "ENDT"}])
        for name, fields in cards
        if name == "TABLED1"
    }
    bushes = [int(fields[0]) for name, fields in cards if name == "PBUSH"]
    settings = [(c, X) for c in COMPRESSIONS for X in AMPLITUDES]
    assert len(bushes) == len(settings)
    for number, (c, X) in zip(bushes, settings, strict=True):
        f, storage = tables[number][::2], tables[number][1::2]
        eta = tables[number + 1][1::2]
        at = preload_map.evaluate(f, compression=1e-3 * c, amplitude=1e-3 * X).value
        np.testing.assert_allclose(1e3 * storage * (1 + 1j * eta), at, rtol=1e-7)


def test_saved_map_writes_what_its_files_write(records: Path):
    saved = records / "map.json"
    run("map", records / "map.csv", "-o", saved)
    for source, name in ((records / "map.csv", "files.csv"), (saved, "saved.csv")):
        code, text = run("map", source, "-o", records / name)
        assert code == 0, text
    direct, again = (
        np.loadtxt(records / name, delimiter=",", skiprows=1) for name in ("files.csv", "saved.csv")
    )
    np.testing.assert_allclose(again, direct, rtol=1e-6)
    code, text = run("map", saved, "--band", "2:20Hz")
    assert code != 0
    assert "a saved map is not fitted again" in " ".join(text.split())


def test_compression_option_states_that_of_each_file(records: Path):
    r = np.random.default_rng(7)
    lines = measure(draw_part(r), r)
    names = []
    for c in COMPRESSIONS:
        rows = table([line for line in lines if line.compression == c]).splitlines()
        path = records / f"c{c:g}.csv"
        path.write_text("\n".join(row.split(",", 1)[1] for row in rows), encoding="utf-8")
        names.append(path)
    stated = [word for c in COMPRESSIONS for word in ("--compression", f"c{c:g}.csv:{c:g}mm")]
    code, text = run("map", *names, *stated, "-o", records / "apart.json")
    assert code == 0, text
    run("map", records / "map.csv", "-o", records / "together.json")
    document, together = (
        json.loads((records / f"{name}.json").read_text(encoding="utf-8"))
        for name in ("apart", "together")
    )
    assert document["compression_factor"] == pytest.approx(together["compression_factor"])
    code, text = run("map", *names, *stated[2:])
    assert code != 0
    assert "--compression c4.csv:4mm" in text


def test_repeated_sweeps_of_a_table_show_their_scatter(records: Path):
    r = np.random.default_rng(7)
    text = table(measure(draw_part(r), r, repeats=2))
    (records / "twice.csv").write_text(text, encoding="utf-8")
    preload_map = fit_preload_map(read_sweeps([records / "twice.csv"]))
    assert {cell.sweeps for cell in preload_map.cells} == {2}
    (noted,) = (check for check in preload_map.checks if check.name == "repeatability_determined")
    assert noted.passed
    assert preload_map.sweep_scatter[0] == pytest.approx(2e-3, rel=0.6)


def test_amplitude_that_is_peak_to_peak_is_halved(records: Path):
    text = (records / "map.csv").read_text(encoding="utf-8")
    (records / "pp.csv").write_text(
        text.replace("amplitude [mm]", "amplitude p-p [mm]"), encoding="utf-8"
    )
    sweeps = read_sweeps([records / "pp.csv"])
    assert min(float(sweep.amplitude) for sweep in sweeps) == pytest.approx(0.025e-3)
    assert "peak to peak" in " ".join(sweeps[0].source.notes)


def test_frf_of_a_mass_is_read_without_its_inertia(tmp_path: Path):
    f = np.arange(4.0, 40.0, 0.25)
    w2 = (2 * np.pi * f) ** 2
    rows = {}
    for c in (4, 6, 8):
        value = -w2 / (2 * cubic_seal(f, c) - 0.104 * w2)
        rows[c] = "\n".join([
            "frequency [Hz],real [(m/s^2)/N],imag [(m/s^2)/N]",
            *(f"{a:.4f},{v.real:.9g},{v.imag:.9g}" for a, v in zip(f, value, strict=True)), "",
        ])  # fmt: skip
        (tmp_path / f"f{c}.csv").write_text(rows[c], encoding="utf-8")
    sweeps = read_sweeps(
        [tmp_path / f"f{c}.csv" for c in (4, 6, 8)],
        compressions=[(f"f{c}.csv", 1e-3 * c) for c in (4, 6, 8)], mass=0.104, seals=2,
    )  # fmt: skip
    for c, sweep in zip((4, 6, 8), sweeps, strict=True):
        np.testing.assert_allclose(sweep.value, cubic_seal(f, c), rtol=1e-5)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--unit-system", "mm-t-s"), "add -o FILE.bdf or FILE.inp"),
        (("-o", "seal.bdf"), "add --unit-system mm-t-s"),
        (("--seals", "2"), "add --mass MASS"),
        (("--mass", "50kg"), "lies below the measured band"),
        (("--compression", "x.csv:4mm"), "suits none of the files: map.csv"),
        (("--band", "100:200Hz"), "has no line from 100 to 200 Hz"),
        (("--gain-error", "80%"), "expected below 0.5"),
        (("--compression", "4mm"), "compression values that differ"),
        (("--amplitude", "0.1mm"), "amplitude values that differ"),
    ],
)
def test_what_makes_no_sense_is_refused_in_a_sentence(
    records: Path, words: tuple[str, ...], message: str
):
    code, text = run("map", records / "map.csv", *words)
    assert code != 0
    assert message in " ".join(text.split())


def test_report_names_the_command_of_a_map(records: Path):
    code, text = run("report", records / "map.csv")
    assert code != 0
    assert "Use dashpot map." in " ".join(text.split())
    assert "dashpot fit" not in text


def test_records_that_make_no_map_are_refused():
    preload_sweep = PreloadSweep([1, 10, 20], [300 + 9j] * 3, "4mm", "0.1mm")
    cases = [
        ([preload_sweep], "found 1 sweep"),
        (
            [preload_sweep, PreloadSweep([1, 10, 20], [310 + 9j] * 3, "4mm", "0.1mm")],
            "needs two compressions or more",
        ),
        (
            [preload_sweep, PreloadSweep([1, 10, 20], [300 + 9j] * 3, "6mm", "0.1mm")],
            "sweep .* at 6 mm has",
        ),
        (
            [preload_sweep, PreloadSweep([1, 10, 20], [300 + 9j] * 3, "6mm")],
            "no amplitude is known",
        ),
        (
            [preload_sweep, PreloadSweep([1, 10], [300 + 9j] * 2, "6mm", "0.1mm")],
            "too few frequencies at 6 mm",
        ),
    ]
    for sweeps, message in cases:
        with pytest.raises(DataError, match=message):
            fit_preload_map(sweeps)
    for fields, message in (
        (([1, 10], [300 + 9j], "4mm"), "as many of each"),
        (([1, 10], [300 + 9j, -3], "4mm"), "storage at 10 Hz"),
        (([1, 10], [300 + 9j] * 2, "4m"), "compression = 4 m"),
        (([1, 10], [300 + 9j] * 2, "4mm", "5mm"), "lose contact"),
    ):
        with pytest.raises(DataError, match=message):
            PreloadSweep(*fields)


def test_sweeps_that_change_two_things_at_once_are_refused():
    r = np.random.default_rng(1)
    wanted = dict(zip(COMPRESSIONS, AMPLITUDES, strict=True))
    lines = [
        line for line in measure(draw_part(r), r) if wanted[line.compression] == line.amplitude
    ]
    with pytest.raises(DataError, match="cannot be distinguished"):
        fit_preload_map(sweeps_of(lines))


def test_a_map_is_not_extrapolated():
    preload_map = cubic_map()
    for at, message in (
        ({"frequency": "80Hz", "compression": "6mm"}, "frequency = 80 Hz"),
        ({"frequency": "10Hz", "compression": "9mm"}, "compression = 9 mm"),
        ({"frequency": "10Hz", "compression": "6mm", "amplitude": "1mm"}, "leave the amplitude"),
    ):
        with pytest.raises(DataError, match=message):
            preload_map.evaluate(**at)


def test_a_material_is_refused(tmp_path: Path):
    r = np.random.default_rng(1)
    text = table(measure(draw_part(r), r)).replace("[N/mm]", "[MPa]")
    (tmp_path / "material.csv").write_text(text, encoding="utf-8")
    with pytest.raises(ReadError, match="of a material"):
        read_sweeps([tmp_path / "material.csv"])


@pytest.mark.parametrize(
    ("head", "message"),
    [
        ("compression [mm],amplitude [%]", "amplitude has several values"),
        ("compression [mm],amplitude [N]", "amplitude has several values"),
        ("compression [mm],amplitude", '--units "amplitude=mm"'),
        ("compression [mm],strain [%]", "call it 'amplitude [mm]'"),
        ("compression [%],amplitude [mm]", "compression has several values"),
        ("preload [N],amplitude [mm]", "not taken for the compression"),
        ("compression,amplitude [mm]", '--units "compression=mm"'),
    ],
)
def test_settings_that_are_no_lengths_are_not_lost(records: Path, head: str, message: str):
    """Else amplitudes would be pooled, and a table of compressions be said to have none."""
    text = (records / "map.csv").read_text(encoding="utf-8")
    text = text.replace("compression [mm],amplitude [mm]", head)
    (records / "odd.csv").write_text(text, encoding="utf-8")
    code, printed = run("map", records / "odd.csv")
    assert code != 0
    assert message in " ".join(printed.split())


def test_units_of_a_table_may_be_typed(records: Path):
    text = (records / "map.csv").read_text(encoding="utf-8")
    bare = re.sub(r" \[[^]]*\]", "", text)
    (records / "bare.csv").write_text(bare, encoding="utf-8")
    code, printed = run("map", records / "bare.csv")
    assert code != 0
    units = "compression=mm,amplitude=mm,frequency=Hz,storage=N/mm,loss=N/mm"
    assert f'--units "{units}"' in " ".join(printed.split())
    code, printed = run("map", records / "bare.csv", "--units", units)
    assert code == 0
    stated, typed = run("map", records / "map.csv")[1], printed
    assert typed.split("\n", 1)[1] == stated.split("\n", 1)[1]


def test_a_column_of_one_level_is_no_lost_setting(records: Path):
    """A strain or displacement that does not step says nothing of the settings."""
    lines = (records / "map.csv").read_text(encoding="utf-8").splitlines()
    more = [
        f"{lines[0]},strain [%]",
        *(f"{line},{2 + i % 2 / 100:g}" for i, line in enumerate(lines[1:])),
    ]
    (records / "more.csv").write_text("\n".join(more) + "\n", encoding="utf-8")
    assert run("map", records / "more.csv")[0] == 0


def test_recorded_loops_make_the_map_of_their_part(tmp_path: Path):
    """A record at each compression, of all amplitudes and frequencies, from another generator."""
    r = np.random.default_rng(5)
    part = draw_part(r)
    stated = []
    for c in COMPRESSIONS:
        name = f"loops_{c:g}mm.csv"
        (tmp_path / name).write_text(loop_record(part, c, r), encoding="utf-8")
        stated.append((name, 1e-3 * c))
    sweeps = read_sweeps([tmp_path / name for name, _ in stated], compressions=stated)
    assert len(sweeps) == len(COMPRESSIONS) * len(AMPLITUDES)
    result = fit_preload_map(sweeps, gain_error=0.0, phase_error=0.0)
    assert len(result.pairs) == 3
    assert all(pair.chance > 1e-3 for pair in result.pairs)
    f = np.array([1.0, 1.5, 5.0, 15.0, 20.0])
    for c in COMPRESSIONS:
        for X in AMPLITUDES:
            # the nominal setting is inside, though its loops were measured a little smaller
            at = result.evaluate(f, compression=1e-3 * c, amplitude=1e-3 * X)
            assert at.value == pytest.approx(part.stiffness(f, c, X), rel=1e-3)


def test_loops_of_a_part_that_is_not_separable_make_no_map_for_use(tmp_path: Path):
    r = np.random.default_rng(6)
    part = draw_part(r, "amplitude and frequency", 0.8)
    stated = []
    for c in COMPRESSIONS:
        name = f"loops_{c:g}mm.csv"
        (tmp_path / name).write_text(loop_record(part, c, r), encoding="utf-8")
        stated.append((name, 1e-3 * c))
    files = [tmp_path / name for name, _ in stated]
    result = fit_preload_map(read_sweeps(files, compressions=stated))
    assert result.verdict.use != "use"


def test_loops_without_a_stated_compression_are_refused(tmp_path: Path):
    r = np.random.default_rng(5)
    (tmp_path / "loops.csv").write_text(loop_record(draw_part(r), 4.0, r), encoding="utf-8")
    with pytest.raises(ReadError, match="the file says no compression"):
        read_sweeps([tmp_path / "loops.csv"])


@pytest.mark.parametrize("loss", ["loss factor", "loss [N/mm]"])
def test_inspect_names_every_column_of_a_map(tmp_path: Path, loss: str) -> None:
    head = f"compression [mm],amplitude [mm],frequency [Hz],storage [N/mm],{loss}"
    rows = [
        f"{c},{a},{f},{c + f},{0.1 * f}" for c in (4, 8) for a in (0.1, 0.5) for f in range(1, 12)
    ]
    (tmp_path / "map.csv").write_text("\n".join([head, *rows]) + "\n")
    inspected = dp.inspect(tmp_path / "map.csv")
    assert (inspected.kind, inspected.questions) == ("preload-map", ())
    last = "loss factor" if loss == "loss factor" else "loss"
    assert [column.role for column in inspected.columns] == [
        "compression", "amplitude", "frequency", "storage", last,
    ]  # fmt: skip
