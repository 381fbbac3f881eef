"""Archive of a functional mock-up unit: description, sources, binaries."""

from __future__ import annotations

import html
import io
import uuid
import zipfile
from functools import cached_property
from hashlib import sha256
from importlib.resources import files

from dashpot.base.version import __version__
from dashpot.export.deck import Deck, DeckText
from dashpot.export.unit_systems import convert_to_printable_ascii, text
from dashpot.extensions.solver_inputs.fmi.binaries import compile_binaries, find_platforms
from dashpot.extensions.solver_inputs.fmi.model_description import (
    FIRST_PARAMETER,
    INPUT,
    OUTPUT,
    RATE,
    TIME,
    ModelDescription,
    Variable,
    format_c_array,
)
from dashpot.extensions.solver_inputs.procedures import format_procedures
from dashpot.registry import format_install_command

_VERSIONS = {"fmi2": "FMI 2.0", "fmi3": "FMI 3.0"}
_SHORTEST = 1e-9
"""s and deck units of mass: the least relaxation time and mass that an importer may set."""
_DATE = (1980, 1, 1, 0, 0, 0)
"""Date of every file in the archive, which then repeats to the byte."""


class ModelUnit(DeckText):
    """FMU: its text is that of ``sources/model.h``, its file the archive.

    Attributes
    ----------
    form : str
    description : ModelDescription
    """

    form: str
    description: ModelDescription
    printable = False

    @property
    def contents(self) -> str:
        """Version and kinds of FMI, and the platforms of its binaries."""
        platforms = ", ".join(find_platforms(self.form))
        platforms_text = f"binaries for {platforms}" if platforms else "sources only, no binaries"
        return f"{_VERSIONS[self.form]}, Model Exchange and Co-Simulation; {platforms_text}"

    @property
    def summary(self) -> str:
        """The contents, and how this installation gets the compiler that they lack."""
        if find_platforms(self.form):
            return self.contents
        advice = format_install_command("fmu")
        return f"{self.contents} (the compiler comes with: {advice})"

    @cached_property
    def file_content(self) -> bytes:
        """The archive; it repeats to the byte."""
        return _pack(self)


def build_fmu(deck: Deck, mass: float | None) -> ModelUnit:
    """Return the FMU of a deck's solid, or of a mass, kg, on it."""
    weight = 1.0 if mass is None else mass / deck.units.mass
    description = _describe(deck, weight, with_mass=mass is not None)
    parameters = _list_parameters(deck, weight)
    body = [
        f"#define ARMS {len(deck.arms)}",
        f"#define WITH_MASS {int(mass is not None)}",
        *format_c_array("START", [text(value) for _, value, *_ in parameters]),
        *format_c_array("LEAST", [text(minimum) for *_, minimum, _ in parameters]),
    ]
    token = _find_token(deck.form, description, body)
    right, *further_remarks = format_procedures("fmu", deck.form)
    written = deck.format_text(
        "//",
        f"{_VERSIONS[deck.form]} model of {description.name}",
        [*body, f'#define TOKEN "{token}"'],
        verified=right,
        remarks=[
            *further_remarks,
            "FMPy validates it; binaries for Linux are run, for Windows and macOS compiled only",
            "Co-Simulation: an input moves on a straight line over a step, from where the last one",
            f"ended to {_INPUTS[mass is not None]}; outputs belong to the end of the step",
        ],
        function=_end_comment,
    )
    model_unit = ModelUnit(written)
    model_unit.verdict, model_unit.overrides, model_unit.checks = (
        written.verdict,
        written.overrides,
        written.checks,
    )
    model_unit.form, model_unit.description = deck.form, description
    return model_unit


_INPUTS = ("x + v h", "F + F_rate h")


def _end_comment(line: str) -> str:
    """Return a line of others' words; a backslash at its end would swallow the next one."""
    line = convert_to_printable_ascii(line)
    return f"{line} ." if line.endswith(("\\", "/")) else line


def _list_parameters(deck: Deck, mass: float) -> list[tuple[str, float, str, float, str]]:
    """Name, value, unit, least value and meaning of each parameter, as sources/solid.h counts."""
    length, weight, time, force, _ = deck.units.words
    stiffness, damping = f"{force}/{length}", f"{force}.{time}/{length}"
    rows = [
        ("k_inf", deck.k_inf, stiffness, 0.0, "equilibrium stiffness"),
        ("b", deck.b, damping, 0.0, "parallel dashpot"),
        ("mass", mass, weight, min(_SHORTEST, float(text(mass))), "mass on the mount"),
    ]
    for j, (k, _, _) in enumerate(deck.arms, start=1):
        rows.append((f"k[{j}]", k, stiffness, 0.0, f"stiffness of arm {j}"))
    for j, (_, tau, _) in enumerate(deck.arms, start=1):
        shortest_step = min(_SHORTEST, float(text(tau)))  # as it is printed
        rows.append((f"tau[{j}]", tau, time, shortest_step, f"relaxation time of arm {j}"))
    return rows


def _find_intervals(deck: Deck) -> dict[str, tuple[float, float]]:
    """Interval of 95 % of each parameter of a fit, deck units; of a bare solid none."""
    fit = deck.linear_fit
    if fit is None or len(fit.intervals()["k"]) != len(deck.arms):
        return {}
    intervals, stiffness = fit.intervals(), deck.units.stiffness(1.0)
    intervals_and_factors = {"k_inf": (intervals["k_inf"], stiffness)}
    for j, (k, tau) in enumerate(zip(intervals["k"], intervals["tau"], strict=True), start=1):
        intervals_and_factors[f"k[{j}]"], intervals_and_factors[f"tau[{j}]"] = (
            (k, stiffness),
            (tau, 1.0),
        )
    return {
        name: (low * by, high * by) for name, ((low, high), by) in intervals_and_factors.items()
    }


