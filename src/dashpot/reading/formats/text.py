"""Delimited text format, with its dialect inferred from the text."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import islice, pairwise, takewhile
from operator import eq

from dashpot.base import units
from dashpot.base.errors import ReadError
from dashpot.base.lazy import compile_on_use
from dashpot.base.provenance import Caution
from dashpot.reading.columns.vocabulary import clock_order
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.table import FileTable, LoadedColumns, Question
from dashpot.reading.text import cells
from dashpot.reading.text.dialect import (
    COLUMNS,
    MAX_LENGTH,
    Dialect,
    decimals,
    decode_blocks,
    find_dialect,
    find_encoding,
    is_overlong,
    most_cells,
)
from dashpot.reading.text.header import Header, read_header
from dashpot.reading.text.rows import Heading, load_rows, title

_HEADER_SIZES = (1 << 16, 1 << 20, 1 << 24)
_LARGE_FILE = 1 << 28
_IMAGINARY = compile_on_use(
    rb"[ijIJ](?:(?:(?<=\d.)|(?<=\d\s.)|(?<=\d\*.)|(?<=\d\s\*.))\b"
    rb"|(?:(?<=[+-].)|(?<=[+-]\s.))\*?\d)"
)
"""What no table of complex cells is without: i or j behind a number or before one.

The letter stands first in the pattern, since a table holds few of them, and many digits.
"""
_MAX_COMPLEX = 1 << 26
"""Largest size of a file whose complex cells are split, bytes: it is held as a whole."""
_MARKUP = compile_on_use(
    rb"\A(?:\xef\xbb\xbf)?\s{0,99}(<(?:!doctype\b|html\b|head\b|body\b|table\b|\?xml\b)|\{\\rtf)",
    re.I,
)
"""Start of a web page, a document of XML or rich text."""
_MIN_TABLE_ROWS = 6
"""Fewest rows of a table; one on its side has fewer, each of as many times so many numbers."""
_DIGIT_SAMPLE_ROWS = 6
"""Rows from the first on that show how all are printed."""
_OF_A_FACTOR = 2
"""Significant digits of a factor or a limit that stands above a column, at most."""
_NAMES = {"\t": "tab", ";": "semicolon", ",": "comma", " ": "blanks", "|": "pipe", ":": "colon"}
_MARKS = {".": "point", ",": "comma", ".,": "point and comma, mixed"}


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the table of a text file.

    Raises
    ------
    ReadError
        If the file is binary, holds no table of numbers, or its commas can be read two ways.
    """
    markup_match = _MARKUP.match(raw.head(_HEADER_SIZES[0]))
    if markup_match:
        raise ReadError(
            f"is a document ('{markup_match[1].decode()}'), not a table, as some programs save it "
            "under the name of a workbook: open it in a spreadsheet program and save it as xlsx or "
            "csv"
        )
    encoding = options.encoding or find_encoding(raw.head(_HEADER_SIZES[0]))
    raw, encoding = _split_complex_cells(raw, encoding)
    for size in _HEADER_SIZES:
        lines, is_complete = _lines(raw, encoding, size, detected=options.encoding is None)
        if not is_complete and len(lines) < _DIGIT_SAMPLE_ROWS and size < _HEADER_SIZES[-1]:
            continue  # too few to break here, whatever they are
        lines = [*[""] * min(options.skip_rows, len(lines)), *lines[options.skip_rows :]]
        dialect = find_dialect(lines, delimiter=options.delimiter, decimal=options.decimal)
        if is_complete or (
            dialect is not None and len(lines) - dialect.first >= _DIGIT_SAMPLE_ROWS
        ):
            break
    if dialect is None:
        raise ReadError(_no_table(lines, options))
    if is_complete and _is_transposed(lines[dialect.first :], dialect):
        raise ReadError(
            f"its channels stand in rows: line {dialect.first + 1} begins with "
            f"'{lines[dialect.first].partition(dialect.delimiter)[0].strip()[:40]}' and holds "
            f"{len(dialect.numbers)} numbers. Transpose the table: a column for each channel"
        )
    return _table(raw, encoding, lines, dialect, options)


