"""Options named in messages exist in the command that prints them or that they name."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple, get_overloads

import click
import pytest

import dashpot
from dashpot.api.read_save import ReadOptionKeywords
from dashpot.cli import COMMANDS, main
from dashpot.cli._param_types import Keyed
from dashpot.export import TARGETS
from dashpot.workflow.assumptions import ASSUMPTIONS

pytestmark = pytest.mark.once

SOURCES = Path(dashpot.__file__).parent
READING = ("inspect", "fit", "predict", "compare", "report")
BENCH = ("inspect", "fit", "predict", "report")
MEASURED = ("fit", "compare", "report")
SPEAKERS: dict[str, tuple[str, ...]] = {
    "base/": READING,
    "reading/": READING,
    "extensions/formats/": READING,
    "preprocessing/": BENCH,
    "preprocessing/checks.py:temperature_as_stated": ("fit", "report"),
    "datamodel/specimen.py:make_file_specimens": ("fit", "report"),
    "fitting/": ("fit", "predict", "report"),
    "extensions/curves/dynamic/": ("fit",),
    "extensions/curves/modulus/fit.py": ("fit",),
    "extensions/curves/superposition/": ("fit",),
    "fitting/fit_options.py:refuse_shifts": ("fit",),
    "fitting/fit_options.py:checked_family": ("fit", "report"),
    "fitting/fit_options.py:require_maxwell_family": ("fit", "report"),
    "fitting/fit_options.py:refuse_law": ("fit",),
    "fitting/fit_options.py:refuse_family": ("fit", "report"),
    "fitting/input_tests.py:checked_temperatures": ("fit",),
    "fitting/identification/": ("fit", "report"),
    "vibration/comparison/": MEASURED,
    "extensions/modes/checks.py:modes_within_band": ("fit",),
    "extensions/modes/checks.py:segments_resolve": MEASURED,
    "vibration/impact/checks.py:_explain_absolute": MEASURED,
    "vibration/impact/checks.py:_explain_relative": MEASURED,
    "vibration/impact/spectral_estimators.py": MEASURED,
    "extensions/curves/creep/": ("fit", "report"),
    "extensions/curves/fit_records.py": ("fit",),
    "extensions/modes/": ("fit",),
    "export/": ("export",),
    "registry/plugins.py:format_plugin_hint": READING,
    "report/page_frame.py": ("export",),
    "workflow/bench_tests.py": ("fit",),
    "workflow/bench_tests.py:refuse_unfitted_tests": ("predict", "compare"),
    "workflow/bench_tests.py:prepared_tests": ("predict", "compare"),
    "workflow/bench_tests.py:fill_missing_temperatures": ("predict", "compare"),
    "workflow/job.py": ("fit", "predict", "report"),
    "workflow/job.py:refuse_several": ("fit", "report"),
    "workflow/frf_prediction.py": ("predict",),
    "datamodel/machine.py": ("fit",),
    "vibration/mass_on_seals.py:operating_point": ("predict",),
    "extensions/blank_tests/": ("fit",),
    "extensions/materials/csr/": ("fit",),
    "extensions/materials/csr/aging_plan.py": ("plan",),
    "extensions/materials/csr/plan_command.py": ("plan",),
    "extensions/materials/csr/lifetime_prediction.py": ("predict",),
    "extensions/materials/csr/lifetime_prediction.py:fit_life": ("fit",),
    "extensions/materials/drop/": ("fit",),
    "extensions/materials/drop/approach.py": ("fit", "predict"),
    "extensions/materials/drop/prediction.py": ("predict",),
    "extensions/amplitude/fit_files.py": ("fit",),
    "extensions/amplitude/amplitude_response.py": ("predict",),
    "extensions/amplitude/preloaded_response.py": ("predict",),
    "workflow/checks.py:base_band_in_valid_band": ("predict",),
    "extensions/materials/rod/app_form.py": ("fit",),
    "extensions/materials/rod/fit_files.py": ("fit",),
    "workflow/fit_routing.py": ("fit",),
    "workflow/frf_prediction.py:pad": ("predict", "fit"),
    "registry/core.py": ("batch",),
    "extensions/materials/registration.py": ("batch",),
    "extensions/solver_inputs/": ("export",),
    "extensions/curves/temperatures/deck_lines.py": ("export",),
    "extensions/solver_inputs/cards/": ("import",),
    "extensions/solver_inputs/cards/command.py:_format_next": ("predict",),
    "extensions/materials/cld/": ("fit",),
    "extensions/materials/hyperelastic/": ("fit",),
    "extensions/materials/indentation/": ("fit",),
    "extensions/materials/rod/": ("fit",),
    "extensions/amplitude/": ("fit", "predict"),
    "extensions/systems/door/": ("predict",),
    "extensions/transfer_stiffness/": ("stiffness",),
    "extensions/preload_map/": ("map",),
    "extensions/systems/door/export_handler.py": ("export",),
    "extensions/materials/hyperelastic/material_cards.py": ("export",),
    "workflow/frf_comparison.py": MEASURED,
    "workflow/identification.py": MEASURED,
    "workflow/measured_frf.py": MEASURED,
    "workflow/identification.py:_refuse_unmatched": ("fit",),
    "workflow/identification.py:identify_files": ("fit",),
    "workflow/study.py": ("report",),
    "extensions/gauges/simulated_record.py": ("simulate",),
    "extensions/app/command_lines.py": ("report",),
    "extensions/app/command_lines.py:format_predict_command": ("predict",),
    "workflow/outputs.py": ("fit", "report", "export", "predict", "inspect"),
    "extensions/batch/": ("batch",),
    "extensions/projects/": ("verify",),
    "extensions/acquisition/": ("record",),
    "datamodel/shift_factors.py": ("fit",),
    "extensions/curves/datamodel/sample_temperatures.py": ("fit",),
    "text_output/": ("fit", "predict", "compare", "report"),
    "extensions/app/server.py": ("app",),
    "extensions/app/": ("report",),
    "cli/": (),
    "extensions/acquisition/command.py": (),
    "extensions/amplitude/fit_handler.py": (),
    "extensions/app/command.py": (),
    "extensions/batch/command.py": (),
    "extensions/batch/lot_options.py": (),
    "extensions/batch/lot_output.py": (),
    "extensions/systems/door/predict_handler.py": (),
    "extensions/materials/cld/fit_handler.py": (),
    "extensions/acceptance/command_options.py": (),
    "extensions/acceptance/app_panel.py": ("fit", "report"),
    "extensions/materials/fit_options.py": (),
    "extensions/materials/hyperelastic/fit_handler.py": (),
    "extensions/materials/indentation/fit_handler.py": (),
    "extensions/materials/rod/fit_handler.py": (),
    "extensions/dynamic_stiffness/": ("predict",),
    "extensions/guidance/": (),
    "extensions/materials/drop/command_options.py": (),
    "extensions/materials/drop/fit_handler.py": (),
    "extensions/modes/fit_handler.py": (),
    "extensions/paper/command.py": (),
    "extensions/paper/paper_handler.py": (),
    "extensions/paper/story_handler.py": ("demo",),
    "extensions/projects/command.py": (),
}
"""Commands that can print the messages of a package, file or function; the longest name counts."""
OURS = {
    "reading/sandbox/parent_process.py": {"--read-for-dashpot"},
    "plot/svg.py": {"--panel"},
    "extensions/paper/registration.py": {"--files"},  # of demo, whose line in --help it is
}
"""Words that look like options and reach no user."""
PYTHON_ONLY = {
    ("datamodel/frf.py", "quantity"),
    *(("solids/maxwell.py", word) for word in ("k_inf", "k", "tau", "b")),
    ("base/value_ranges.py", "units"),
    ("base/arrays.py", "units"),
    ("datamodel/frf.py", "units"),
    ("solids/maxwell.py", "frequency"),
    ("solids/maxwell.py", "omega"),
    ("extensions/curves/dynamic/fit.py", "dashpot"),
    ("extensions/batch/arrays/fit_many.py", "displacement"),
    ("extensions/batch/arrays/fit_many.py", "ramp"),
    ("preprocessing/contact.py", "drift"),
    ("vibration/comparison/compare.py", "shift"),
    ("vibration/comparison/compare.py", "model"),
    ("vibration/comparison/compare.py", "mass"),
    ("vibration/mass_on_seals.py", "seals"),
    ("vibration/mass_on_seals.py", "compression"),
}
"""Arguments of functions that no command passes on, so that no command can print their names."""
_SPEAK_PYTHON = (
    "api/",
    "extensions/formats/frames.py",
    "extensions/guidance/read_call.py",
    *(f"extensions/{name}/api.py" for name in ("batch", "door", "modes", "amplitude")),
    *(
        f"extensions/materials/{name}/api.py"
        for name in ("rod", "cld", "hyperelastic", "indentation")
    ),
)
"""What no command calls."""
_MARKUP = (
    "plot/",
    "report/",
    *(f"extensions/solver_inputs/{name}" for name in ("felupe", "fmi/", "modelica")),
)
"""What writes SVG, HTML, XML, Modelica and Python."""
_OPTION = re.compile(
    r"(?:dashpot (?P<command>\w+) (?:[A-Z]+ )?)?(?<![\w-])(?P<word>--[a-z][a-z-]+)"
)
_ARGUMENT = re.compile(r"(?<![\w\"'<-])([a-z_]+)=(?!=)")
_PYTHON = re.compile(r"\(Python:(?:[^()]|\([^()]*\))*\)")


class Message(NamedTuple):
    """A text of the sources, and where it stands."""

    file: str
    function: str
    line: int
    text: str


def _format_command(call: ast.Call) -> ast.Constant:
    """The words of another command, each with its name before it."""
    words = [arg.value for arg in call.args if isinstance(arg, ast.Constant)]
    line = " ".join(f"dashpot {words[0]} {word}" for word in words[1:]) if words else ""
    return ast.Constant(line, lineno=call.lineno)


def _texts(node: ast.AST, function: str = "") -> Iterator[tuple[str, ast.expr]]:
    """Strings of a tree with the function around them: no docstrings, no options' declarations."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant):
            continue
        called = getattr(child, "func", None)
        name = getattr(called, "attr", getattr(called, "id", ""))
        if name.endswith(("option", "argument")):
            continue
        if name == "typed":
            yield function, _format_command(child)
            continue
        if isinstance(child, ast.JoinedStr | ast.Constant):
            yield function, child
            continue
        named = isinstance(child, ast.FunctionDef) and not function
        yield from _texts(child, child.name if named else function)