def _describe(deck: Deck, weight: float, *, with_mass: bool) -> ModelDescription:
    length, _, _, force, _ = deck.units.words
    arms, parameters = len(deck.arms), _list_parameters(deck, weight)
    inner_count = 2 * with_mass
    first = FIRST_PARAMETER + len(parameters)
    last = first + inner_count + arms
    y = tuple(range(first + inner_count, last))
    speed, force_rate_unit = f"{length}/s", f"{force}/s"
    variables = [Variable("time", TIME, "s", "time", "independent")]
    if with_mass:
        x, v = first, first + 1
        motion = (x, v, *y)
        variables += [
            Variable("F", INPUT, force, "force on the mass", "input", start=0.0),
            Variable("F_rate", RATE, force_rate_unit, _ABOUT_RATE.format("F", "force"), "input",
            start=0.0),
            Variable("x", x, length, "displacement of the mass", "output", initial="exact",
                     start=0.0, depends_on=(x,)),
            Variable("v", v, speed, "velocity of the mass", "output", initial="exact", start=0.0,
                     derivative_of=x, depends_on=(v,)),
            Variable("a", last + 1, f"{length}/s2", "acceleration of the mass", "output",
                     initial="calculated", derivative_of=v, depends_on=(INPUT, *motion)),
        ]  # fmt: skip
        moving: int = x
    else:
        moving = INPUT
        variables += [
            Variable("x", INPUT, length, "displacement", "input", start=0.0),
            Variable("v", RATE, speed, _ABOUT_RATE.format("x", "displacement")
                     + "; in Model Exchange the velocity, which b alone feels", "input", start=0.0),
            Variable("F", OUTPUT, force, "force that holds the displacement", "output",
                     initial="calculated", depends_on=(INPUT, RATE, *y)),
        ]  # fmt: skip
    intervals = _find_intervals(deck)
    for i, (name, value, unit, minimum, description) in enumerate(parameters):
        if name == "mass" and not with_mass:
            continue
        low, high = (f"{end:.6g}" for end in intervals.get(name, (0.0, 0.0)))
        interval_text = f"; 95 % interval {low} to {high} {unit}" * (name in intervals)
        variables.append(
            Variable(name, FIRST_PARAMETER + i, unit, description + interval_text, "parameter",
            "fixed", "exact",
                     float(text(value)), minimum)
        )  # fmt: skip
    for j, state in enumerate(y, start=1):
        variables += [
            Variable(f"y[{j}]", state, length, f"stretch of the dashpot of arm {j}",
                     initial="exact", start=0.0),
            Variable(f"der(y[{j}])", state + inner_count + arms, speed, f"its rate, arm {j}",
                     initial="calculated", derivative_of=state, depends_on=(moving, state)),
        ]  # fmt: skip
    name = "a mass on a viscoelastic mount" if with_mass else "a viscoelastic mount"
    summary = f"{name}: k_inf, {arms} Maxwell arms and b in parallel, {deck.units.name}"
    identifier = "mass_on_mount" if with_mass else "mount"
    return ModelDescription(identifier, name, summary, tuple(variables), deck.units)


_ABOUT_RATE = (
    "slope of {0} over the coming step of Co-Simulation; leave it 0 if {0} is the {1} at the end "
    "of that step"
)


def _find_sources(form: str) -> dict[str, str]:
    folder = files("dashpot.extensions.solver_inputs.fmi").joinpath("sources")
    names = ("solid.h", f"{form}.c")
    return {name: folder.joinpath(name).read_text(encoding="ascii") for name in names}


def _find_token(form: str, description: ModelDescription, body: list[str]) -> str:
    """Return what ties the description to the binary: a digest of both, without date or version."""
    described = description.format_xml(form, "").replace(__version__, "")
    parts = [form, described, *body, *_find_sources(form).values()]
    digest = sha256("\n".join(parts).encode()).digest()
    return f"{{{uuid.UUID(bytes=digest[:16])}}}"


def _pack(unit: ModelUnit) -> bytes:
    """Return the archive, uncompressed, with the header first."""
    form, description = unit.form, unit.description
    token = unit[unit.rindex("{") : unit.rindex("}") + 1]
    sources = {"model.h": str(unit), **_find_sources(form)}
    entries: dict[str, bytes] = {
        f"sources/{name}": content.encode() for name, content in sources.items()
    }
    entries["modelDescription.xml"] = description.format_xml(form, token).encode()
    if form == "fmi3":
        entries["sources/buildDescription.xml"] = _BUILD.format(description.identifier).encode()
    entries["documentation/index.html"] = _format_page(unit).encode()
    entries |= compile_binaries(form, description.identifier, sources)
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name, content in entries.items():
            entry = zipfile.ZipInfo(name, _DATE)
            entry.create_system, entry.external_attr = 3, 0o644 << 16
            archive.writestr(entry, content)
    return buffer.getvalue()


_BUILD = """<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="{}">
    <SourceFileSet language="C99"><SourceFile name="fmi3.c"/></SourceFileSet>
  </BuildConfiguration>
</fmiBuildDescription>
"""


def _format_page(unit: ModelUnit) -> str:
    header = [line[3:] for line in unit.splitlines() if line.startswith("// ")]
    rows = "\n".join(map(html.escape, [*header, "", unit.contents]))
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f"<title>{html.escape(unit.description.name)}</title></head>\n"
        f"<body><pre>{rows}</pre></body></html>\n"
    )
