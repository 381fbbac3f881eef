"""Files that look sound and are easily read wrong: one ramp and hold, the look-alikes' truth.

The odd line stands late in the hold, where a lost sample does no harm.
"""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

from collections.abc import Sequence

from kit.crafted.row import Row
from kit.look_alikes import ROWS, truth

HEAD = "Time (s);Temp (C);Position (mm);Load (N);Count"
THREE = "Time (s);Position (mm);Load (N)"
ODD = 50
LINE = ODD + 2
"""The line of the odd row under one line of header."""


def five() -> list[list[str]]:
    """Cells of the truth with a temperature inside and a counter behind."""
    return [
        [f"{t:.5f}", f"{20 + 0.01 * i:.2f}", f"{x:.5f}", f"{f:.5f}", str(i % 7)]
        for i, (t, x, f) in enumerate(zip(*truth(), strict=True))
    ]


def three() -> list[list[str]]:
    """Cells of the truth."""
    return [[f"{v:.5f}" for v in row] for row in zip(*truth(), strict=True)]


def join_rows(
    rows: Sequence[Sequence[str]], head: str = THREE, sign: str = ";", end: str = "\n"
) -> str:
    """A file of the rows."""
    return end.join([head, *(sign.join(row) for row in rows)]) + end


def replace_row(rows: list[list[str]], at: int, row: list[str]) -> list[list[str]]:
    """The rows with one of them replaced."""
    return [*rows[:at], row, *rows[at + 1 :]]


def put(text: str, line: int, *others: str) -> str:
    """The text with lines put in before a line, counted from 1."""
    lines = text.split("\n")
    return "\n".join([*lines[: line - 1], *others, *lines[line - 1 :]])


def scale_column(rows: list[list[str]], first: int, column: int, factor: float) -> list[list[str]]:
    """The rows, one column in another unit from some row on."""
    return [
        [*row[:column], f"{float(row[column]) * factor:.8f}", *row[column + 1 :]]
        if i >= first
        else row
        for i, row in enumerate(rows)
    ]


def swap_columns(rows: list[list[str]], first: int, a: int, b: int) -> list[list[str]]:
    """The rows, two columns exchanged from some row on."""
    order = {a: b, b: a}
    return [
        [row[order.get(j, j)] for j in range(len(row))] if i >= first else row
        for i, row in enumerate(rows)
    ]


def _list_quoted_cells() -> list[Row]:
    labelled = [[r[0], f'"run A, {i}"', *r[2:4]] for i, r in enumerate(five())]
    once = [[r[0], '"run A, 5"' if i == ODD else "run A", *r[2:4]] for i, r in enumerate(five())]
    head = "Time (s),Note,Position (mm),Load (N)"
    number = [[r[0], f'"1,{i:03d}.50"', *r[2:4]] for i, r in enumerate(five())]
    inch = [[r[0], '5" pipe', *r[2:4]] for r in five()]
    broken = [[r[0], '"line\nbreak"' if i == ODD else "ok", *r[2:4]] for i, r in enumerate(five())]
    wide = [[r[0], *r[2:4], f'"a,b {i}"'] for i, r in enumerate(five())]
    return [
        Row("a comma inside every quoted cell", join_rows(labelled, head, ",").encode()),
        Row("a comma inside one quoted cell", join_rows(once, head, ",").encode()),
        Row("a semicolon inside a quoted cell", join_rows(replace_row(five(), ODD, [five()[ODD][0], '"1;2"', *five()[ODD][2:]]), HEAD).encode() ),
        Row("grouped thousands in quotes", join_rows(number, "Time (s),Microstrain,Position (mm),Load (N)", ",").encode()),
        Row("an inch mark in a cell", join_rows(inch, head, ",").encode()),
        Row("a line break inside a quoted cell", join_rows(broken, head, ",").encode(), "refused", (f"line {LINE}",)),
        Row("quoted commas in the last column", join_rows(wide, "Time (s),Position (mm),Load (N),Note", ",").encode()),
        Row("a line break in quoted names", join_rows(three(), '"Time\n(s)","Position\n(mm)","Load\n(N)"', ",").encode()),
        Row("a quoted comma in a name", join_rows(three(), '"Time (s)","Position, top (mm)","Load (N)"', ",").encode()),
    ]  # fmt: skip


