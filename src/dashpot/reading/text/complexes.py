"""Cells that hold a complex number, ``(1.5-2j)`` or ``1.5 - 2i``, parted into two cells."""

from __future__ import annotations

import re

from dashpot.reading.columns.header_names import split_unit

_DELIMITERS = ("\t", ";", "|", ",")
_LEAST = 3
"""Rows by which such a column is known."""
_SHARE = 0.8
"""Part of the lines from the first such row on that hold a complex number, at least."""
_ABOVE = 3
"""Lines right above the table that may hold names and units."""
_HOLE = "\0"


def _pattern(mark: str) -> re.Pattern[str]:
    size = rf"(?:\d{{1,40}}(?:{mark}\d{{0,40}})?|{mark}\d{{1,40}})(?:[eEdD][+-]?\d{{1,4}})?"
    return re.compile(
        rf"(?<![\w.])\"?\(?[ ]?(?P<real>[+-]?{size})[ ]?(?P<sign>\+-|[+-])[ ]?"
        rf"(?:(?P<before>{size})\*?[ijIJ]|[ijIJ]\*?(?P<behind>{size}))[ ]?\)?\"?(?![\w.])"
    )


_PATTERNS = (_pattern(r"\."), _pattern(","))


def holds_complex(head: str) -> bool:
    r"""Whether some of the first lines hold complex numbers in their cells.

    >>> holds_complex("f,H\n1,(1+2j)\n2,(2-1j)\n3,(0-1j)"), holds_complex("f,H\n1,2")
    (True, False)
    """
    return any(sum(1 for _ in pattern.finditer(head)) >= _LEAST for pattern in _PATTERNS)


def parted_cells(text: str) -> str | None:
    r"""Return a table with two cells, real and imaginary part, for each complex one.

    The names above are those of the cell with "real" and "imaginary" behind them, the units stay.
    None if hardly any row holds a complex number.

    >>> parted_cells("f [Hz],H [1/kg]\n1,(1+2j)\n2,(2-1j)\n3,(0-1j)").splitlines()[:2]
    ['f [Hz],H real [1/kg],H imaginary [1/kg]', '1,1,+2']
    """
    lines = text.split("\n")
    for pattern in _PATTERNS:
        rows = [i for i, line in enumerate(lines) if pattern.search(line)]
        if len(rows) < _LEAST:
            continue
        filled = [i for i in range(rows[0], len(lines)) if lines[i].strip()]
        if len(rows) < _SHARE * len(filled):
            continue
        bare = pattern.sub(_HOLE, lines[rows[0]]).strip()
        sign = next((delimiter for delimiter in _DELIMITERS if delimiter in bare), " ")
        places = _split(bare, sign)
        for i in rows:
            lines[i] = _with_parts(lines[i], pattern, sign)
        _part_names(lines, rows[0], places, sign)
        return "\n".join(lines)
    return None


def _split(line: str, sign: str) -> list[str]:
    return line.split() if sign == " " else [part.strip() for part in line.split(sign)]


def _with_parts(line: str, pattern: re.Pattern[str], delimiter: str) -> str:
    def parts(match: re.Match[str]) -> str:
        sign = "-" if match["sign"] == "+-" else match["sign"]
        return f"{match['real']}{delimiter}{sign}{match['before'] or match['behind']}"

    if delimiter != " ":
        return pattern.sub(parts, line)
    delimiter = "\t"  # names with their units hold blanks
    return delimiter.join(pattern.sub(parts, line).split())


def _part_names(lines: list[str], first: int, places: list[str], sign: str) -> None:
    """Give each complex column two names, and two units."""
    named = False
    for i in range(max(first - _ABOVE, 0), first):
        cells = _split(lines[i].lstrip("#% "), sign)
        if len(cells) != len(places):
            continue
        wide: list[str] = []
        for cell, held in zip(cells, places, strict=True):
            if _HOLE not in held:
                wide.append(cell)
            elif named:
                wide += [cell, cell]
            else:
                name, unit = split_unit(cell)
                unit = f" [{unit}]" if unit else ""
                wide += [f"{name} real{unit}", f"{name} imaginary{unit}"]
        lines[i] = ("\t" if sign == " " else sign).join(wide)
        named = True
