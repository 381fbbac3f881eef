"""The example files with one mistake each, such as a lab makes: a wrong unit, a swap, a comma."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache

from dashpot import workflow

Row = list[float]
BENCH = ("time [s]", "displacement [mm]", "force [N]")
HAMMER = ("time [s]", "hammer [N]", "acceleration 1 [m/s^2]", "acceleration 2 [m/s^2]")


@cache
def rows(name: str) -> tuple[Row, ...]:
    """The rows of numbers of an example; hits begin at time 0."""
    lines = str(workflow.EXAMPLES[name]()).splitlines()
    return tuple([float(cell) for cell in line.split(",")] for line in lines if line[:1].isdigit())


def table(
    head: Sequence[str],
    filled: Iterable[Row],
    *,
    sign: str = ",",
    printed: Callable[[float], str] = repr,
) -> str:
    """A file of these rows; a heading stands again above each hit."""
    lines = []
    for row in filled:
        if row[0] == 0:
            lines += [""] * bool(lines) + [sign.join(head)]
        lines.append(sign.join(map(printed, row)))
    return "\n".join(lines) + "\n"


def bench(*factors: float, head: Sequence[str] = BENCH) -> str:
    """The seal's file with its columns times factors, under a heading."""
    result = rows("seal_8mm.csv")
    times = factors or (1.0, 1.0, 1.0)
    return table(head, ([a * b for a, b in zip(row, times, strict=True)] for row in result))


def comma(digits: int) -> Callable[[float], str]:
    """How a program set to a decimal comma prints a number."""
    return lambda value: f"{value:.{digits}f}".replace(".", ",")


def hammer(*order: int, head: Sequence[str] = HAMMER) -> str:
    """The hammer's file with its columns in another order, under a heading."""
    result = rows("hammer.csv")
    return table(head, ([row[i] for i in order] if order else row for row in result))


def quote_lines(text: str) -> str:
    """Every line as one quoted cell."""
    return "".join(f'"{line}"\n' for line in text.splitlines())