def _list_ragged_rows() -> list[Row]:
    rows = five()
    grown = [[*r[:1], "1", *r[1:]] if i >= ODD else r for i, r in enumerate(rows)]
    marked = [[*r, "9"] if i >= ODD else r for i, r in enumerate(rows)]
    shrunk = [[r[0], *r[2:]] if i >= ODD else r for i, r in enumerate(rows)]
    half = [[r[0], *r[2:]] if i >= 20 else r for i, r in enumerate(rows)]
    item = replace_row(rows, ODD, [rows[ODD][0], *rows[ODD][2:]])
    words = [[*r, "contact"] if i == ODD else r for i, r in enumerate(three())]
    inside = replace_row(three(), ODD, [three()[ODD][0], "M1", *three()[ODD][1:]])
    front = replace_row(three(), ODD, ["M1", *three()[ODD]])
    glued = [
        *three()[:ODD],
        [*three()[ODD][:2], three()[ODD][2] + three()[ODD + 1][0], *three()[ODD + 1][1:]],
        *three()[ODD + 2 :],
    ]
    trailing = join_rows(item, HEAD).replace("\n", ";;\n")
    last = replace_row(rows, ROWS - 1, rows[-1][:2])
    other = join_rows(three()).split("\n")
    other[LINE - 1] = other[LINE - 1].replace(";", ",")
    return [
        Row("a column appears inside", join_rows(grown, HEAD).encode(), "refused", (f"line {LINE}", "6 cells")),
        Row("a marker column appears behind", join_rows(marked, HEAD).encode(), "refused", (f"line {LINE}", "6 cells")),
        Row("a column is lost", join_rows(shrunk, HEAD).encode(), "refused", (f"line {LINE}", "4 cells")),
        Row("a column is lost early", join_rows(half, HEAD).encode(), "refused", ("line 2 has 5 cells", "4 from line 22")),
        Row("one row lost a cell", join_rows(item, HEAD).encode(), "refused", (f"line {LINE}", "4 cells")),
        Row("one row lost a cell before trailing delimiters", trailing.encode(), "refused", (f"line {LINE}",)),
        Row("one row lost a cell, tabs", join_rows(item, HEAD.replace(";", "\t"), "\t").encode(), "refused", (f"line {LINE}",)),
        Row("a word behind one row", join_rows(words).encode()),
        Row("a word inside one row", join_rows(inside).encode(), "refused", (f"line {LINE}",)),
        Row("a word before one row", join_rows(front).encode(), "refused", (f"line {LINE}",)),
        Row("two rows on one line", join_rows(glued).encode(), "refused", (f"line {LINE}",)),
        Row("the last row is cut off", join_rows(last, HEAD).encode(), "noted", ("passed over",), without=(ROWS - 1,)),
        Row("one row has another delimiter", "\n".join(other).encode(), "refused", (f"line {LINE}",)),
        Row("every cell of a row is NaN", join_rows(replace_row(three(), ODD, ["NaN"] * 3)).encode(), "refused", (f"line {LINE} lacks time",)),
    ]  # fmt: skip


def _blanks() -> list[Row]:
    def format_aligned_table(hole: int | None, left: bool = False, count: int = 1) -> str:
        lines = ["Time (s)    Temp (C)    Position (mm)   Load (N)   Count"]
        for i, r in enumerate(five()):
            cells = ["" if j == hole and ODD <= i < ODD + count else c for j, c in enumerate(r)]
            lines.append("".join(c.ljust(12) if left else c.rjust(12) for c in cells).rstrip())
        return "\n".join(lines) + "\n"

    loose = join_rows(
        replace_row(five(), ODD, [five()[ODD][0], *five()[ODD][2:]]), HEAD.replace(";", "  "), " "
    )
    wide = [
        [
            f"{float(r[0]):8.3f}",
            f"{float(r[1]) * (1000 if i >= ODD else 1):8.2f}",
            f"{float(r[2]):10.3f}",
            r[3].rjust(10),
        ]
        for i, r in enumerate(five())
    ]
    names = "Time (s)  Temp (C)  Position (mm)  Load (N)"
    return [
        Row("a blank cell in aligned rows", format_aligned_table(1).encode()),
        Row("a blank cell in rows aligned to the left", format_aligned_table(1, left=True).encode()),
        Row("blank cells in many aligned rows", format_aligned_table(1, count=9).encode()),
        Row("a blank last cell in aligned rows", format_aligned_table(4).encode(), "refused", (f"line {LINE}", "4 cells")),
        Row("a blank force in aligned rows", format_aligned_table(3).encode(), "refused", (f"line {LINE} lacks force",)),
        Row("a lost cell in loose rows", loose.encode(), "refused", (f"line {LINE}", "4 cells")),
        Row("numbers grow over their field", join_rows(wide, names, "").encode(), "refused", (f"line {LINE}",)),
    ]  # fmt: skip


