"""Records to text that every reader here, and any spreadsheet, takes back."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.records.frf import FRF
from dashpot.records.impact import ImpactTest
from dashpot.records.relaxation import RelaxationTest


def write_relaxation(
    test: RelaxationTest, path: str | Path | None = None, *, comments: Sequence[str] = ()
) -> str:
    """Return a relaxation test as text, and write it to `path` if one is given.

    The columns are ``time [s], displacement [mm], force [N]``. Every number has
    all its digits. Each comment stands on a line of its own, after ``#``.
    """
    head = ["time [s]", "displacement [mm]", "force [N]"]
    columns = [test.time, 1e3 * test.displacement, test.force]
    stamp = ["simulated"] if test.source is not None and test.source.simulated else []
    return _written(_text([*_stamped(stamp, comments), *comments], head, columns), path)


def write_impact(
    test: ImpactTest, path: str | Path | None = None, *, comments: Sequence[str] = ()
) -> str:
    """Return an impact test as text, and write it to `path` if one is given.

    The columns are ``time [s], hammer [N], acceleration 1 [m/s^2], ...``, or the channels' own
    names where they have them. The records follow one another; a line with the names stands
    again before each further one.
    """
    head = ["time [s]", "hammer [N]", *(f"{_named(name)} [m/s^2]" for name in test.channels)]
    stamp = ["simulated"] if any(source.simulated for source in test.source) else []
    parts = []
    for number, record in enumerate(test.records()):
        above = (
            [*_stamped(stamp, comments), *comments] if number == 0 else [f"record: {number + 1}"]
        )
        columns = [test.time[record], test.force[record], *test.acceleration[:, record]]
        parts.append(_text(above, head, columns))
    return _written("".join(parts), path)


def write_frf(frf: FRF, path: str | Path | None = None, *, comments: Sequence[str] = ()) -> str:
    """Return an FRF as text that `read_frf` takes back whole, and write it to `path`.

    Comment lines hold the kind, the window's shift, the record length and the number of
    averages; the columns are frequency, real and imaginary part, magnitude, phase, and the
    coherence and standard deviation where the FRF has them.
    """
    stamp = ["simulated"] if any(source.simulated for source in frf.source) else []
    above = [
        "dashpot frequency response function",
        *_stamped(stamp, comments),
        *comments,
        f"kind: {frf.kind.value}",
        f"shift [1/s]: {float(frf.shift)!r}",
        *([] if frf.record is None else [f"record [s]: {float(frf.record)!r}"]),
        f"averages: {frf.averages}",
    ]
    unit = frf.unit
    named: list[tuple[str, FloatArray]] = [
        ("frequency [Hz]", frf.frequency),
        (f"real [{unit}]", frf.value.real),
        (f"imaginary [{unit}]", frf.value.imag),
        (f"magnitude [{unit}]", np.abs(frf.value)),
        ("phase [deg]", np.degrees(np.angle(frf.value))),
    ]
    if frf.coherence is not None:
        named.append(("coherence [1]", frf.coherence))
    if frf.sd is not None:
        named.append((f"sd [{unit}]", frf.sd))
    text = _text(above, [name for name, _ in named], [values for _, values in named])
    return _written(text, path)


def neutral(cell: str) -> str:
    """Return a text cell that no spreadsheet takes for a formula.

    >>> neutral("=1+1"), neutral("m_1")
    ("'=1+1", 'm_1')
    """
    line = " ".join(cell.split())
    return "'" + line if line[:1] in set("=+-@|%") else line


def _named(name: str) -> str:
    """A channel's name as a header cell: no delimiter, no bracket, no formula."""
    return neutral(name.translate(str.maketrans(',;\t"[]()', "        "))) or "acceleration"


def _stamped(stamp: Iterable[str], comments: Sequence[str]) -> list[str]:
    """The stamp, unless a comment carries it already."""
    return [word for word in stamp if not any(word in comment.casefold() for comment in comments)]


def _text(above: Sequence[str], head: Sequence[str], columns: Sequence[FloatArray]) -> str:
    lines = [f"# {' '.join(line.split())}" for line in above]
    lines.append(",".join(head))
    # repr is the shortest text that reads back as the same number
    cells = [map(repr, np.asarray(column, dtype=float).tolist()) for column in columns]
    lines.extend(map(",".join, zip(*cells, strict=True)))
    return "\n".join(lines) + "\n"


def _written(text: str, path: str | Path | None) -> str:
    if path is not None:
        Path(path).write_text(text, encoding="utf-8", newline="\n")
    return text
