"""First commands of a new user with files of every kind, and the answers."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import click
import numpy as np
import pytest
from kit.kinds import bench, files, hammer, late, ramp_and_hold
from kit.shell import did, run_json

from dashpot.cli._terminal import to_stdout
from dashpot.cli.fit_handlers import FitRequest
from dashpot.datamodel.specimen import Specimen
from dashpot.reading.read_options import load_profile

FILES = files()
FIT = {
    "schema": "dashpot/fit@2",
    "model": {"k_inf": 200.0, "arms": [{"k": 120.0, "tau": 0.5}, {"k": 18.0, "tau": 16.0}]},
}
NAMED = ("--column", "hammer=ch1,acceleration=ch2", "--column", "acceleration=ch3")
UNITS = ("--units", "time=s,hammer=N,acceleration=m/s^2")


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a file of every kind, where the commands run."""
    monkeypatch.chdir(tmp_path)
    for name, (text, _) in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "fit.json").write_text(json.dumps(FIT))
    (tmp_path / "channels.csv").write_text(hammer("ch1,ch2,ch3").replace("time [s]", "t"))
    (tmp_path / "late.csv").write_text(late(1e-5))
    return tmp_path


def run(*words: str, code: int = 0) -> str:
    """What a command prints on both streams."""
    return did(*words, code=code).output


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("fit trios.txt", "dashpot: trios.txt: no force is held: expected a load that rises"),
        ("fit creep.csv --elastic linear", "--elastic is for a relaxation test. creep.csv is a"),
        ("fit creep.csv seal.csv", "a creep test is fitted alone"),
        ("report creep.csv", "creep.csv is a creep test. .* Type: dashpot fit creep.csv"),
        ("report compliance.csv", "compliance.csv is a creep .* Type: dashpot fit comp"),
        ("fit triangle.csv --kind relaxation", "no hold, but a triangle, a ramp up and down"),
        ("fit fatigue.csv --kind relaxation", r"but a cyclic \(fatigue\) run .*and \d+ more"),
        ("fit warming.csv", "warming.csv is a temperature sweep at one frequency: it shows no"),
        ("fit waiting.csv", "waiting.csv is .*: it shows no relaxation times; sweep the freq"),
        ("fit late.csv", "the record begins within its ramp, or after it"),
        ("fit compliance.csv --column modulus=2", "is a compliance"),
        ("fit ball.csv", "--mass 5g"),
        ("fit hammer.csv --radius 5mm", "--radius is for a rebound indentation. hammer.csv is"),
        ("fit frf.csv --band 900:950Hz", "modes need at least 8, and the FRF has lines from"),
        ("fit dma.csv --mass 104g", r"--mass is for .*dma.csv is a dynamic \(DMA\) sweep"),
        ("report hammer.csv", "needs a relaxation test, and here is none.* dashpot fit hammer.csv"),
        ("report dma.csv", r"is a dynamic \(DMA\) sweep.* Type: dashpot fit dma.csv"),
        ("compare fit.json seal.csv --mass 104g", "seal.csv is a relaxation test. Compare a fit w"),
        ("compare hammer.csv fit.json --mass 104g", "hammer.csv is a hammer test; fit.json is a f"),
        ("fit seal.csv --mass 104g", "--mass is for .*seal.csv is a relaxation test"),
        ("compare fit.json base.csv", "over the mass and neither alone: give the mass"),
        ("predict fit.json --mass 104", "for example '104g'"),
        ("predict fit.json --mass 104g --compression 8", "for example '8mm'"),
        ("fit seal.csv --temperature 23", "for example '23degC'"),
    ],
)  # fmt: skip
def test_a_wrong_file_is_named_with_the_command_that_wants_it(
    lab: Path, words: str, message: str
) -> None:
    printed = " ".join(run(*words.split(), code=2).split())
    assert re.search(message, printed), printed
    assert "Traceback" not in printed