def _headers() -> list[Row]:
    text = join_rows(scale_column(three(), ODD, 2, 1e-3))
    milli = "Time (s);Position (mm);Load (kN)"
    order = "Time (s);Load (N);Position (mm)"
    swap = join_rows(swap_columns(three(), ODD, 1, 2))
    units = "Time;Position;Load\ns;mm;N"
    pause = put(join_rows(three()), LINE, "", "Pause", THREE)
    two = join_rows(three(), "Time;Position;Load\ns;mm;N\ns;mm;kN")
    return [
        Row("a second header in another unit", put(text, LINE, milli).encode(), "asked", (f"line {LINE}", "kN"), without=tuple(range(ODD, ROWS)), answer={"segment": 1}),
        Row("a second header after a pause", put(text, LINE, "", "Pause", milli).encode(), "refused", (f"line {LINE + 2}", "kN")),
        Row("a second header in another order", put(swap, LINE, order).encode(), "refused", (f"line {LINE}", "Load")),
        Row("a second header with a row of units", put(join_rows(scale_column(three(), ODD, 2, 1e-3), units), LINE + 1, "Time;Position;Load", "s;mm;kN").encode(), "refused", ("line 54", "kN")),
        Row("a second row of units alone", put(join_rows(scale_column(three(), ODD, 2, 1e-3), units), LINE + 1, "s;mm;kN").encode(), "refused", ("line 53", "kN")),
        Row("a commented second header", put(text, LINE, "# " + milli).encode(), "refused", (f"line {LINE}", "kN")),
        Row("the same header again", pause.encode(), "noted", ("2 segments",)),
        Row("two rows of units", two.encode(), "asked", ("stands under two units, N or kN", '--units "force=N"'), answer={"units": {"force": "N"}}),
        Row("a unit in the name and another below", join_rows(three(), "Time (s);Position (mm);Load (kN)\ns;mm;N").encode(), "asked", ("kN", "--units"), answer={"units": {"force": "N"}}),
        Row("a remark inside", put(join_rows(three()), LINE, "# a lorry passed").encode(), "noted", ("remark",)),
        Row("a header that takes the table over", join_rows(three(), "Sensor;Cell 1;Cell 2\nTime;Position;Load\ns;mm;N").encode()),
        Row("a name that runs over two rows beside a group", join_rows(three(), "Time (s);Bench;\n;Position (mm);Load (N)").encode()),
        Row("a name over two rows over a row of units", join_rows(three(), "Time;Bench;\n;Position;Load\ns;mm;N").encode()),
        Row("a blank unit of the counter, and one too few", "\n".join(["No;Time;Position;Load", ";s;mm", *(f"{i};" + ";".join(r) for i, r in enumerate(three()))]).encode(), "asked", ("'Load' (force) has no unit",), answer={"units": {"force": "N"}}),
        Row("merged cells over the names", join_rows(three(), "Bench;;Cell\nTime;Position;Load\ns;mm;N").encode()),
        Row("fewer names than columns", "\n".join([THREE, *(f"{i + 1};" + ";".join(r) for i, r in enumerate(three()))]).encode(), "refused", ("3 names", "4 columns")),
        Row("row names as R writes them", "\n".join(['"Time" "Position" "Load"', *(f'"{i + 1}" ' + " ".join(r) for i, r in enumerate(three()))]).encode(), "refused", ("3 names", "4 columns")),
        Row("more names than columns", join_rows(three(), "Time (s);Temp (C);Position (mm);Load (N)").encode(), "refused", ("4 names", "3 columns")),
        Row("units fewer than names", join_rows(five(), "Time;Temp;Position;Load;Count\ns;mm;N").encode(), "refused", ("unit",)),
    ]  # fmt: skip