@cache
def messages() -> tuple[Message, ...]:
    result = []
    for path in sorted(SOURCES.rglob("*.py")):
        file = path.relative_to(SOURCES).as_posix()
        for function, node in _texts(ast.parse(path.read_text(encoding="utf-8"))):
            parts = node.values if isinstance(node, ast.JoinedStr) else [node]
            text = "".join(
                part.value
                if isinstance(part, ast.Constant) and isinstance(part.value, str)
                else "{}"
                for part in parts
            )
            result.append(Message(file, function, node.lineno, text))
    return tuple(result)


@cache
def list_options(command: str) -> tuple[click.Option, ...]:
    result = main.get_command(click.Context(main), command)
    assert result is not None
    return tuple(parameter for parameter in result.params if isinstance(parameter, click.Option))


@cache
def options(command: str) -> frozenset[str]:
    return frozenset(word for option in list_options(command) for word in option.opts)


@cache
def keys() -> frozenset[str]:
    """What is typed before an equals sign on a command line: roles, and keys of options."""
    every = [
        option.type
        for name in COMMANDS
        for option in list_options(name)
        if isinstance(option.type, Keyed)
    ]
    return frozenset(key for kind in every for key in kind.fields) | {"role"}


def speakers(message: Message) -> tuple[str, ...]:
    if message.file.startswith("cli/"):
        command = Path(message.file).stem
        return (command,) if command in COMMANDS else ()
    place = f"{message.file}:{message.function}"
    rooms = [folder for folder in SPEAKERS if place.startswith(folder)]
    assert rooms, f"{message.file}:{message.line} names an option; say above who prints it"
    return SPEAKERS[max(rooms, key=len)]