def test_fit_names_both_accelerations_and_keeps_the_choice_in_a_profile(lab: Path) -> None:
    assert '--column time="t" --column' in run("fit", "channels.csv", code=2)
    process = run("fit", "channels.csv", "--kind", "impact", code=2)
    assert (
        '--column acceleration="ch2" --column acceleration="ch3" --column hammer="ch1"' in process
    )
    process = run("fit", "channels.csv", *NAMED, code=2)
    assert "'t' (time) has no unit, nor has 'ch1' (hammer)" in process
    assert '--units "time=s,hammer=N,acceleration=m/s^2"' in process
    run("inspect", "channels.csv", *NAMED, *UNITS, "--save", "lab.toml")
    read_options = load_profile("lab.toml")
    assert read_options.acceleration == ("ch2", "ch3")
    assert read_options.hammer == "ch1"
    numbers = ("--column", "hammer=2,acceleration=3", "--column", "acceleration=4")
    printed = []
    for words in ((*NAMED, *UNITS), (*numbers, *UNITS), ("--profile", "lab.toml")):
        result, follow = run("fit", "channels.csv", *words).split("next: ")
        # what was said of the file is said again
        assert sorted(shlex.split(follow, comments=True)[-len(words) :]) == sorted(words)
        printed.append(result)
    assert printed[0] == printed[1] == printed[2]
    weighed = ("--mass", "104g", "--seals", "2")
    compared = [
        run("compare", "fit.json", "channels.csv", *weighed, *how)
        for how in ((*NAMED, *UNITS), ("--profile", "lab.toml"))
    ]
    assert compared[0].partition("next: ")[0] == compared[1].partition("next: ")[0]
    how = ("--profile", "lab.toml", "--arms", "1")
    assert run_json("fit", "channels.csv", *weighed, *how)["model"]["k_inf"] > 0


def test_fit_asks_separately_about_the_second_file(lab: Path) -> None:
    odd = bench(ramp_and_hold(), head="a,b,c")
    (lab / "odd.csv").write_text(odd)
    words = ("fit", "frf.csv", "odd.csv", "--mass", "104g", "--seals", "2")
    text = " ".join(run(*words, code=2).split())
    assert "odd.csv" in text
    named = ("--column", "time=a,displacement=b,force=c")
    units = ("--units", "time=s,displacement=mm,force=N")
    run("inspect", "odd.csv", *named, *units, "--save", "odd.toml")
    document = run_json(*words, "--profile", "odd.csv:odd.toml", "--arms", "2")
    assert document["model"]["k_inf"] == pytest.approx(200, rel=0.2)
    text = run("report", "odd.csv", "channels.csv", "--mass", "104g",
                *named, *units, code=2)  # fmt: skip
    assert "channels.csv" in text


def test_predict_reads_its_record_with_the_stated_columns(lab: Path) -> None:
    (lab / "odd.csv").write_text(bench(ramp_and_hold(), head="a,b,c"))
    named = ("--column", "time=1,displacement=2,force=3",
             "--units", "time=s,displacement=mm,force=N")  # fmt: skip
    run("fit", "odd.csv", *named, "--arms", "2", "-o", "fitted.json")
    words = ("predict", "fitted.json", "--mass", "104g", "--seals", "2", "--record", "odd.csv")
    assert "looks like time" in " ".join(run(*words, code=2).split())
    run(*words, *named)


def test_predict_refuses_a_record_that_was_not_fitted(lab: Path) -> None:
    run("fit", "seal.csv", "--arms", "2", "-o", "fitted.json")
    (lab / "other.csv").write_text(bench(1.01 * ramp_and_hold()))
    words = ("predict", "fitted.json", "--mass", "104g", "--seals", "2", "--record")
    text = " ".join(run(*words, "other.csv", code=2).split())
    assert "other.csv is not what was fitted" in text
    assert "the fit is of seal.csv" in text
    run(*words, "seal.csv")


