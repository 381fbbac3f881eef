"""dashpot report: the main job."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from dashpot import workflow
from dashpot.base import dataclass
from dashpot.base.progress import send_progress
from dashpot.base.serialisation import Key, Serialisable
from dashpot.cli import _options as options
from dashpot.cli._command import CommandOption, build_options, group, mark_advanced, opt, verb
from dashpot.cli._command_files import (
    detect_file_kinds,
    format_command,
    grams,
    kinds_of,
    print_detected_kinds,
    render_page,
)
from dashpot.cli._command_result import CommandResult, claim_outputs, note_written, write_output
from dashpot.cli._options import MASS, MODEL, PIECE, RAMP, format_column_hint
from dashpot.cli._param_types import Folder, Output
from dashpot.reading.columns.file_kinds import get_kind_label
from dashpot.reading.read_options import OF_HAMMER, ReadOptions
from dashpot.registry import KINDS, find_handler, load_object, require_handler
from dashpot.workflow.job import Job

if TYPE_CHECKING:
    from dashpot import Study


_PAGE = "Page"
_LOOPS = {"strain-sweep", "cyclic"}
_VIBRATION = set(options.VIBRATION.split())


@dataclass(frozen=True)
class Reported(Serialisable):
    """Study, with the file of its report and the hash of its project's history."""

    _keys = (Key("study", flatten=True), "numbers", "report", Key("history", optional=True))

    study: Study
    report: str
    history: str | None

    @property
    def numbers(self) -> list[Any]:
        """Numbers that page and app show."""
        # a page of help does without
        from dashpot.workflow.recommended_solid import recommend_solid

        return [value.fact for value in recommend_solid(self.study, requested=True).values]


@verb(
    "report",
    """Write one page about a seal: test, model, prediction, hammer, checks.

  dashpot report seal_8mm.csv hammer.csv --mass 114.8g --seals 2 -o report.html
  dashpot report warm.csv cold.csv --temperature 23degC --temperature 0degC
  dashpot report seal_8mm.csv hammer.csv --mass 114.8g --project door-seal""",
    options.files("FILE..."),
    group(
        _PAGE,
        opt(
            "-o",
            "--output",
            type=Output([".html", ".htm"]),
            metavar="FILE",
            help="The page (report.html).",
        ),
        build_options(Job, "title"),
        opt("--project", type=Folder(), metavar="DIR", help="Keep files, results and history."),
        opt("--open", "opens", help="Open the page."),
        mark_advanced(build_options(Job, "logo")),
    ),
    group(
        MODEL,
        build_options(Job, "family", metavar="NAME"),
        build_options(Job, "arms"),
        mark_advanced(
            build_options(
                Job, "law", metavar="LAW", help="Elastic law: linear or nonlinear (auto)."
            ),
            build_options(Job, "joint"),
        ),
    ),
    group(
        MASS,
        options.under_mass(name=" Inferred if missing."),
        build_options(Job, "band", help="Frequencies to compare, e.g. 5:40Hz."),
        options.relative(),
    ),
    mark_advanced(
        group(
            RAMP,
            build_options(Job, "method"),
            options.time_limits(),
            options.machine(),
            build_options(Job, "filter"),
        )
    ),
    options.hammer(),
    options.piece(flag=True),
    mark_advanced(group(PIECE, build_options(Job, "impact_temperature"))),
    options.reading(),
    options.result(plot=False, opens=False),
    find_handler("options", "limits") or (),
)
def command(
    *,
    files: tuple[str, ...],
    project: str | None,
    output: str | None,
    options: ReadOptions,
    **choices: Any,
) -> CommandResult:
    """Characterise a seal, check it against the hammer, and write one HTML file."""
    from dashpot.text_output.results import study as format_study  # a page of help does without

    detections = detect_file_kinds(files, options)
    kinds = kinds_of(detections, options)
    print_detected_kinds(detections)
    if set(kinds.values()) <= _LOOPS:
        return _amplitude(files, kinds[files[0]], output, options)
    tests = tuple(path for path in files if kinds[path] == "relaxation")
    impact = tuple(path for path in files if kinds[path] in _VIBRATION)
    _refuse_others(kinds, tests, impact)
    _refuse_unused(hammer=bool(impact), mass=choices["mass"] is not None)
    job = Job(
        tests[0],
        other_tests=tests[1:],
        impact=impact,
        reading=_simplify_options(options.drop_fields(OF_HAMMER), tests),
        # columns named for the bench file need not exist in the hammer's; units do no harm
        reading_impact=_simplify_options(options.select_fields(("units", *OF_HAMMER)), impact),
        **choices,
    )
    if not (output or project):
        output = "report.html"
        claim_outputs([output])
    written: list[str] = []
    history = None
    if project:
        study, place, home = require_handler("keep", "project")(project, job, page=render_page)
        note_written(place)
        history = home.head
        written.append(str(place))
    else:
        study = workflow.run(job)
    if output:
        send_progress("drawing the report")
        written.append(output)
        write_output(written[-1], render_page(study))
    return CommandResult(
        Reported(study, written[-1], history),
        format_study(study),
        study.verdict_checks,
        verdict=study.verdict,
        follow=format_command("verify", project, "--expect", history, why="recomputes it")
        if project
        else _follow(files, job, study),
    )