def _marks() -> list[Row]:
    time, displacement, force = truth()
    rows = list(zip(time, displacement, force, strict=True))

    def micro(text: str) -> str:
        return f"Time (s);Position (um);Load (N)\n{text}"

    grouped = "Zeit [ms];Weg [um];Kraft [mN]\n" + "".join(
        f"{1e3 * t:,.0f};{1e3 * x:,.0f};{1e3 * f:,.0f}\n" for t, x, f in rows
    )
    late = "".join(f"{round(t * 1e3):,};{x:.5f};{f:.5f}\n".replace(",", "'") for t, x, f in rows)
    german = "".join(
        f"{t:.1f};{x * 1e3:,.1f};{f:.5f}\n".translate(str.maketrans(",.", ".,")) for t, x, f in rows
    )
    cut = "".join(
        f"{t:.5f},{x:.5f},{f:.5f}\n".replace(".", ",").replace(",00000", ",0") for t, x, f in rows
    )
    seconds = "".join(
        f"{i},{x:.5f},{f:.5f}\n".replace(".", ",") for i, (_, x, f) in enumerate(rows)
    )
    return [
        Row("points group the thousands beside small numbers", grouped.replace(",", ".").encode(), "asked", ("--text-format decimal=",), answer={"decimal": ","}, coarse=1e-3),
        Row("commas group the thousands beside small numbers", grouped.encode(), "asked", ("--text-format decimal=",), answer={"decimal": "."}, coarse=1e-3),
        Row("points group thousands and millions", grouped.replace(",", ".").replace("Kraft [mN]", "Kraft [mN];Hits").replace("\n", ";1.234.567\n").replace("Hits;1.234.567", "Hits").encode(), coarse=1e-3),
        Row("apostrophes group the thousands", ("Time (ms);Position (mm);Load (N)\n" + late).encode()),
        Row("typeset apostrophes group the thousands", ("Time (ms);Position (mm);Load (N)\n" + late.replace("'", "\u2019")).encode()),
        Row("German thousands with decimals", micro(german).encode()),
        Row("decimal commas parted by commas", ("Time (s),Position (mm),Load (N)\n" + cut).encode(), "refused", ("3 names", "6 columns")),
        Row("decimal commas parted by commas, whole seconds", ("Time (s),Position (mm),Load (N)\n" + seconds).encode(), "refused", ("3 names", "5 columns")),
        Row("one decimal comma in a file of points", join_rows(replace_row(three(), ODD, [three()[ODD][0], "8,000", three()[ODD][2]])).encode(), "refused", ("8,000",)),
        Row("a number with its unit", join_rows(replace_row(three(), ODD, [*three()[ODD][:2], three()[ODD][2] + " N"])).encode(), "refused", (f"line {LINE} lacks force",)),
        Row("blanks group the thousands", micro("".join(f"{t:.1f};{x * 1e3:,.1f};{f:.5f}\n".replace(",", "\u202f") for t, x, f in rows)).encode()),
    ]  # fmt: skip