def test_a_comparison_draws_the_bound_where_the_record_is_at_hand(lab: Path) -> None:
    run("fit", "seal.csv", "--arms", "2", "-o", "fitted.json")
    words = ("compare", "fitted.json", "frf.csv", "--mass", "104g", "--seals", "2")
    bound, interval = "95 % bounds over all spectra", "95 % interval of the parameters"
    run(*words, "--plot", "without.svg")
    text = (lab / "without.svg").read_text()
    assert interval in text
    assert bound not in text
    run(*words, "--record", "seal.csv", "--plot", "with.svg")
    both = (lab / "with.svg").read_text()
    assert interval in both
    assert bound in both
    (lab / "other.csv").write_text(bench(1.01 * ramp_and_hold()))
    message = " ".join(run(*words, "--record", "other.csv", code=2).split())
    assert "other.csv is not what was fitted" in message


@pytest.mark.parametrize(("rate", "code"), [("25Hz", 0), ("25.2Hz", 0), ("25.3Hz", 2), ("50Hz", 2)])
def test_a_rate_that_the_clock_contradicts_is_refused(lab: Path, rate: str, code: int) -> None:
    text = " ".join(run("fit", "seal.csv", "--arms", "1", "--rate", rate, code=code).split())
    assert ("runs at 25 Hz: leave --rate out" in text) is (code == 2)


@pytest.mark.parametrize(
    "words", ["--mass 104kg", "--mass 0.5kg", "--mass 104g --compression 2600mm"]
)
def test_a_seal_is_not_pressed_three_times_as_deep_as_tested(lab: Path, words: str) -> None:
    run("fit", "seal.csv", "--arms", "2", "-o", "fitted.json")
    text = " ".join(run("predict", "fitted.json", *words.split(), code=2).split())
    assert re.search(r"presses the seal by .* mm, but it was tested to 8 mm: check", text)


def test_a_mass_in_the_wrong_unit_leads_the_verdict(lab: Path) -> None:
    run("fit", "seal.csv", "--arms", "2", "-o", "fitted.json")
    light = " ".join(run("predict", "fitted.json", "--mass", "0.104g").split())
    assert light.startswith(
        "Use with care: the mass is 0.104 g. An accelerometer alone weighs more."
    )
    heavy = " ".join(run("predict", "fitted.json", "--mass", "0.49kg").split())
    assert re.match(r"Use with care: the seals are pressed by 2\d\.\d+ mm, 2\.\d+ times", heavy)
    comma = " ".join(run("predict", "fitted.json", "--mass", "104,0g", code=2).split())
    assert "'104,0g' has a decimal comma; write '104.0g' with a point" in comma


def test_a_cycle_is_chosen_by_its_number(lab: Path) -> None:
    time = np.arange(0, 40, 0.04)
    twice = 8e-3 * np.interp(time % 20, [0, 1, 2, 16, 17, 20], [0, 0, 1, 1, 0, 0])
    (lab / "twice.csv").write_text(bench(twice, time=time))
    ends = []
    for number in (1, 2):
        document = run_json("inspect", "twice.csv", "--file-part", f"cycle={number}")
        ends.append(document["files"][0]["preparation"]["hold_end"])
    assert ends == pytest.approx([16, 36], abs=0.1)
    assert "cycle 3 was asked for" in run("fit", "twice.csv", "--file-part", "cycle=3", code=2)
    noted = " ".join(run("inspect", "twice.csv", "-v").split())
    assert "Choose another. (--file-part cycle=N)" in noted


def test_a_sweep_is_chosen_by_its_temperature(lab: Path) -> None:
    text, _ = FILES["dma.csv"]
    head, *rows = text.splitlines()
    both = [f"{row},{degrees}" for degrees in (20, 60) for row in rows]
    (lab / "both.csv").write_text("\n".join([f"{head},temperature [degC]", *both]))
    document = run_json("fit", "both.csv", "--at-temperature", "60degC")
    assert document["model"]["k_inf"] == pytest.approx(0.2e6, rel=1e-3)
    assert document["temperature"] is None
    assert "--at-temperature takes one of them" in run(
        "fit", "both.csv", "--temperature", "60degC", code=2
    )
    both = " ".join(
        run("fit", "both.csv", "--at-temperature", "60degC", "--shift", "wlf", code=2).split()
    )
    assert "leave out --reference, --shift, --vertical and --shifts" in both