def _refuse_others(kinds: dict[str, str], tests: Sequence[str], impact: Sequence[str]) -> None:
    """Refuse what no page of a seal is about."""
    from dashpot.reading.columns.file_kinds import get_kind_command

    for path, kind in kinds.items():
        if path not in (*tests, *impact):
            line = (
                f"Type: dashpot fit {path}"
                if kind in KINDS and KINDS[kind].fit
                else f"{get_kind_command(kind)}.".lstrip(".").capitalize()
            )
            raise click.UsageError(
                f"{path} is {get_kind_label(kind)}. "
                "The report is of relaxation tests and a hammer. "
                f"{format_column_hint(tuple(kinds)).strip() or line}"
            )
    if not tests:
        raise click.UsageError(
            "The report needs a relaxation test, and here is none. For hits or an FRF alone: "
            f"dashpot fit {impact[0]}"
        )


def _refuse_unused(*, hammer: bool, mass: bool) -> None:
    """Refuse what is said of a hammer test or of a mass on the seals, where there is none.

    Raises
    ------
    click.UsageError
    """
    hits = {option.flag for option in (*options.hammer(), *options.relative())}
    requested = [
        (hits | {"--no-joint", "--band"}, hammer, "a hammer test", "Add its file"),
        ({"--seal-mass"}, mass, "a mass on the seals", "Give --mass"),
        ({"--compression"}, mass or hammer, "a mass on the seals", "Give --mass"),
    ]
    context = click.get_current_context()
    for param in context.command.params:
        for flags, there, what, remedy in requested:
            if (
                isinstance(param, CommandOption)
                and param.flag in flags
                and not there
                and param.get_typed_words(context)
            ):
                raise click.UsageError(
                    f"{param.flag} is for {what}, and there is none here. {remedy}, or leave the "
                    "option out."
                )


def _simplify_options(read_options: ReadOptions, files: Sequence[str]) -> ReadOptions:
    """What is said of files, without patterns where it comes to the same for all of them."""
    options = {read_options.for_file(path) for path in files}
    return options.pop() if len(options) == 1 else read_options


def _amplitude(
    files: tuple[str, ...], kind: str, output: str | None, reading: ReadOptions
) -> CommandResult:
    """Write the page of loops or an amplitude sweep."""
    levels = load_object(KINDS[kind].fit)(files, options=reading)
    output = output or "report.html"
    claim_outputs([output])
    write_output(output, render_page(levels))
    return CommandResult.from_result(levels)


_UNDER_MASS = ("--mass", "--seals", "--seal-mass", "--compression", "--band", "--relative")
"""What is said of the mass on the seals, where the relaxation tests alone are fitted."""


def _follow(files: Sequence[str], job: Job, study: Study) -> str:
    """Return the command that keeps the solid which the report ends with.

    It repeats every option that decided over that solid; nothing is returned where no fit does.
    """
    why = "keeps the model for export"
    if study.joint is not None and study.mass is not None:
        from dashpot.datamodel.fit import get_fewest_arms_model

        # fewer arms than the relaxation test has are of its own fit alone
        few = isinstance(job.arms, int) and job.arms < get_fewest_arms_model(study.joint).arms
        again = options.get_typed_options_for("fit", but=("--arms",) if few else ())
        if job.mass is None:  # a fit takes no mass that is not known: one that is hardly known
            names = ("--mass", grams(study.mass), "--mass-sd", grams(0.5 * study.mass))
            again += names
        return format_command("fit", *files, *again, "-o", "joint.json", why=why)
    if job.impact_temperature is not None:
        return ""
    hits = [option.flag for option in options.hammer()]
    again = options.get_typed_options_for("fit", but=(*_UNDER_MASS, *hits))
    return format_command(
        "fit", job.relaxation, *job.other_tests, *again, "-o", "fit.json", why=why
    )
