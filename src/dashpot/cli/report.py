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
    format_grams,
    get_file_kinds,
    print_detected_kinds,
    render_page,
)
from dashpot.cli._command_result import CommandResult, claim_outputs, note_written, write_output
from dashpot.cli._options import MASS, MODEL, RAMP, SPECIMEN_GROUP, format_column_hint
from dashpot.cli._param_types import Folder, Output
from dashpot.reading.columns.file_kinds import get_kind_label
from dashpot.reading.read_options import OF_HAMMER, ReadOptions
from dashpot.registry import KINDS, find_handler, load_object, require_handler
from dashpot.workflow.job import Job

if TYPE_CHECKING:
    from dashpot import Study


_PAGE_GROUP = "Page"
_LOOPS = {"strain-sweep", "cyclic"}
_VIBRATION = set(options.VIBRATION.split())


@dataclass(frozen=True)
class ReportResult(Serialisable):
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

        return [value.fact for value in recommend_solid(self.study, allow_rejected=True).values]


@verb(
    "report",
    """Write one page about a seal: test, model, prediction, hammer, checks.

  dashpot report seal_8mm.csv hammer.csv --mass 114.8g --seals 2 -o report.html
  dashpot report warm.csv cold.csv --temperature 23degC --temperature 0degC
  dashpot report seal_8mm.csv hammer.csv --mass 114.8g --project door-seal""",
    options.file_argument("FILE..."),
    group(
        _PAGE_GROUP,
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
        options.mass_options(purpose=" Inferred if missing."),
        build_options(Job, "band", help="Frequencies to compare, e.g. 5:40Hz."),
        options.relative_motion_option(),
    ),
    mark_advanced(
        group(
            RAMP,
            build_options(Job, "method"),
            options.time_limits_option(),
            options.machine_option(),
            build_options(Job, "filter"),
        )
    ),
    options.hammer_options(),
    options.specimen_options(per_file=True),
    mark_advanced(group(SPECIMEN_GROUP, build_options(Job, "impact_temperature"))),
    options.reading_options(),
    options.result_options(plot=False, has_open_option=False),
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
    from dashpot.text_output.results import render_study  # a page of help does without

    detections = detect_file_kinds(files, options)
    kinds = get_file_kinds(detections, options)
    print_detected_kinds(detections)
    if set(kinds.values()) <= _LOOPS:
        return _write_loop_page(files, kinds[files[0]], output, options)
    tests = tuple(path for path in files if kinds[path] == "relaxation")
    impact_files = tuple(path for path in files if kinds[path] in _VIBRATION)
    _refuse_other_kinds(kinds, tests, impact_files)
    _refuse_unused(hammer=bool(impact_files), mass=choices["mass"] is not None)
    job = Job(
        tests[0],
        other_tests=tests[1:],
        impact=impact_files,
        reading=_simplify_options(options.drop_fields(OF_HAMMER), tests),
        # columns named for the bench file need not exist in the hammer's; units do no harm
        reading_impact=_simplify_options(
            options.select_fields(("units", *OF_HAMMER)), impact_files
        ),
        **choices,
    )
    if not (output or project):
        output = "report.html"
        claim_outputs([output])
    written_files: list[str] = []
    history = None
    if project:
        study, project_path, project_result = require_handler("keep", "project")(
            project, job, page=render_page
        )
        note_written(project_path)
        history = project_result.head
        written_files.append(str(project_path))
    else:
        study = workflow.run(job)
    if output:
        send_progress("drawing the report")
        written_files.append(output)
        write_output(written_files[-1], render_page(study))
    return CommandResult(
        ReportResult(study, written_files[-1], history),
        render_study(study),
        study.verdict_checks,
        verdict=study.verdict,
        next_command=format_command("verify", project, "--expect", history, remark="recomputes it")
        if project
        else _format_next_command(files, job, study),
    )


def _refuse_other_kinds(kinds: dict[str, str], tests: Sequence[str], impact: Sequence[str]) -> None:
    """Refuse files that no page of a seal can show."""
    from dashpot.reading.columns.file_kinds import get_kind_command

    for path, kind in kinds.items():
        if path not in (*tests, *impact):
            advice = (
                f"Type: dashpot fit {path}"
                if kind in KINDS and KINDS[kind].fit
                else f"{get_kind_command(kind)}.".lstrip(".").capitalize()
            )
            raise click.UsageError(
                f"{path} is {get_kind_label(kind)}. "
                "The report is of relaxation tests and a hammer. "
                f"{format_column_hint(tuple(kinds)).strip() or advice}"
            )
    if not tests:
        raise click.UsageError(
            "The report needs a relaxation test, and here is none. For hits or an FRF alone: "
            f"dashpot fit {impact[0]}"
        )


def _refuse_unused(*, hammer: bool, mass: bool) -> None:
    """Raise an error for options of a hammer test or a mass, if there is none.

    Raises
    ------
    click.UsageError
    """
    hammer_flags = {
        option.flag for option in (*options.hammer_options(), *options.relative_motion_option())
    }
    rules = [
        (hammer_flags | {"--no-joint", "--band"}, hammer, "a hammer test", "Add its file"),
        ({"--seal-mass"}, mass, "a mass on the seals", "Give --mass"),
        ({"--compression"}, mass or hammer, "a mass on the seals", "Give --mass"),
    ]
    context = click.get_current_context()
    for param in context.command.params:
        for flags, is_given, subject, remedy in rules:
            if (
                isinstance(param, CommandOption)
                and param.flag in flags
                and not is_given
                and param.get_typed_words(context)
            ):
                raise click.UsageError(
                    f"{param.flag} is for {subject}, and there is none here. {remedy}, or "
                    "leave the option out."
                )


def _simplify_options(read_options: ReadOptions, files: Sequence[str]) -> ReadOptions:
    """Return the file options, without patterns if all files have the same values."""
    distinct_options = {read_options.for_file(path) for path in files}
    return distinct_options.pop() if len(distinct_options) == 1 else read_options


def _write_loop_page(
    files: tuple[str, ...], kind: str, output: str | None, reading: ReadOptions
) -> CommandResult:
    """Write the page of loops or an amplitude sweep."""
    loop_fit = load_object(KINDS[kind].fit)(files, options=reading)
    output = output or "report.html"
    claim_outputs([output])
    write_output(output, render_page(loop_fit))
    return CommandResult.from_result(loop_fit)


_MASS_FLAGS = ("--mass", "--seals", "--seal-mass", "--compression", "--band", "--relative")
"""Options of the mass on the seals, if only the relaxation tests are fitted."""


def _format_next_command(files: Sequence[str], job: Job, study: Study) -> str:
    """Return the command that saves the recommended solid of the report.

    It repeats every option that decided over that solid; empty if no fit gives it.
    """
    remark = "writes the model for export"
    if study.joint is not None and study.mass is not None:
        from dashpot.datamodel.fit import get_fewest_arms_model

        # fewer arms than the relaxation test has are of its own fit alone
        fewer = isinstance(job.arms, int) and job.arms < get_fewest_arms_model(study.joint).arms
        words = options.get_typed_options_for("fit", excluded_flags=("--arms",) if fewer else ())
        if job.mass is None:  # a fit takes no mass that is not known: one that is hardly known
            words += ["--mass", format_grams(study.mass)]
            words += ["--mass-sd", format_grams(0.5 * study.mass)]
        return format_command("fit", *files, *words, "-o", "joint.json", remark=remark)
    if job.impact_temperature is not None:
        return ""
    hammer_flags = [option.flag for option in options.hammer_options()]
    words = options.get_typed_options_for("fit", excluded_flags=(*_MASS_FLAGS, *hammer_flags))
    return format_command(
        "fit", job.relaxation, *job.other_tests, *words, "-o", "fit.json", remark=remark
    )