@pytest.mark.parametrize("noise", [0.002, 0.03])
def test_the_residual_of_a_sweep_is_per_cent(lab: Path, noise: float) -> None:
    head, *rows = FILES["dma.csv"][0].splitlines()
    values = np.array([row.split(",") for row in rows], dtype=float)
    values[:, 2:] *= 1 + noise * np.random.default_rng(5).standard_normal((len(values), 2))
    lines = [head, *(",".join(map(repr, row)) for row in values.tolist())]
    (lab / "noisy.csv").write_text("\n".join(lines))
    residual = run_json("fit", "noisy.csv")["residual"]
    assert residual["unit"] == "1"
    assert residual["rms"] == pytest.approx(noise, rel=0.25)
    assert f"{100 * residual['rms']:.3g} % rms" in run("fit", "noisy.csv")


def test_the_end_of_the_band_is_no_peak(lab: Path) -> None:
    light = ("predict", "fit.json", "--mass", "2g")
    far = run(*light)
    assert re.search(r"largest value of the accelerance [\d.]+ 1/kg at 50 Hz", far)
    assert "This is the end of the band, not a peak. Add --band" in far
    band = far.partition("--band ")[2].partition(" ")[0]
    assert re.search(r" peak of the accelerance .* at 65\.4\d* Hz", run(*light, "--band", band))
    document = run_json(*light)
    assert document["peak"]["at_edge"]


def test_an_frf_without_coherence_says_so_first(lab: Path) -> None:
    run("fit", "hammer.csv", "-o", "full.csv")
    lines = [line for line in (lab / "full.csv").read_text().splitlines() if line[0] != "#"]
    bare = "\n".join(",".join(line.split(",")[:3]) for line in lines)
    (lab / "bare.csv").write_text(bare + "\n")
    text = " ".join(run("fit", "bare.csv", "--mass", "104g", "--seals", "2").split())
    assert "The FRF has neither coherence nor scatter, so every line counts alike" in text
    assert not text.startswith("Use:")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("fit seal.csv --units kraft=N", "'kraft' is no role .* and no column of seal.csv"),
        ("report seal.csv hammer.csv --mass 104g --units kraft=N", "'kraft' is no role"),
        ("fit seal.csv --file-part sheet=Foo", "sheet.Foo: this file has no sheets or groups"),
        ("fit seal.csv --temperature -300degC", "-300 degC, below absolute zero"),
        ("fit seal.csv --temperature 296.15degC", "at, 100 to 550 K"),
        (
            "fit seal.csv --length 100m",
            "the length of the seal is 100 m; expected 100 um to 5 m. Check the unit of length.",
        ),
        (
            "fit seal.csv --height 12m",
            "the height of the seal is 12 m; expected 100 um to 500 mm. Check the unit of height.",
        ),
        ("predict fit.json --mass 104g --seal-mass 5kg", "seals would weigh 5000 g on a mass"),
        ("fit hammer.csv --mass 104g --prior damping=2.85", "in per cent, give 0.0285"),
        ("fit hammer.csv --mass 104g --mass-sd 1kg", "mass_sd = 1 kg of a mass of 0.104 kg"),
        ("verify fit.json", "fit.json is not a project: it is a file; .* --project FOLDER"),
        ("fit hammer.csv --band 900:950Hz", "the FRF has lines from .* to"),
        ("fit seal.csv -o fit.pdf", "a fit is written as .json or .html, not as .pdf"),
        ("report seal.csv -o seal.pdf", "this is written as .html or .htm, not as .pdf"),
        (
            "fit hammer.csv -o frf.pdf",
            "is written as .csv or .uff or .unv or .json or .html, not as .pdf",
        ),
        ("predict fit.json --mass 104g -o frf.uff", "is written as .csv, .json or .html"),
    ],
)
def test_command_answers_a_mistyped_word_with_a_suggestion(
    lab: Path, words: str, message: str
) -> None:
    printed = " ".join(run(*words.split(), code=2).split())
    assert re.search(message, printed), printed
    assert not (lab / "report.html").exists()