def test_a_message_names_only_options_of_the_command_that_speaks() -> None:
    wrong, seen = [], 0
    for message in messages():
        words = message.file.startswith("cli/") and " " not in message.text  # for `typed`
        if words or message.file == "workflow/assumptions.py":  # below
            continue
        for match in _OPTION.finditer(message.text):
            word = match["word"]
            if word in OURS.get(message.file, ()):
                continue
            seen += 1
            # such as what a row of the register says is typed next
            whole = message.text.partition(" ")[0]
            named = whole if whole in COMMANDS else match["command"]
            for command in (named,) if named in COMMANDS else speakers(message):
                if word not in options(command):
                    wrong.append(f"{message.file}:{message.line}: {command} has no {word}")
    assert not wrong, "\n".join(wrong)
    assert seen > 70


def test_no_message_of_a_command_speaks_python() -> None:
    wrong = []
    for message in messages():
        plain = _PYTHON.sub("", message.text)
        if " " not in plain or message.file.startswith((*_MARKUP, *_SPEAK_PYTHON)):
            continue  # no sentence; words of other languages; or what only Python shows
        for word in _ARGUMENT.findall(re.sub(r"--units \S+|\"[^\"]*\"", "", plain)):
            if word not in keys() and (message.file, word) not in PYTHON_ONLY:
                wrong.append(f"{message.file}:{message.line}: {word}= in '{plain[:80]}'")
    assert not wrong, "\n".join(wrong)


