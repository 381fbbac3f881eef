"""Handlers of ``dashpot fit`` for each kind of record."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from math import ceil, floor
from pathlib import Path
from typing import Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base import dataclass
from dashpot.base.errors import FitError
from dashpot.base.option_fields import FamilyOption, Method, get_choice_values
from dashpot.cli._command_files import (
    PAGE_SUFFIXES,
    format_command,
    format_grams,
    is_json,
    render_page,
)
from dashpot.cli._command_result import CommandResult, format_json, write_figure, write_output
from dashpot.cli._options import get_typed_options
from dashpot.cli._param_types import format_suggestion
from dashpot.cli._terminal import to_stderr
from dashpot.datamodel.specimen import Specimen
from dashpot.reading.read_options import ReadOptions
from dashpot.registry import KINDS, find_handler, load_object, require_handler
from dashpot.text_output import results
from dashpot.workflow.bench_tests import BenchFitOptions
from dashpot.workflow.job import BlockOnSeals, HammerChoices

# Input of ``dashpot fit``: the records, their kinds, and the options.


@dataclass(frozen=True)
class FitRequest:
    """The records of a fit and its options.

    Attributes
    ----------
    files : tuple of str
    kinds : mapping of str to str
        Detected kind of each file.
    stated_options : mapping
        The options by name, in SI.
    """

    files: tuple[str, ...]
    kinds: Mapping[str, str]
    stated_options: Mapping[str, Any]

    def __getitem__(self, name: str) -> Any:
        return self.stated_options[name]

    def select_options(self, *names: str) -> dict[str, Any]:
        """Return these options by name."""
        return {name: self.stated_options[name] for name in names}

    def select_files(self, *kinds: str) -> tuple[str, ...]:
        """Return the files of these kinds, in their order."""
        return tuple(path for path in self.files if self.kinds[path] in kinds)

    def model(self, choice_type: Any, default: str = "auto") -> Any:
        """Return the word of ``--model``, one of a choice.

        Raises
        ------
        click.UsageError
            If it is another.
        """
        model_name = self.stated_options["model"] or default
        model_names = get_choice_values(choice_type)
        if model_name not in model_names:
            raise click.UsageError(
                f"--model: '{model_name}' is unknown. {format_suggestion(model_name, model_names)}"
            )
        return model_name

    @property
    def mass(self) -> float | None:
        """The one given mass, kg."""
        masses = self.stated_options["mass"]
        if len(masses) > 1:
            raise click.UsageError(
                f"--mass was given {len(masses)} times. Give it once, for these files together."
            )
        return masses[0] if masses else None

    @property
    def reading(self) -> ReadOptions:
        """Reading options of the files."""
        options: ReadOptions = self.stated_options["options"]
        return options

    @property
    def hammer(self) -> HammerChoices:
        """Options of the averaging of hits."""
        choices: HammerChoices = self.stated_options["hammer"]
        return choices

    @property
    def output(self) -> str | None:
        """Path of the result."""
        path: str | None = self.stated_options["output"]
        return path

    @property
    def specimen(self) -> Specimen:
        """The specimen, with the one temperature of all files."""
        temperatures = self.stated_options["temperatures"]
        if len(temperatures) > 1:
            raise click.UsageError(
                f"--temperature was given {len(temperatures)} times; these records have one."
            )
        from dataclasses import replace

        specimen: Specimen = self.stated_options["specimen"]
        return replace(specimen, temperature=temperatures[0]) if temperatures else specimen

    def refuse_polarity(self) -> None:
        """Refuse a sign of FRFs where none is heeded: a mass or a level does not depend on it.

        Raises
        ------
        click.UsageError
        """
        if self.hammer.polarity is not None:
            raise click.UsageError(
                "--polarity is for hits, or for FRFs whose modes or model are sought. Leave it out."
            )

    def check_output_suffix(self, *suffixes: str, result_name: str) -> str | None:
        """Return the suffix of the output file; None if there is no output file.

        Raises
        ------
        click.UsageError
            If such a result is not written so.
        """
        if self.output is None:
            return None
        suffix = Path(self.output).suffix.lower()
        if suffix in (*suffixes, *PAGE_SUFFIXES) or not suffix:
            return suffix or suffixes[0]
        text = " or ".join((*suffixes, PAGE_SUFFIXES[0]))
        raise click.UsageError(
            f"-o {self.output}: {result_name} is written as {text}, not as {suffix}."
        )

    def draw(self, figure: Any) -> None:
        """Draw the figure that a function makes, if requested."""
        if self.stated_options["picture"]:
            write_figure(self.stated_options["picture"], figure())

    @property
    def page(self) -> bool:
        """Whether the result is written to a page."""
        return bool(self.output) and str(self.output).lower().endswith(PAGE_SUFFIXES)

    def save(self, result: Any, **figures: Any) -> None:
        """Write the result as JSON, or as a page, if requested.

        `figures` are what the page may show beside the result's own, each made when it is needed.
        """
        if not self.output:
            return
        if not self.page:
            write_output(self.output, format_json(result._saved_result) + "\n")
            return
        extra_figures = {name: make() for name, make in figures.items()}
        write_output(self.output, render_page(result, **extra_figures))

    def write_output(
        self, result: Any, *, figure: Callable[[], Any] | None = None, next_command: str = ""
    ) -> CommandResult:
        """Draw and save a result as requested, and return its output."""
        self.draw(figure or result.plot)
        self.save(result)
        return CommandResult.from_result(result, next_command=next_command)

    @property
    def result_path(self) -> str:
        """The file that the result can be read back from; empty if there is none."""
        return "" if self.output in {None, "-"} or self.page else str(self.output)

    def get_option_words(self, *excluded: str) -> list[str]:
        """Return the options as they were typed."""
        return get_typed_options(excluded=("picture", "output", *excluded))


# Bench tests of one part.


def run_bench_tests(request: FitRequest) -> CommandResult:
    """Fit a solid to relaxation tests, creep, sweeps or a modulus."""
    request.check_output_suffix(".json", result_name="a fit")
    elastic = request["elastic"]
    fit, records = workflow.fit_files(
        request.files,
        depth_law=elastic == "by-depth",
        law="auto" if elastic == "by-depth" else elastic,
        family=request.model(FamilyOption, "maxwell"),
        options=request.reading,
        **request.select_options("arms", "method", "thorough", "filter", "time_limits", "machine",
                     "specimen", "temperatures", "shifting"),
    )  # fmt: skip
    request.draw(lambda: _draw_bench_tests(fit, records))
    if request["save_shifts"]:
        write_output(request["save_shifts"], format_shift_table(fit))
    request.save(fit, **_make_bench_figures(fit, records))
    return CommandResult(
        fit,
        results.render_fit(fit, requested_arms=request["arms"]),
        fit.checks,
        verdict=fit.verdict,
        next_command=_format_bench_next_steps(request, fit),
    )


def format_shift_table(fit: dp.Fit) -> str:
    """Return the shift factors of a fit of several temperatures as CSV."""
    if fit.temperatures is None:
        raise FitError("one temperature has no shift factors; leave out --save-shifts")
    return str(require_handler("shift table", fit.temperatures)(fit))


def _format_bench_next_steps(request: FitRequest, fit: dp.Fit) -> str:
    if any(check.name == "same_specimen" and check.failed for check in fit.checks):
        return format_command("batch", *request.files, "-o", "lot", remark="fits each specimen")
    if not request.output or request.page:
        return format_command(
            "fit",
            *request.files,
            *request.get_option_words(),
            "-o",
            "fit.json",
            remark="writes it for predict, compare, export",
        )
    if not request.result_path:
        return ""
    if fit.unit == "Pa":  # no mass rests on a material
        export_arguments = (
            "export",
            request.result_path,
            "--to",
            "abaqus",
            "--form",
            "prony",
            "--unit-system",
            "mm-t-s",
        )
        missing = ("--temperature", "TEMPERATURE") if fit.specimen.temperature is None else ()
        return format_command(*export_arguments, *missing)
    return format_command("predict", request.result_path, "--mass", "MASS", "--seals", 2)


def _make_bench_figures(fit: dp.Fit, records: tuple[Any, ...]) -> dict[str, Callable[[], Any]]:
    """Return the figures of a fit's page: response with its bounds, and the test."""
    first = records[0]
    draw_tests = partial(_draw_bench_tests, fit, records)
    if fit.temperatures is not None and not isinstance(first, dp.RampHold):
        return {"lead": draw_tests, "extra_pictures": lambda: (fit.plot(),)}
    return {
        "lead": lambda: workflow.over_frequency(fit, records),
        "extra_pictures": lambda: (draw_tests(),),
    }