def test_units_option_accepts_columns_of_either_file(lab: Path) -> None:
    run("report", "seal.csv", "hammer.csv", "--mass", "104g", "--seals", "2",
        "--no-joint", "--units", "acceleration 1=m/s^2")  # fmt: skip


def test_fit_states_first_that_it_has_fewer_arms_than_requested(lab: Path) -> None:
    assert "not the 9 asked for: the optimum has fewer arms" in run(
        "fit", "seal.csv", "--arms", "9"
    )
    assert "asked for" not in run("fit", "seal.csv", "--arms", "2")


def test_next_command_repeats_the_reading_options(lab: Path) -> None:
    (lab / "odd.csv").write_text(bench(ramp_and_hold(), head="a,b,c"))
    message = ("--column", "time=1,displacement=2,force=3",
            "--units", "time=s,displacement=mm,force=N")  # fmt: skip
    for command in ("inspect", "fit"):
        follow = run(command, "odd.csv", *message).partition("next: ")[2]
        words = shlex.split(follow.partition("#")[0])[1:]
        assert words[:2] == ["fit", "odd.csv"]
        run(*words)
    assert (lab / "fit.json").is_file()


def test_a_simulated_record_is_a_measurement_to_other_commands(lab: Path) -> None:
    run("simulate", "relaxation", "--hold", "3s", "-o", "sim.csv")
    run("simulate", "relaxation", "--hold", "3s", "-o", "sim.csv")
    before = (lab / "sim.csv").read_bytes()
    process = run("predict", "fit.json", "--mass", "104g", "-o", "sim.csv", code=2)
    assert "sim.csv is a simulated record" in process
    assert (lab / "sim.csv").read_bytes() == before
    run("predict", "fit.json", "--mass", "104g", "-o", "sim.csv", "--overwrite")


def test_identify_uses_the_specimen_options(lab: Path) -> None:
    words = ("fit", "hammer.csv", "--mass", "104g", "--seals", "2", "--arms", "1")
    follow = run(*words, "--temperature", "23degC", "--length", "100mm").partition("next: ")[2]
    run(*shlex.split(follow.partition("#")[0])[1:])
    specimen = json.loads((lab / "joint.json").read_text())["specimen"]
    assert (specimen["temperature"], specimen["length"]) == (pytest.approx(296.15), 0.1)
    twice = run(*words, "--temperature", "23degC", "--temperature", "0degC", code=2)
    assert "expected one, that of the seals under the hammer" in " ".join(twice.split())


def test_a_result_without_stdout_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdout", None)
    with pytest.raises(OSError, match="stdout is closed"):
        to_stdout("the result")


def test_fit_request_refuses_a_repeated_single_value():
    """One temperature, one mass; and a file of a kind that keeps the result."""

    def make_request(**message):
        return FitRequest(("a.csv",), {"a.csv": "cld"}, {"specimen": Specimen(), **message})

    assert make_request(temperatures=(280.0,)).specimen.temperature == 280.0
    with pytest.raises(click.UsageError, match="given 2 times; these records have one"):
        _ = make_request(temperatures=(280.0, 290.0)).specimen
    assert make_request(mass=(0.1,)).mass == 0.1
    with pytest.raises(click.UsageError, match=r"given 2 times\. Give it once"):
        _ = make_request(mass=(0.1, 0.2)).mass
    for output, suffix in (("fit.csv", ".csv"), ("-", ".json"), ("fit", ".json"), (None, None)):
        assert (
            make_request(output=output).check_output_suffix(".json", ".csv", result_name="a fit")
            == suffix
        )
    with pytest.raises(
        click.UsageError, match=r"a fit is written as \.json or \.csv or \.html, not as \.txt"
    ):
        make_request(output="fit.txt").check_output_suffix(".json", ".csv", result_name="a fit")