def _clocks() -> list[Row]:
    time, displacement, force = truth()

    def encode_clock_cells(head: str, cells: Sequence[str]) -> bytes:
        rows = zip(cells, displacement, force, strict=True)
        return (
            head
            + ";Position (mm);Load (N)\n"
            + "".join(f"{c};{x:.5f};{f:.5f}\n" for c, x, f in rows)
        ).encode()

    def hms(day: str, start: float, next_day: str = "") -> list[str]:
        out = []
        for t in time:
            s = start + t
            over = s >= 86400
            s -= 86400 * over
            out.append(
                f"{next_day if over else day} {int(s // 3600):02d}:{int(s // 60) % 60:02d}:{s % 60:06.3f}".strip()
            )
        return out

    night = 86400 - 3.05
    minutes = [f"{int(600 * t) // 60:02d}:{int(600 * t) % 60:02d}" for t in time]
    return [
        Row("US dates on one day", encode_clock_cells("Timestamp", hms("04/05/2024", 3600))),
        Row("US dates across midnight, both possible", encode_clock_cells("Timestamp", hms("04/05/2024", night, "04/06/2024")), "asked", ("04/05/2024", "m/d/y"), answer={"units": {"time": "m/d/y"}}),
        Row("European dates across midnight, both possible", encode_clock_cells("Timestamp", hms("05/04/2024", night, "06/04/2024")), "asked", ("05/04/2024", "d/m/y"), answer={"units": {"time": "d/m/y"}}),
        Row("US dates across midnight at the end of a month", encode_clock_cells("Timestamp", hms("01/31/2024", night, "02/01/2024"))),
        Row("US dates that show late which is the day", encode_clock_cells("Timestamp", hms("01/12/2024", night, "01/13/2024"))),
        Row("European dates at the end of a month", encode_clock_cells("Timestamp", hms("31/01/2024", night, "01/02/2024"))),
        Row("German dates across midnight", encode_clock_cells("Zeit", hms("05.04.2024", night, "06.04.2024"))),
        Row("ISO dates across midnight", encode_clock_cells("Time", hms("2024-04-05", night, "2024-04-06"))),
        Row("a clock across midnight", encode_clock_cells("Time", hms("", night)), "noted", ("midnight",)),
        Row("dates with the name of a month", encode_clock_cells("Time", hms("31-Jan-2024", night, "01-Feb-2024"))),
        Row("dates with the German name of a month", encode_clock_cells("Zeit", hms("31. März 2024", night, "01. Apr. 2024"))),
        Row("years of two digits, no other order possible", encode_clock_cells("Time", hms("31.12.24", night, "01.01.25"))),
        Row("years of two digits, any order possible", encode_clock_cells("Time", hms("04/05/06", night, "04/06/06")), "asked", ("04/05/06", "m/d/y"), answer={"units": {"time": "m/d/y"}}),
        Row("a time zone", encode_clock_cells("Time", [f"2024-03-31T01:59:{t:06.3f}+01:00" for t in time])),
        Row("summer time begins", encode_clock_cells("Time", [f"2024-03-31 {'01:59' if t < 2.95 else '03:00'}:{(57 + t) % 60:06.3f}{'+01:00' if t < 2.95 else '+02:00'}" for t in time])),
        Row("dates that are none", encode_clock_cells("Time", hms("45/45/2024", 3600)), "refused", ("45/45/2024",)),
        Row("am and pm", encode_clock_cells("Time", [f"01/05/2024 {'11:59' if t < 3.95 else '12:00'}:{(56 + t) % 60:06.3f} {'AM' if t < 3.95 else 'PM'}" for t in time])),
        Row("minutes and tenths as Excel shows them", encode_clock_cells("Time", [f"00:{t:04.1f}" for t in time])),
        Row("a colon before the milliseconds", encode_clock_cells("Time", [f"00:00:{int(t):02d}:{round(t % 1 * 1000):03d}" for t in time])),
    ] + [
        Row(f"minutes and seconds as the header says: {word}", encode_clock_cells(word, minutes), slow=600.0)
        for word in ("Time [mm:ss]", "Time (min:s)", "Time (m:s)")
    ] + [
        Row("hours or minutes", encode_clock_cells("Time", minutes), "asked", ("mm:ss", "hh:mm"), answer={"units": {"time": "mm:ss"}}, slow=600.0),
        Row("hours on request", encode_clock_cells("Time", minutes), "asked", ("mm:ss", "hh:mm"), answer={"units": {"time": "hh:mm"}}, slow=36000.0),
    ]  # fmt: skip