def _split_complex_cells(raw: RawFile, encoding: str) -> tuple[RawFile, str]:
    """The file with two cells for each complex one, and its encoding; as it is without any."""
    if raw.size > _MAX_COMPLEX or not _IMAGINARY.search(raw.head(_HEADER_SIZES[0])):
        return raw, encoding
    from dashpot.reading.text.cells import (
        holds_complex,
        parted_cells,  # few need them
    )

    try:
        if not holds_complex(raw.head(_HEADER_SIZES[0]).decode(encoding, "replace")):
            return raw, encoding
        text = parted_cells(raw.head(raw.size).decode(encoding).replace("\r\n", "\n"))
    except UnicodeDecodeError:
        return raw, encoding
    return (raw, encoding) if text is None else (RawFile(raw.name, None, text.encode()), "utf-8")


def _lines(raw: RawFile, encoding: str, size: int, *, detected: bool) -> tuple[list[str], bool]:
    """Return the lines of the first bytes, and whether that is the whole file."""
    head = raw.head(size)
    is_complete = len(head) == raw.size
    if b"\0" in head.rstrip(b"\0\r\n ") and not encoding.startswith(
        ("utf-16", "utf-32", "utf_16", "utf_32")
    ):
        from dashpot.registry.plugins import format_plugin_hint  # looks for installed packages

        raise ReadError(
            "not a text file (zero bytes), and no format that dashpot knows by its content; export "
            f"it as text (csv, txt){format_plugin_hint()}"
        )
    if not is_complete:  # an incremental decoder waits for the rest of a character cut in two
        text = "".join(_partial(head, encoding, detected=detected))
        return text.split("\n")[:-2], False  # the last line is cut
    text = "".join(decode_blocks([head], encoding, detected=detected))
    return text.removesuffix("\n").split("\n"), True


def _partial(head: bytes, encoding: str, *, detected: bool) -> list[str]:
    rows = []
    try:
        for text in decode_blocks([head], encoding, detected=detected):
            rows.append(text)
    except ReadError:
        # the last character is cut in two; anything else fails again when the rows are read
        if not rows:
            raise
    return rows


def _table(
    raw: RawFile, encoding: str, lines: list[str], dialect: Dialect, options: ReadOptions
) -> FileTable:
    lines_above = lines[: dialect.first]
    header = [line for line in lines_above if line.strip()]
    new_header = read_header(lines_above, dialect)
    notes = list(filter(None, (new_header.misfit, new_header.uneven)))
    remarks, questions = _rows_above(lines_above, dialect)
    notes += [
        *remarks,
        *_factors(header),
        *_odd_first_row(lines[dialect.first :], dialect),
    ]
    if dialect.mark == ".,":
        notes.append("decimal points and decimal commas are mixed; both are read as decimal marks")
    if raw.size > _LARGE_FILE:
        notes.append(
            f"a file of {raw.size / 1e6:.0f} MB, read in blocks; if it is finer sampled than the "
            "test needs, export it at a lower rate"
        )
    if encoding not in {"utf-8", "utf-8-sig"}:
        notes.append(f"text decoded as {encoding}")

    def load(indexes: Sequence[int]) -> LoadedColumns:
        return load_rows(
            lambda: decode_blocks(raw.blocks(), encoding, detected=options.encoding is None),
            dialect,
            indexes,
            Heading(new_header.columns, _clock_orders(new_header, options), title(header)),
            is_decimal_certain=options.decimal is not None,
            time_budget=raw.patience,
        )

    return FileTable(
        format="text",
        columns=new_header.columns,
        load=load,
        encoding=encoding,
        delimiter=_NAMES.get(dialect.delimiter, dialect.delimiter),
        decimal=_MARKS[dialect.mark],
        header=tuple(header),
        notes=tuple(notes),
        simulated=any(
            "simulated" in line.casefold() for line in header if re.match(r"\A\s*+[#%$!/*;]", line)
        ),
        questions=tuple(questions),
        hints=(*filter(None, [new_header.misfit]), *_hints(header)),
    )


def _is_transposed(lines: Sequence[str], dialect: Dialect) -> bool:
    """Return whether a few long rows, each behind its name, are what should be columns."""
    filled = sum(1 for line in lines if line.strip())
    words = dialect.contents[0] == "text" and dialect.contents.count("text") == 1
    return words and filled < _MIN_TABLE_ROWS <= len(dialect.numbers) // _MIN_TABLE_ROWS


def _factors(header: Sequence[str]) -> list[Caution]:
    """Note a line of the header that states a factor: none is applied, and any may be meant."""
    for line in header:
        match = _FACTOR.search(line[:500])
        numbers = _NUMBER.findall(match.string[match.end() : 500]) if match else []
        if any(float(number.replace(",", ".")) != 1.0 for number in numbers):
            text = line.strip().replace("\t", " ")[:60]
            message = f"the header says '{text}'; no factor is applied to the numbers"
            return [Caution(message)]
    return []