def _draw_bench_tests(fit: dp.Fit, records: tuple[Any, ...]) -> dp.plot.Picture:
    alternatives: list[dp.Fit] = []
    if len(records) == 1 and isinstance(records[0], dp.RampHold):
        method: Method = "hold" if fit.method == "hold" else "full"
        alternatives = [
            workflow.fit_fixed_order(records[0], n, method=method) for n in (1, 2)
        ]  # Fig. 4
    return dp.plot.bench(fit, records, alternatives=alternatives)


# Kinds that are fitted by the function of their registry row.


def run_generic_kind(request: FitRequest) -> CommandResult:
    """Fit the files by the function of their kind."""
    row = KINDS[request.kinds[request.files[0]]]
    request.check_output_suffix(".json", result_name="this fit")
    result = load_object(row.fit)(
        request.files, options=request.reading, **request.select_options(*row.fit_options)
    )
    next_command = (
        request.result_path if word == "FILE" else word for word in row.next_command.split()
    )
    return request.write_output(
        result,
        next_command=format_command(*next_command)
        if request.result_path and row.next_command
        else "",
    )


# Hits, or base excitation: an FRF and its modes.


FRF_SUFFIXES = (".csv", ".uff", ".unv")


def run_hits(request: FitRequest) -> CommandResult:
    """Cut records into hits, judge each, and average them into an FRF."""
    request.check_output_suffix(*FRF_SUFFIXES, ".json", result_name="the FRF of hits")
    mass = request.mass
    result, reason = workflow.impact_files(
        request.files, file=request.output, hammer=request.hammer, options=request.reading,
        mass=mass, band=request["band"],
    )  # fmt: skip
    if reason:
        to_stderr(f"no mode: {reason}")
    if request.page:
        request.save(result)
    elif request.output:
        write_frf(result, result.frf, request.output)
    request.draw(
        lambda: dp.plot.frf(
            result.frf, labels=("measured",), stamp=dp.plot.stamp(result.frf.source, mass=mass)
        )
    )
    mass_text = "MASS" if mass is None else format_grams(mass)
    return CommandResult.from_result(
        result,
        next_command=format_command("compare", "FIT", *request.files, "--mass", mass_text,
                     "--seals", 2, *request.get_option_words("mass", "seals"),
                     remark="tests the fit of a relaxation test"),
    )  # fmt: skip


