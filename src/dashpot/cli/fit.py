"""dashpot fit: the model that suits the records."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import chain
from typing import Any

import click

from dashpot.base.errors import DashpotError, ReadError
from dashpot.base.option_fields import Method, RampLawOption, get_choice_values
from dashpot.cli import _options as options
from dashpot.cli._command import (
    CommandOption,
    build_options,
    group,
    mark_advanced,
    opt,
    refuse_options,
    verb,
)
from dashpot.cli._command_files import detect_file_kinds, get_file_kinds, print_detected_kinds
from dashpot.cli._command_result import CommandResult
from dashpot.cli._options import MASS, MODEL, RAMP, SOLIDS, TEMPERATURE_GROUP, VIBRATION
from dashpot.cli._param_types import ChoiceWithSuggestion, Output, WithUnit
from dashpot.fitting.identification.prior_knowledge import HammerRig, SolidPrior
from dashpot.reading.read_options import ReadOptions
from dashpot.registry import (
    FITS,
    KINDS,
    find_handler,
    find_kinds_by_option,
    list_names,
    load_object,
    require_handler,
)
from dashpot.workflow.job import Job, LevelJob, ShiftChoices

_BENCH = SOLIDS
_ELASTIC_LAWS = (*get_choice_values(RampLawOption), "by-depth")


def _detect_kinds(files: Sequence[str]) -> Mapping[str, str]:
    """Return the kinds of files, for the help of each; empty if one is not recognised."""
    with suppress(DashpotError, click.ClickException):
        return get_file_kinds(detect_file_kinds(files, ReadOptions()), ReadOptions())
    return {}


def _make_choice_option(flag: str, choice: Sequence[str], **click_options: Any) -> CommandOption:
    return opt(
        flag, **{"type": ChoiceWithSuggestion(choice), "metavar": "|".join(choice), **click_options}
    )


def _make_mass_options() -> list[CommandOption]:
    mass = opt(
        "--mass", type=WithUnit("mass"), multiple=True, metavar="MASS",
        kinds=f"{VIBRATION} {find_kinds_by_option('mass')}",
        help="Test mass, e.g. 104g. Without it: modes.",
    )  # fmt: skip
    return [
        mass,
        *build_options(Job, "seals", kinds=VIBRATION, metavar="N"),
        *build_options(Job, "band", kinds=VIBRATION),
        *build_options(LevelJob, "levels", kinds=VIBRATION),
        *mark_advanced(
            build_options(Job, "seal_mass", kinds=VIBRATION),
            build_options(
                Job,
                "compression",
                kinds=f"{VIBRATION} {find_kinds_by_option('compression')}",
                help="Compression where the result is wanted.",
            ),
            build_options(LevelJob, "at", kinds=VIBRATION),
            build_options(HammerRig, "mass_sd", argument="rig", kinds=VIBRATION),
            options.relative_motion_option(VIBRATION),
            build_options(
                SolidPrior,
                "static_stiffness",
                "natural_frequency",
                "damping_ratio",
                argument="solid_prior",
                kinds=VIBRATION,
            ),
            build_options(SolidPrior, "parallel_dashpot", argument="solid_prior", kinds=VIBRATION),
            opt(
                "--stiffness-table",
                type=Output([".csv"]),
                metavar="FILE",
                kinds=VIBRATION,
                help="Write k(f), c(f) and loss factor as CSV.",
            ),
        ),
    ]


_OPTIONS = (
    group(
        MODEL,
        opt("--model", metavar="NAME", help="maxwell, fractional, or a law by name (auto)."),
        build_options(Job, "arms", kinds=f"{_BENCH} {VIBRATION}"),
        _make_choice_option(
            "--elastic", _ELASTIC_LAWS, default="auto", kinds="relaxation", metavar="LAW",
            help="Elastic law: linear, nonlinear, by-depth (auto).",
        ),
    ),
    group(MASS, _make_mass_options()),
    mark_advanced(
        group(
            RAMP,
            _make_choice_option(
                "--method", get_choice_values(Method), default="full", kinds="relaxation",
                help="Whole record (full), or equation (5) of the paper.",
            ),
            options.time_limits_option("relaxation"),
            options.machine_option(f"relaxation creep cyclic {VIBRATION} "
                            f"{find_kinds_by_option('machine')}"),
            build_options(Job, "filter", kinds="relaxation"),
            opt("--thorough", kinds=_BENCH, help="Try more starting points."),
        ),
        group(
            TEMPERATURE_GROUP,
            build_options(ShiftChoices, argument="shifting", kinds=_BENCH),
            opt("--save-shifts", type=Output([".csv"]), metavar="FILE", kinds=_BENCH,
                help="Write the shift factors as CSV."),
            build_options(Job, "impact_temperature", kinds=VIBRATION),
        ),
        options.hammer_options(kinds="impact transmissibility"),
        *chain.from_iterable(
            require_handler("option groups", name)()
            for name in list_names("option groups")
            if name.startswith("fit")
        ),
        options.specimen_options(per_file=True),
    ),
    options.reading_options(),
    options.result_options("Keep it as .json, .html; of hits .csv or .uff."),
    find_handler("options", "limits") or (),
)  # fmt: skip
for _option in chain.from_iterable(_OPTIONS):
    if _option.group not in {options.READING, options.RESULT}:
        _option.excluded_kinds = frozenset(
            kind.name
            for kind in KINDS.values()
            if kind.fits and not _option.names & set(kind.fit_options)
        )


@verb(
    "fit",
    """Fit the model that suits the records. The kind of each FILE is recognised.

  relaxation, creep, DMA sweep, modulus   -> the viscoelastic model
  hammer hits or FRFs                     -> modes; with --mass the model
  a relaxation test and a hammer, --mass  -> the joint model
  CLD, stress-strain, indenter, rod, loops, FRFs at amplitudes -> their law

  dashpot fit seal_8mm.csv -o fit.json
  dashpot fit seal_8mm.csv hammer.csv --mass 114.8g --seals 2 -o joint.json
  dashpot fit hit.csv --mass 5g --radius 5mm""",
    options.file_argument("FILE..."),
    *_OPTIONS,
    detect_kinds=_detect_kinds,
)
def command(*, files: tuple[str, ...], **arguments: Any) -> CommandResult:
    """Return the result of the fit that suits the kinds of the files."""
    from dashpot.cli.fit_handlers import FitRequest
    from dashpot.workflow.fit_routing import find_selected_fit, route

    kinds_by_option = (
        kind.name
        for kind in KINDS.values()
        if kind.kind_option and arguments[kind.kind_option] not in (None, (), "")
    )
    if arguments["options"].kind is None and (name := next(kinds_by_option, None)):
        arguments["options"] = replace(arguments["options"], kind=name)
    detections = detect_file_kinds(files, arguments["options"])
    kinds = get_file_kinds(detections, arguments["options"])
    context = click.get_current_context()
    refuse_options(command, context, kinds)
    typed_names = {
        name
        for option in command.options
        if option.get_typed_words(context)
        for name in option.names
    }
    try:
        fit_name = route(
            kinds, masses=len(arguments["mass"]), selected=find_selected_fit(typed_names),
        )  # fmt: skip
    except ReadError as error:
        raise ReadError(f"{error}{options.format_column_hint(files)}") from None
    if fit_name in {"hits", "modes"}:
        _refuse_model_options(context)
    _refuse_unused(context, fit_name)
    run: Callable[[FitRequest], CommandResult] = load_object(
        FITS[fit_name].files if fit_name in FITS else GENERIC
    )
    print_detected_kinds(detections)
    return run(FitRequest(files, kinds, arguments))


GENERIC = "dashpot.cli.fit_handlers:run_generic_kind"
"""Handler of a kind whose registry row states its options."""

_MODEL_OPTIONS = (
    "--model", "--arms", "--seals", "--seal-mass", "--compression", "--mass-sd", "--prior",
    "--dashpot", "--stiffness-table", "--hammer-temperature",
)  # fmt: skip
"""Options of the model under a mass that do not apply to modes."""


def _refuse_model_options(context: click.Context) -> None:
    """Raise UsageError for options that hits and FRFs without a mass do not use."""
    for option in command.options:
        if option.flag in _MODEL_OPTIONS and option.get_typed_words(context):
            raise click.UsageError(
                f"{option.flag} is for the model under a mass. Give the test mass, such as "
                "--mass 104g, or leave it out: then modes are found."
            )


def _refuse_unused(context: click.Context, fit_name: str) -> None:
    """Raise UsageError for an option that the fit of these records does not use.

    Raises
    ------
    click.UsageError
    """
    if fit_name not in FITS:  # a kind of the registry alone, which says what it takes
        return
    used_names = set(FITS[fit_name].options)
    for option in command.options:
        is_shared = option.group in {options.READING, options.RESULT}
        if is_shared or option.names & used_names or not option.get_typed_words(context):
            continue
        *other_titles, last_title = [
            fit.command_title for fit in FITS.values() if option.names & set(fit.options)
        ]
        fits = f"{', '.join(other_titles)} or {last_title}" if other_titles else last_title
        raise click.UsageError(
            f"{option.flag} is for {fits}. Here it would change nothing, as these files are fitted "
            f"as {FITS[fit_name].command_title}: leave it out."
        )