def _odd_first_row(lines: Sequence[str], dialect: Dialect) -> list[str]:
    """Note a first row that is printed with other digits than all of the next."""

    def iterate_row_decimals(row: Sequence[str]) -> Iterator[int | None]:
        return (decimals(row[i], dialect.mark) for i in dialect.numbers)

    rows = islice((row for line in lines[:20] if (row := dialect.row(line))), _DIGIT_SAMPLE_ROWS)
    first, second = next(rows, None), next(rows, None)
    if not (first and second) or any(
        map(eq, iterate_row_decimals(first), iterate_row_decimals(second))
    ):
        return []  # as it nearly always is: no more are read
    if any(_significant(first[i]) > _OF_A_FACTOR for i in dialect.numbers):
        return []  # what is printed with so many digits is measured
    other_decimals = [list(iterate_row_decimals(row)) for row in rows]
    like = list(iterate_row_decimals(second))
    if len(other_decimals) < _DIGIT_SAMPLE_ROWS - 2 or any(row != like for row in other_decimals):
        return []
    message = f"line {dialect.first + 1}, the first row, is printed otherwise than those below it"
    return [Caution(f"{message}: '{lines[0].strip()[:60]}'; if it is none, take it out")]


def _significant(cell: str) -> int:
    """Return the number of significant digits of a printed number, without trailing zeros."""
    mantissa = cell.lower().partition("e")[0]
    return len("".join(filter(str.isdigit, mantissa)).strip("0"))


def _rows_above(lines_above: Sequence[str], dialect: Dialect) -> tuple[list[str], list[Question]]:
    """Note a row of numbers right above the table that is not like its rows; ask about several."""
    filled = [(number, line) for number, line in enumerate(lines_above, start=1) if line.strip()]
    odd = list(takewhile(lambda pair: dialect.resembles_row(pair[1]), reversed(filled)))
    if not odd:
        return [], []
    number, line = odd[-1]
    if len(odd) == 1:  # it may well count the rows or columns
        message = f"line {number} above the table is no row of it: '{line.strip()[:60]}'"
        return [Caution(message) if _multiplies(line, dialect) else message], []
    cells_above, width = len(cells.split(line, dialect.delimiter)), dialect.cells
    message = (
        f"line {number} has {cells_above} cells where the table has {width} from line "
        f"{dialect.first + 1} on: '{line.strip()[:60]}'; split the file there, or read what stands "
        f"below with --text-format skip={dialect.first}"
    )
    return [], [Question(message, "--text-format skip=N")]


def _multiplies(line: str, dialect: Dialect) -> bool:
    """Return whether a row has a number for each column that counts neither columns nor rows."""
    numbers = [cells.number(part, dialect.mark) for part in cells.split(line, dialect.delimiter)]
    values = [number for number in numbers if number is not None]
    if len(values) < len(dialect.numbers) or not all(values):
        return False
    steps = {round(after - before, 9) for before, after in pairwise(values)}
    return steps != {1.0} and set(values) != {1.0}


def _clock_orders(header: Header, options: ReadOptions) -> tuple[str, ...]:
    """Return the order of date parts of each column: as the user states, else as the header."""
    return tuple(
        (column.content == "clock" and clock_order(options.unit_of("time", column.name))) or clock
        for column, clock in zip(header.columns, header.clocks, strict=True)
    )


_MEASURED = compile_on_use(r"\A[+-]?\d[\d.,]{0,40}\s?([^\W\d_]\S{0,9})\Z")
_FACTOR = compile_on_use(
    r"\b(?<!loss )(?<!shape )(?<!form )(?<!safety )(?<!quality )(?<!power )(?<!crest )"
    r"(?:scal(?:e|ing)|gain|factor|\w{1,20}f[ae][ck]tor|faktor|skalierung|verstärkung|multiplier"
    r"|slope|conversion|attenuat(?:ion|or)|divi(?:sor|der)|amplification)\b"
    r"|=(?=\s{0,3}(?:\d[\d.,]{0,9}\s{0,3}[*×·]\s{0,3}[^\W\d]|[^\W\d]\w{0,20}\s{0,3}[*×·]\s{0,3}\d))",
    re.IGNORECASE,
)
_NUMBER = compile_on_use(r"\d{1,9}(?:[.,]\d{1,9})?")
_RATE = compile_on_use(
    r"(?:sampl\w{0,20}|abtast\w{0,20}|scan\w{0,20}|acquisition|messrate|data|częstotliwość|采样)"
    r"\W{0,20}(?:rate|freq\w{0,20}|frequenz|频率|próbkowania)?"
    r"[^\d\n]{0,12}?(\d{1,12}(?:[.,]\d{1,12})?)\W{0,3}(k?Hz|1/s)",
    re.IGNORECASE,
)


