"""What the user said to ``dashpot fit``: the records, what each was taken for, and the options."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from dashpot import workflow
from dashpot.base.choices import get_choice_values
from dashpot.cli._command_io import CommandResult, format_json, write, write_figure
from dashpot.cli._options import get_typed_options as typed_again
from dashpot.cli._param_types import format_suggestion
from dashpot.datamodel.specimen import Specimen
from dashpot.reading.read_options import ReadOptions
from dashpot.workflow.job import HammerChoices

PAGE = (".html", ".htm")


@dataclass(frozen=True)
class FitRequest:
    """The records of a fit and its options.

    Attributes
    ----------
    files : tuple of str
    kinds : mapping of str to str
        What each file was taken for.
    said : mapping
        The options by name, in SI.
    """

    files: tuple[str, ...]
    kinds: Mapping[str, str]
    said: Mapping[str, Any]

    def __getitem__(self, name: str) -> Any:
        return self.said[name]

    def some(self, *names: str) -> dict[str, Any]:
        """Return these options by name."""
        return {name: self.said[name] for name in names}

    def select_files(self, *kinds: str) -> tuple[str, ...]:
        """Return the files of these kinds, in their order."""
        return tuple(path for path in self.files if self.kinds[path] in kinds)

    def model(self, choice: Any, usual: str = "auto") -> Any:
        """Return the word of ``--model``, one of a choice.

        Raises
        ------
        click.UsageError
            If it is another.
        """
        named = self.said["model"] or usual
        values = get_choice_values(choice)
        if named not in values:
            raise click.UsageError(
                f"--model: '{named}' is unknown. {format_suggestion(named, values)}"
            )
        return named

    @property
    def mass(self) -> float | None:
        """The one mass that was given, kg."""
        masses = self.said["mass"]
        if len(masses) > 1:
            raise click.UsageError(
                f"--mass was given {len(masses)} times. Give it once, for these files together."
            )
        return masses[0] if masses else None

    @property
    def reading(self) -> ReadOptions:
        """What was said of the files."""
        options: ReadOptions = self.said["options"]
        return options

    @property
    def hammer(self) -> HammerChoices:
        """How hits are averaged."""
        choices: HammerChoices = self.said["hammer"]
        return choices

    @property
    def output(self) -> str | None:
        """Where the result goes."""
        path: str | None = self.said["output"]
        return path

    @property
    def specimen(self) -> Specimen:
        """The specimen, with the one temperature of all files."""
        warmth = self.said["temperatures"]
        if len(warmth) > 1:
            raise click.UsageError(
                f"--temperature was given {len(warmth)} times; these records have one."
            )
        from dataclasses import replace

        specimen: Specimen = self.said["specimen"]
        return replace(specimen, temperature=warmth[0]) if warmth else specimen

    def refuse_polarity(self) -> None:
        """Refuse a sign of FRFs where none is heeded: a mass or a level does not depend on it.

        Raises
        ------
        click.UsageError
        """
        if self.hammer.polarity is not None:
            raise click.UsageError(
                "--polarity is for hits, or for FRFs whose modes or solid are sought. Leave it out."
            )

    def check_output_suffix(self, *suffixes: str, what: str) -> str | None:
        """Return the suffix of the file that keeps the result or its page; None where none is.

        Raises
        ------
        click.UsageError
            If such a result is not written so.
        """
        if self.output is None:
            return None
        suffix = Path(self.output).suffix.lower()
        if suffix in (*suffixes, *PAGE) or not suffix:
            return suffix or suffixes[0]
        text = " or ".join((*suffixes, PAGE[0]))
        raise click.UsageError(f"-o {self.output}: {what} is written as {text}, not as {suffix}.")

    def draw(self, figure: Any) -> None:
        """Draw the figure that a function makes, if it was asked for."""
        if self.said["picture"]:
            write_figure(self.said["picture"], figure())

    @property
    def page(self) -> bool:
        """Whether the result goes to a page."""
        return bool(self.output) and str(self.output).lower().endswith(PAGE)

    def keep(self, result: Any, **figures: Any) -> None:
        """Write what is kept of a result, or its page, if it was asked for.

        `figures` are what the page may show beside the result's own, each made when it is needed.
        """
        if not self.output:
            return
        if not self.page:
            write(self.output, format_json(result.kept) + "\n")
            return
        made = {name: make() for name, make in figures.items()}
        write(self.output, workflow.html(result, **made))

    def told(
        self, result: Any, *, figure: Callable[[], Any] | None = None, follow: str = ""
    ) -> CommandResult:
        """Draw and keep a result as was asked, and return what is told of it."""
        self.draw(figure or result.plot)
        self.keep(result)
        return CommandResult.from_result(result, follow=follow)

    @property
    def result_path(self) -> str:
        """The file that the result can be read back from; empty where there is none."""
        return "" if self.output in {None, "-"} or self.page else str(self.output)

    def get_option_words(self, *but: str) -> list[str]:
        """Return the options as they were typed."""
        return typed_again(but=("picture", "output", *but))
