"""Quirks of exports of ten makers, written before they were read: groups, counts, two languages."""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

from kit.crafted.row import DECAY, LOSS, MODULUS, STORAGE, SWEEP, TANGENT, F, Row, table
from kit.look_alikes import truth

TIME, DISPLACEMENT, FORCE = truth()
THIN, FIRM = "\u2009", "\u00a0"
"""A thin blank, and one at which no line breaks."""


def format_grouped_number(value: float, blank: str, digits: int) -> str:
    """A number with its thousands apart and a decimal comma: 7 553 552,5."""
    return f"{value:,.{digits}f}".replace(",", blank).replace(".", ",")


def _format_grouped_table(head: str, blank: str, unit: float, digits: int, *neighbour: str) -> str:
    rows = zip(F, STORAGE / unit, LOSS / unit, strict=True)
    lines = (
        "\t".join(
            (
                format_grouped_number(f, "", 6),
                "23,0",
                format_grouped_number(a, blank, digits),
                format_grouped_number(b, blank, digits),
                *neighbour,
            )
        )
        for f, a, b in rows
    )
    return "\n".join((head, *lines, ""))


def _format_clock_table() -> str:
    clock = [f"00:00:{t:06.3f}" for t in TIME]
    return table(
        "Prüfzeit;Standardweg;Standardkraft\nhh:mm:ss;mm;N", clock, DISPLACEMENT, FORCE, comma=True
    )


def _format_counter_table(head: str, sign: str, *, quote: bool) -> str:
    part = 1.0 + (TIME > 1.5)
    return table(
        head, TIME, part, DISPLACEMENT, FORCE, part / 2, sign=sign, form="%.10g", quote=quote
    )


QUIRKS = [
    Row("TRIOS: thin blanks group, -,-- for what is missing", _format_grouped_table("Frequency\tTemperature\tStorage modulus\tLoss modulus\tTan(delta)\tStep time\nHz\t°C\tkPa\tkPa\t\ts", THIN, 1e3, 6, "-,--", "3,0").encode(), truth=SWEEP),
    Row("Eplexor: firm blanks group millions, Latin-1", _format_grouped_table("Freq.[Hz]\tTemp.[°C]\tE'[Pa]\tE''[Pa]\ttan d[-]\t", FIRM, 1.0, 3, "0,13", "").encode("cp1252"), truth=SWEEP),
    Row("Eplexor: common blanks group millions", _format_grouped_table("Freq.[Hz]\tTemp.[°C]\tE'[Pa]\tE''[Pa]", " ", 1.0, 3).encode(), truth=SWEEP),
    Row("TestSuite: segments and cycles among the units", _format_counter_table('"Time","Axial Segment Count","Axial Displacement","Axial Force","Axial Count"\n"Sec","segments","mm","N","cycles"', ",", quote=True).encode()),
    Row("TestSuite: cycles among the units", _format_counter_table("Data Header:\tRelax\nTime\tAxial Integer Count\tAxial Displacement\tAxial Force\tAxial Count\t\nSec\tcycles\tmm\tN\tcycles\t", "\t", quote=False).encode()),
    Row("Bluehill: sep=, and names in two languages", b"\xef\xbb\xbf" + table("sep=;\nTime;Compressive extension;Compressive load\nZeit;Kompressionsweg;Kompressionslast\n(s);(mm);(N)", TIME, DISPLACEMENT, FORCE, comma=True, end="\r\n").encode()),
    Row("Bluehill: two languages in one name", table("Zeit / Time [s];Weg / Displacement [mm];Kraft / Force [N]", TIME, DISPLACEMENT, FORCE).encode()),
    Row("testXpert: hours of the test with a decimal comma", _format_clock_table().encode("cp1252")),
    Row("MULTITEST: all of its head behind #", table("# DMA+ 450\n# Longueur: 12,5 mm\n# Fréquence (Hz);Température (°C);Module E' (Pa);Module E\" (Pa);Tan delta", F, 0 * F + 23, STORAGE, LOSS, TANGENT, form="%.9E", comma=True).encode(), truth=SWEEP),
    Row("Trapezium: Japanese, full width, micrometres", table("時間（秒）,試験力（Ｎ）,変位（μｍ）", TIME, FORCE, 1e3 * DISPLACEMENT, sign=",").encode("cp932")),
    Row("raised units with their minus", table("f / s⁻¹;E′ / N·mm⁻²;E″ / N·mm⁻²", F, STORAGE / 1e6, LOSS / 1e6, form="%.9g").encode(), truth=SWEEP),
    Row("turns a minute", table("Frequency [1/min];E' [MPa];E'' [MPa]", 60 * F, STORAGE / 1e6, LOSS / 1e6, form="%.9g").encode(), truth=SWEEP),
    Row("TRIOS: a relaxation with the logarithm of its clock", table("[step]\nStress relaxation\nStep time\tlog(Step time)\tModulus\tStrain\ns\t\tMPa\t%", DECAY, DECAY, 2 + DECAY**-0.1, 0 * DECAY + 2, sign="\t").encode(), truth=MODULUS),
    Row("two specimens one over the other", ("".join(f'"Probe {k}"\n' + table('"Prüfzeit";"Standardweg";"Standardkraft"\n"s";"mm";"N"', TIME, DISPLACEMENT, k * FORCE, comma=True) for k in (1, 2))).encode("cp1252"), "asked", ("the clock starts again at line 67",), answer={"segment": 1}, by_size=True),
]  # fmt: skip