_INTERVAL = compile_on_use(
    r"(?:(?:sampl|abtast|scan|acquisition|recording|log|mess|data)\w{0,20}\W{0,5}"
    r"(?:interval\w{0,4}|period\w{0,2}|time|step|zeit|schritt)|time\W{0,3}(?:step|increment)"
    r"|zeitschritt|abtast(?:intervall|zeit)|delta\W?[xt]|(?<!\w)dt)(?!\w)"
    r"[^\d\n]{0,12}?(\d{1,12}(?:[.,]\d{1,12})?(?:[eE][-+]?\d{1,2})?)\W{0,3}"
    r"((?:[mµu]?s|sec(?:onds?)?|milliseconds?|min)?)(?!\w)",
    re.IGNORECASE,
)


def _interval_hints(header: Sequence[str]) -> list[str]:
    """Return a hint on the sampling interval that the header states."""
    for line in header:
        match = _INTERVAL.search(line[:500])
        unit = match and units.find_unit(match[2] or "s", "time")
        step = float(match[1].replace(",", ".")) * unit.factor if match and unit else 0.0
        if step > 0:
            message = f"the header says '{line.strip()[:60]}'; if that is the time between two rows"
            return [f"{message}, add --rate {1 / step:.10g}Hz"]
    return []


def _hints(header: Sequence[str]) -> list[str]:
    """Return a hint on the sampling rate that the header states, for a table without time."""
    names = []
    for line in header:
        match = _RATE.search(line[:500])
        if match:
            rate = float(match[1].replace(",", ".")) * (1e3 if match[2][:1] in "kK" else 1.0)
            names.append(
                f"the header says '{line.strip()[:60]}'; if that is the rate, add "
                f"--rate {rate:.10g}Hz"
            )
    return names[:1] or _interval_hints(header)


def _have_units(line: str) -> bool:
    """Return whether each of several cells holds a number and its unit."""
    matches = [_MEASURED.match(part.strip()) for part in re.split(r"[;\t|]|,\s", line)]
    return len(matches) > 1 and all(match and units.find_unit(match[1]) for match in matches)


def _no_table(lines: Sequence[str], options: ReadOptions) -> str:
    filled = [line for line in lines if line.strip()]
    if not filled:
        return "holds nothing but blank lines; export the test again"
    tried_text = ""
    if options.delimiter or options.decimal:
        tried_text = " with the delimiter and decimal mark given (leave out --text-format)"
    overlong_lines = [(number, line) for number, line in enumerate(lines, 1) if is_overlong(line)]
    if 2 * len(overlong_lines) >= len(filled):
        number, line = overlong_lines[-1]
        return (
            f"line {number} has {len(line)} characters and {most_cells(line)} cells, and at most "
            f"{MAX_LENGTH} characters and {COLUMNS} cells of a line are read; export fewer "
            "channels, or a row for each sample if each channel has its row"
        )
    first = filled[0].strip()[:60]
    if _have_units(filled[-1]) and _have_units(filled[len(filled) // 2]):
        return (
            f"each number shares its cell with its unit, such as '{filled[-1].strip()[:40]}': "
            "write the units into the header and take them out of the cells"
        )
    line_ends = ((line.strip()[0], line.strip()[-1], line.count('"')) for line in filled)
    if all(end == ('"', '"', 2) for end in line_ends):
        return (
            f"every line stands in quotes as one cell, such as {first}: take the quotes out, or "
            "export the table again with a cell for each number"
        )
    if all(
        not any(cells.numeric(line.replace(",", " ").replace(";", " ").split(), "."))
        for line in filled
    ):
        return (
            f"no numbers under the header{tried_text}: {len(filled)} lines of text, "
            f"the first is '{first}'; expected rows of numbers below the column names"
        )
    return (
        f"no table of numbers found{tried_text} in {len(filled)} lines, the first is "
        f"'{first}'; expected rows of equally many numbers, parted by one kind of delimiter "
        "(--text-format delimiter=, decimal= or skip= says it)"
    )
