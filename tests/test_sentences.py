"""Every sentence of a check and of a verdict is in the words of the field: no code on the page."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
import pytest
from kit import handmade
from kit.kinds import bench, ramp_and_hold
from kit.shell import no_air, ran
from kit.trials import DISTURBANCES, KINDS, LAWS, relaxation_test, trial
from test_checks import STAGES

import dashpot as dp
from dashpot.base import checks
from dashpot.base.checks import MAX_WORDS, Check, Finding, Verdict, criterion, verdict
from dashpot.base.errors import DashpotError
from dashpot.base.number_format import ascii_only, format_typographic
from dashpot.base.plain_text import count_words, sentences
from dashpot.cli import main
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare
from dashpot.simulation.impact import simulate_impact
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import BROAD, BROAD_MASS
from dashpot.text_output.layout import Text, format_for_screen
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.workflow.job import BlockOnSeals
from dashpot.workflow.study import characterise

pytestmark = pytest.mark.once

CODE = re.compile(
    r"_|--|`|\+-|[<>=]=|\b(?:None|nan|inf|True|False)\b|\de[+-]\d|\w{2,}\("
    # an equation has a symbol and blanks about its sign
    r"|(?<!\b[a-zA-Zτ] )(?<!∞ )(?<![₀-₉] )(?<!\(T\) )=|=(?! )"
)
"""What only a program reads."""


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("narrow band=5:50 Hz", False), ("see tests_agree", False), ("widen --band", False),
        ("1.3e+02 times", False), ("0.2 +- 0.1 N", False), ("a delay of nan ms", False),
        ("ask for fit(arms=2)", False), ("τ = 0.5 s and k₁ = 3 N/mm", True),
        ("only its b = k τ is seen", True), ("k∞ = 0.2 N/mm, from −3 to 5 %", True),
        ("the fit of the hold alone (eq. 5)", True),
    ],
)  # fmt: skip
def test_what_counts_as_code(text: str, plain: bool) -> None:
    assert bool(CODE.search(text)) is not plain


def iterate_cases() -> Iterator[Check]:
    """Every registered check that a page can show, passed and failed."""
    for stage, cases in STAGES.items():
        # of a project's files and lines; and what a reader refuses, with the option that answers
        if stage not in {"workflow", "extensions/projects", "reading/readers"}:
            for case in cases:
                yield from (case.judge(x) for x in (case.passes, case.fails) if x is not None)


def iterate_reader_checks() -> Iterator[Check]:
    """The checks that a reader or a project makes."""
    for stage in ("workflow", "extensions/projects", "reading/readers"):
        for case in STAGES[stage]:
            yield from (case.judge(x) for x in (case.passes, case.fails) if x is not None)


def iterate_fit_sentences(test: dp.RelaxationTest) -> Iterator[str]:
    try:
        result = fit(prepare(test))
    except DashpotError:
        return
    yield from (check.message for check in result.checks)
    yield result.verdict.message


def wrong(sentences: Iterator[str]) -> list[str]:
    printed = [format_typographic(sentence) for sentence in sentences]
    assert len(printed) > 10
    return [item for item in printed if CODE.search(item) or "()" in item or "  " in item]


MOST_IN_A_SENTENCE = 25
BANNED = re.compile(
    r"\b(?:tells?|told|telling|informs?|informed|informing|bears? out|borne out|speaks? for|"
    r"weighs? on|nuisances?|doubt(?:ed|s|ful)?|rings?|stands? at exactly|as said above|"
    r"foretold|foretells?|vouch(?:es)?|believed?|worth 1/)\b",
    re.IGNORECASE,
)
"""Words that a stranger must decode, and those of a person for a thing."""
VERBS = frozenset({
    "Accept", "Add", "Allow", "Ask", "Begin", "Calibrate", "Check", "Choose", "Clean", "Clear",
    "Close", "Compare", "Condition", "Correct", "Count", "Cut", "Drive", "Export", "Fit", "Give",
    "Hit", "Hold", "Leave", "Let", "Limit", "Look", "Make", "Measure", "Move", "Name", "Narrow",
    "Press", "Ramp", "Read", "Record", "Reduce", "Repeat", "Restore", "Sample", "Say", "Set",
    "Slow", "Start", "State", "Strike", "Sweep", "Take", "Tare", "Test", "Trigger", "Try",
    "Turn", "Use", "Weigh", "Weight", "Widen", "Write",
})  # fmt: skip
"""How a remedy begins."""


def style(text: str) -> list[str]:
    """What a text has against the rules of plain English."""
    result = [f"banned word {item[0]!r}" for item in BANNED.finditer(text)]
    long = [sentence for sentence in sentences(text) if count_words(sentence) > MOST_IN_A_SENTENCE]
    result += [f"{count_words(item)} words: {item}" for item in long]
    result += ["two semicolons"] if text.count(";") > 1 else []
    result += ["no full stop"] if not text.endswith((".", "?")) else []
    result += ["a sentence in small letters"] if re.match(r"(?!tau\b)[a-z]{2,} ", text) else []
    return [f"{item} | {text}" for item in result]


def test_every_check_is_plain_english_with_a_remedy_that_begins_with_its_verb() -> None:
    faults, checks = [], [*iterate_cases(), *iterate_reader_checks()]
    for check in checks:
        faults += [f"{check.name}: {item}" for item in style(check.message)]
        if check.failed and check.remedy is None:
            faults.append(f"{check.name}: no remedy | {check.message}")
        if check.remedy:
            faults += [f"{check.name}: {item}" for item in style(check.remedy.words)]
            if check.remedy.words.split()[0].rstrip(",") not in VERBS:
                faults.append(f"{check.name}: no verb | {check.remedy.words}")
    assert len(checks) > 300
    assert not faults, "\n".join(faults)


def test_every_check_that_could_lead_a_verdict_says_it_in_35_words_with_a_number() -> None:
    faults = []
    for check in iterate_cases():
        if check.failed and check.grade != "note":
            line = str(verdict([check, replace(check, name="another")]))
            if count_words(line) > MAX_WORDS or not re.search(r"\d", line):
                faults.append(f"{check.name}: {count_words(line)} words: {line}")
    assert not faults, "\n".join(faults)


def options() -> Iterator[tuple[str, str]]:
    """Every option of the command line with its help, by command and name."""
    context = click.Context(main)
    for name in main.list_commands(context):
        command = main.get_command(context, name)
        assert command is not None
        for parameter in command.params:
            if isinstance(parameter, click.Option) and parameter.help:
                yield f"{name} {parameter.opts[0]}", parameter.help


#: its help is the list of what it takes
LISTS = {"export --to"}


def test_help_of_every_option_is_a_short_phrase() -> None:
    item = dict(options())
    assert len(item) > 150
    assert {name for name, message in item.items() if len(message) > 60} <= LISTS
    assert not [name for name, message in item.items() if message.startswith(("Of ", "At which"))]
    assert not [f"{name}: {message}" for name, message in item.items() if BANNED.search(message)]


STANDARD = (
    ("virtual rig", "simulation", ()),
    ("fitted too", "nuisance parameters", ()),
    ("joint solid", "joint model", ()),
    ("take away", "export", ()),
    ("bound over unresolved arms", "bounds over all spectra", ()),
    ("worst-case bounds", "bounds over all spectra", ()),
    ("worst first", "findings by severity", ()),
    ("order by order", "stabilisation chart", ()),
    ("frequency stays", "stable in frequency", ()),
    ("chemical time", "chemical relaxation time", ()),
    ("tests nothing", "no test", ()),
    (
        "slammed",
        "dropped",
        (
            "extensions/projects/document_versions.py",
            "reading/columns/file_kinds.py",
            "extensions/materials/table_rules.py",
            "extensions/materials/drop/prediction.py",
        ),
    ),
    (
        "slams?(?= )|(?<= )slams?",
        "impact, or drop test",
        (
            "extensions/materials/drop/examples.py",
            "extensions/materials/table_rules.py",
            "reading/columns/kind_detection.py",
        ),
    ),
    (
        "pieces?",
        "specimen",
        (
            "extensions/projects/document_versions.py",
            "extensions/materials/csr/datamodel.py",
            "extensions/materials/csr/examples.py",
            "extensions/materials/csr/read.py",
        ),
    ),
    ("(?:a|the|one|its|no|without) memory", "relaxation", ()),
    ("memories", "relaxations", ()),
    ("law of aging", "aging law", ()),
    ("several levels", "several amplitudes", ()),
    ("fitted solid", "fitted model", ()),
    ("mass of the block", "test mass", ()),
)
"""A word of our own, the standard term for it, and the files that may show the word."""


def texts() -> Iterator[tuple[str, str]]:
    """Every string of the sources that may be shown, by file: no docstring, no comment."""
    parent = Path(dp.__file__).parent
    for path in sorted(parent.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        message = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
        for quantity in ast.walk(tree):
            if (
                isinstance(quantity, ast.Constant)
                and isinstance(quantity.value, str)
                and id(quantity) not in message
            ):
                yield path.relative_to(parent).as_posix(), quantity.value
    for path in sorted([*parent.rglob("*.html"), *parent.rglob("*.js")]):
        yield path.relative_to(parent).as_posix(), path.read_text(encoding="utf-8")


def test_a_text_says_the_standard_term() -> None:
    any_word = re.compile("|".join(rf"\b(?:{word})\b" for word, *_ in STANDARD), re.IGNORECASE)
    result = [
        f"{file}: say {term!r}, not {word!r}"
        for file, text in texts()
        if any_word.search(text)
        for word, term, allowed in STANDARD
        if file not in allowed and re.search(rf"\b(?:{word})\b", text, re.IGNORECASE)
    ]
    assert not result, "\n".join(result)


LEVELS = (
    "shaker_20mN.csv shaker_500mN.csv --amplitude 0.02N --amplitude 0.5N --mass 114.8g --seals 2"
)
DECK = "export --to abaqus --unit-system mm-t-s --temperature 23degC --length 50mm"
EXAMPLES = (
    "fit seal_8mm.csv", "fit short_hold.csv", "fit hammer.csv", "fit sweep.csv", "fit curve.csv",
    "fit depth_4mm.csv depth_6mm.csv depth_8mm.csv --elastic by-depth",
    "fit at_23degC.csv at_10degC.csv at_0degC.csv",
    "fit seal_8mm.csv hammer.csv --mass 114.8g --seals 2 -o joint.json",
    "fit seal_8mm.csv hammer.csv --mass 90g --seals 2", "fit hammer.csv --mass 114.8g --seals 2",
    "fit cld_1.csv cld_2.csv cld_3.csv --length 100mm --compression 6mm", "fit cld_1.csv",
    "fit cld_slow.csv cld_fast.csv", "fit loops.csv", "fit shaker_20mN.csv",
    f"fit {LEVELS} -o level.json",
    "fit shaker_20mN.csv shaker_500mN.csv --mass 104g --mass 114.8g",
    "fit hit.csv --mass 5g --radius 5mm --drop-height 51mm",
    "fit rod.csv --shape disc:20mm,20mm --density 1000 --mass 31.4g",
    "fit ovens.csv --machine oven=1K -o csr.json", "predict csr.json --temperature 70degC",
    "predict csr.json --temperature 20degC --end 10000h",
    "fit tension.csv biaxial.csv --test uniaxial --test biaxial -o law.json",
    "fit seal_8mm.csv -o fit.json", "predict fit.json --mass 114.8g --seals 2",
    "predict joint.json --mass 114.8g --seals 2", "compare fit.json hammer.csv --mass 114.8g",
    "compare joint.json hammer.csv --mass 114.8g --seals 2", "predict door.toml",
    "compare shaker_20mN.csv shaker_500mN.csv",
    "plan --frequency 12.71Hz --ramp 1s --hold 40s",
    "report seal_8mm.csv hammer.csv --mass 114.8g --seals 2 --project kept", "verify kept",
    "report loops.csv -o report.html", "report seal_8mm.csv -o report.html --overwrite",
    "fit sweeps.csv --reference 25degC -o master.json", "fit seal_8mm.csv --model fractional",
    "fit shaker_20mN.csv --mass 114.8g --seals 2",
    "fit cld_1.csv --compression 6mm --relaxation fit.json",
    "predict fit.json --mass 114.8g --seals 2 --base-psd 0.01g^2/Hz",
    "predict joint.json --mass 114.8g --seals 2 --amplitude 1N --sweep loops.csv",
    "predict master.json --shape disc:20mm,20mm --mass 400g --seals 2 --base",
    "predict door.toml --close 1.2m/s",
    "export joint.json --to csv --unit-system SI --temperature 23degC --length 50mm -o deck.csv",
    f"{DECK} joint.json -o deck.inp", f"{DECK} law.json --bulk-modulus 2GPa -o law.inp",
    f"{DECK} level.json -o level.inp",
    "compare fit.json hammer.csv", "batch may -o may/lot", "batch june -o june/lot",
    "compare may/lot june/lot",
)  # fmt: skip
"""The example files as the how-to pages take them: every verb that has a verdict, on every kind."""


@pytest.mark.slow
def test_verdict_on_every_example_is_a_line_with_a_number(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert ran("demo", "--files", "--all", "-o", ".").exit_code == 0
    no_air(tmp_path / "door.toml")
    for month, seed in (("may", 1), ("may", 2), ("june", 3), ("june", 4)):
        (tmp_path / month).mkdir(exist_ok=True)
        test = bench((1 + 0.02 * seed) * ramp_and_hold(), seed=seed)
        (tmp_path / month / f"{seed}.csv").write_text(test)
    verdicts: list[Verdict | None] = []

    def note_text(text: Text, result: Verdict | None, *rest: Any, **how: Any) -> list[str]:
        verdicts.append(result)
        return format_for_screen(text, result, *rest, **how)

    monkeypatch.setattr("dashpot.text_output.layout.format_for_screen", note_text)
    faults = []
    for command in EXAMPLES:
        verdicts.clear()
        done = ran(*command.split())
        if not verdicts or verdicts[0] is None:
            faults.append(f"{command}: no verdict: {done.output[:200]}")
            continue
        line = str(verdicts[0])
        if not " ".join(done.stdout.split()).startswith(ascii_only(line)):
            faults.append(f"{command}: not what is printed: {line}")
        faults += [f"{command}: {item}" for item in style(line)]
        if count_words(line) > MAX_WORDS:
            faults.append(f"{command}: {count_words(line)} words: {line}")
        if not re.search(r"\d", line):
            faults.append(f"{command}: no number: {line}")
    assert not faults, "\n".join(faults)


def test_every_check_speaks_in_words_passed_or_failed() -> None:
    assert not wrong(check.message for check in iterate_cases())


@pytest.mark.parametrize("solid", sorted({kind.solid for kind in KINDS}))
def test_every_simulated_kind_is_answered_in_words(solid: str) -> None:
    tests = [trial(kind, seed=2) for kind in KINDS if kind.solid == solid]
    assert not wrong(
        message for test in tests for message in iterate_fit_sentences(relaxation_test(test))
    )


def test_a_disturbed_record_is_answered_in_words() -> None:
    tests = [trial(KINDS[1], seed=3, bench=bench) for bench in DISTURBANCES.values()]
    tests += [trial(KINDS[1], seed=3, law=law) for law in LAWS]
    assert not wrong(
        message for test in tests for message in iterate_fit_sentences(relaxation_test(test))
    )


@pytest.mark.parametrize(("stiffer", "mass"), [(1.15, BROAD_MASS), (1.0, 1.1 * BROAD_MASS)])
def test_two_tests_that_disagree_are_answered_in_words(stiffer: float, mass: float) -> None:
    bench = simulate_relaxation(BROAD, seed=3).test
    hammer = simulate_impact(stiffer * BROAD, mass=BROAD_MASS, hits=3, seed=3).test
    study = characterise(bench, estimate_frf(hammer, mass=mass), block=BlockOnSeals(mass, 2))
    assert study.verdict.use == "do not use"
    # what the page shows of both tests is of the one cause that explains them
    assert study.joint.evidence.explanations[0].is_sufficient
    assert abs(study.joint_comparison.frequency_error) < 2e-3
    assert not wrong(check.message for check in (*study.verdict_checks, *study.every_check))
    message = [study.verdict.message, study.comparison.message]
    message += [explanation.message for explanation in study.joint.evidence.explanations]
    assert study.joint.evidence.explanations
    assert not [item for item in map(format_typographic, message) if CODE.search(item)]


def test_the_cause_of_a_disagreement_leads_the_verdict() -> None:
    check = Check("tests_agree", False, "the seals are 15 % stiffer", grade="stop")
    follows = Check("mass_plausible", False, "the mass is off", grade="stop")
    study = handmade.study()
    joint = replace(study.joint, evidence=replace(study.joint.evidence, checks=(check, follows)))
    assert replace(study, joint=joint).verdict.message.startswith("The seals are 15 % stiffer")


def test_a_sentence_spells_powers_of_ten_that_people_write_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(checks, "REGISTER", dict(checks.REGISTER))

    def spelt() -> Finding:
        """Whatever."""
        return Finding(f"{130.0:.2g} times, {2e-9:.2g} m")

    spelt.__module__ = "dashpot.nowhere.checks"
    assert criterion(source="nowhere")(spelt)().message == "130 times, 2e-09 m."