def write_frf(result: workflow.ImpactResult, frf: dp.FRF, path: str) -> None:
    """Write the result as JSON, or its FRF as CSV or UFF 58, by how the file's name ends."""
    from dashpot.reading.write import write_frf

    suffix = Path(path).suffix.lower()
    if suffix == ".json":
        write_output(path, format_json(result) + "\n")
    else:
        write_output(path, (find_handler("write frf", suffix) or write_frf)(frf))


# Identification from vibration under a known mass, alone or with bench tests.


_DECK_OPTIONS = ("--to", "nastran", "--unit-system", "mm-t-s", "-o", "seal.bdf")
VIBRATION = ("impact", "frf", "transmissibility")


def run_joint(request: FitRequest) -> CommandResult:
    """Identify the solid under a mass from hits or FRFs, and from tests of it on a bench."""
    request.check_output_suffix(".json", *FRF_SUFFIXES, result_name="a fit")
    if request.mass is None:
        raise click.UsageError(
            "A test and a hammer test are fitted together under a mass. "
            "Give the test mass: --mass 104g"
        )
    vibration_files = request.select_files(*VIBRATION)
    other_files = [path for path in request.files if path not in vibration_files]
    fits = [path for path in other_files if is_json(path)]
    read_options = request.reading
    if request["elastic"] == "by-depth":
        raise click.UsageError(
            "--elastic by-depth is for relaxation tests of several depths without a hammer. Fit "
            "them first, then the fit with the hammer."
        )
    result = workflow.identify_files(
        vibration_files,
        BlockOnSeals(request.mass, **request.select_options("seals", "seal_mass", "compression")),
        fits=[workflow.read_fit(path) for path in fits],
        tests=[path for path in other_files if path not in fits],
        options=read_options.drop_fields(read_options.bench_fields),
        options_with=read_options.select_fields(("units", *read_options.bench_fields)),
        family=request.model(FamilyOption, "maxwell"),
        seals_assumed="--seals" not in request.get_option_words(),
        bench=BenchFitOptions(
            law=request["elastic"],
            **request.select_options("method", "time_limits", "filter", "thorough", "shifting",
                         "machine", "specimen"),
        ),
        **request.select_options("rig", "impact_temperature", "arms",
                     "solid_prior", "band", "temperatures", "hammer"),
    )  # fmt: skip
    request.draw(lambda: dp.plot.stiffness(result.fit))
    if request["save_shifts"]:
        write_output(request["save_shifts"], format_shift_table(result.fit))
    if request["stiffness_table"]:
        write_output(request["stiffness_table"], result.direct.table)
    if request.output and request.output.lower().endswith(FRF_SUFFIXES):
        if result.vibration is None:
            raise click.UsageError(
                f"-o {request.output}: of tests and a hammer together a fit is written."
            )
        write_frf(result.vibration, result.vibration.frf, request.output)
    else:
        request.save(result)
    return CommandResult.from_result(
        result, next_command=_format_joint_next_steps(request, result.fit)
    )


def _format_joint_next_steps(request: FitRequest, fit: dp.Fit) -> str:
    output = None if request.page else request.output
    if output == "-":
        return ""
    if output:
        return (
            format_command("export", output, *_make_deck_words(fit))
            if output.endswith(".json")
            else ""
        )
    option_words = request.get_option_words("stiffness_table")
    name = "fit.json" if request.select_files(*VIBRATION) == request.files else "joint.json"
    return format_command(
        "fit", *request.files, *option_words, "-o", name, remark="writes it for export"
    )


def _make_deck_words(fit: dp.Fit) -> list[str]:
    """Return the options of a deck in the valid band, with placeholders for missing values."""
    specimen = fit.specimen
    specimen_values: tuple[tuple[str, Any], ...] = (
        ("--temperature", specimen.temperature), ("--length", specimen.length),
    )  # fmt: skip
    missing = [name for name, item in specimen_values if item is None]
    low, high = max(1, ceil(fit.band[0])), floor(fit.band[1])
    band = ("--band", f"{low}:{high}Hz") if low < high else ()
    return [*_DECK_OPTIONS, *band, *(word for name in missing for word in (name, name[2:].upper()))]