def _list_printed_tables() -> list[Row]:
    rows = three()
    tenfold = [[*row[:2], f"{10 * float(row[2]):.5f}"] for row in rows]
    later = [[f"{float(row[0]) + 2:.5f}", *row[1:]] for row in rows]
    marked = [[*row[:2], "-9999" if i in {1, 2} else row[2]] for i, row in enumerate(rows)]
    halves = join_rows(rows[:ODD]), join_rows(rows[ODD:])
    odd = [[*row[:2], "(" + row[2] + ")" if i == ODD else row[2]] for i, row in enumerate(rows)]
    wrapped = "\n".join(
        [
            "Time (s) Temp (C) Position (mm)",
            "Load (N) Count",
            *(" ".join(part) for row in five() for part in (row[:3], row[3:])),
        ]
    )
    tail = join_rows(rows).rstrip("\n")
    return [
        Row("the last number is cut off behind the mark", tail[:-3].encode(), "noted", ("cut off",), without=(ROWS - 1,)),
        Row("the last number is cut off before the mark", tail[:-6].encode(), "noted", ("cut off",), without=(ROWS - 1,)),
        Row("no line end behind the last row", tail.encode()),
        Row("a mark for no reading", join_rows(marked).encode(), "noted", ("mark of no reading",), without=(1, 2)),
        Row("a factor in the name", join_rows(tenfold, "Time (s);Position (mm);Load*10 (N)").encode(), "refused", ("*10 N",)),
        Row("a factor in the name over a row of units", join_rows(tenfold, "Time;Position;Load x 10^1\ns;mm;N").encode(), "refused", ("x 10^1 N",)),
        Row("units that belong to other names", join_rows(rows, "Time (s);Load (N);Position (mm)\ns;mm;N").encode(), "refused", ("N or mm",)),
        Row("two files joined, with their byte-order marks", (halves[0] + "\ufeff" + halves[1]).encode(), "noted", ("2 segments",)),
        Row("rows joined behind a byte-order mark", (halves[0] + "\ufeff" + halves[1].split("\n", 1)[1]).encode()),
        Row("a row that numbers the columns", join_rows([["1", "2", "3"], *later]).encode(), "noted", ("'1;2;3'",)),
        Row("a row of blank cells", put(join_rows(rows), LINE, ";;").encode()),
        Row("rows of blank cells at the end", (join_rows(rows) + ";;\n" * 9).encode()),
        Row("a negative number as an accountant writes it", join_rows(odd).encode(), "refused", (f"line {LINE} lacks force",)),
        Row("rows wrapped over two lines", wrapped.encode(), "refused", ("--column time=",)),
        Row("a sentence about units", put(join_rows(rows), LINE, "Load still in N").encode(), "noted", ("Load still in N",)),
        Row("a gain in the header", ("Gain (Load): 0.01\n" + join_rows(rows)).encode(), "noted", ("no factor is applied",)),
        Row("a gain of one", ("Scale;1;1,0;1.00\n" + join_rows(rows)).encode()),
        Row("factors over the columns", ("Scale;1;1;0.01\n" + join_rows(rows)).encode(), "noted", ("'Scale;1;1;0.01'",)),
        Row("grouped thousands of whole millimetres", join_rows([[row[0], f"{round(float(row[1])) * 200:,}".replace(",", "."), row[2]] for row in rows], "Time (s);Position (um);Load (N)").encode(), "refused", ("'1.000' can mean",)),
        Row("a row of statistics far behind", (join_rows(rows) + "\n60;5.87;1.18\n").encode(), "noted", ("does it belong",), extra=1),
        Row("a row of statistics under labels", (join_rows([["A", *row] for row in rows], "Run;" + THREE) + "Max;6.00;8.00;1.90\n").encode(), "noted", ("ends with 'Max'",), extra=1),
        Row("two runs under one header", join_rows([["A" if i < ODD else "B", *row] for i, row in enumerate(rows)], "Run;" + THREE).encode(), "noted", ("begins with 'A' and ends with 'B'",)),
        Row("full-width digits", join_rows(rows).translate({48 + i: 0xFF10 + i for i in range(10)}).encode()),
        Row("a pause of another delimiter", (join_rows(rows[:ODD]) + join_rows(rows[ODD:], "", "\t")[1:]).encode(), "refused", ("line",)),
    ]  # fmt: skip


TREACHEROUS = [
    *_list_quoted_cells(),
    *_list_ragged_rows(),
    *_blanks(),
    *_headers(),
    *_marks(),
    *_clocks(),
    *_list_printed_tables(),
]