@cache
def arguments() -> frozenset[str]:
    """Every argument of a public function, class or method."""
    result: set[str] = set()
    for name in dashpot.__all__:
        public = getattr(dashpot, name)
        folder = inspect.ismodule(public)
        modules = [getattr(public, item) for item in dir(public)] if folder else [public]
        for module in modules:
            if callable(module):
                try:
                    for element in (module, *get_overloads(module)):
                        result |= set(inspect.signature(element).parameters)
                except (ValueError, AttributeError):
                    continue
    for target in TARGETS.values():
        result |= set(inspect.signature(target).parameters)
    return frozenset(result)


def test_hints_for_python_name_real_arguments() -> None:
    text = {word for _, word in PYTHON_ONLY} - {"ramp"}
    for message in messages():
        for part in _PYTHON.findall(message.text):
            text |= set(_ARGUMENT.findall(part))
    assert text <= arguments() | ReadOptionKeywords.__annotations__.keys() | {
        "shift",
        "omega",
        "dashpot",
    }
    assert "length" in text


@pytest.mark.parametrize("item", ASSUMPTIONS, ids=lambda item: item.name)
def test_an_assumption_names_options_that_exist(item) -> None:
    for option in item.options:
        flag, _, value = option.partition(" ")
        commands = [
            option for name in COMMANDS for option in list_options(name) if flag in option.opts
        ]
        assert commands
        if value.endswith("="):
            assert any(value[:-1] in getattr(command.type, "fields", ()) for command in commands)
        elif value:
            assert any(value in getattr(command.type, "choices", ()) for command in commands)


def test_every_reading_command_has_every_role() -> None:
    roles = (
        "time displacement force acceleration hammer frequency storage loss loss-factor modulus "
        "creep-compliance stress strain temperature real imaginary magnitude phase coherence"
    )
    words = "--column --units --text-format --file-part --rate --calibration --profile --kind"
    assert set(roles.split()) < keys()
    for command in (*READING, "batch"):
        assert set(words.split()) <= options(command)
        (column,) = [option for option in list_options(command) if "--column" in option.opts]
        assert isinstance(column.type, Keyed)
        assert set(roles.split()) <= column.type.fields.keys()
