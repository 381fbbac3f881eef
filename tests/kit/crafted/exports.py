"""Exports in the spirit of rheometers, benches, loggers and analysers, tried before the reader was read."""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

import numpy as np

from kit.crafted.row import (
    ACCELERANCE,
    AMPLITUDES,
    CLOCK,
    COLD,
    CREEP,
    CREPT,
    DECAY,
    HIT,
    HITS,
    ISOTHERMS,
    LINES,
    LOSS,
    LOST,
    MODULUS,
    OVER_BASE,
    OVER_FORCE,
    PULLED,
    RUNG,
    SOFT,
    STORAGE,
    STRAIN,
    SWEEP,
    TANGENT,
    TENSION,
    TICKS,
    TRANSMISSIBILITY,
    WARMTH,
    F,
    Row,
    table,
)
from kit.look_alikes import truth

TIME, DISPLACEMENT, FORCE = truth()
_SIZE, _ANGLE = np.abs(OVER_FORCE), np.degrees(np.angle(OVER_FORCE))
_ROWS = list(zip(*truth(), strict=True))
_G, _LBF, _PSI = 9.80665, 4.4482216152605, 6894.757293168


def bench(
    head: str, sign: str = ";", *, comma: bool = False, code: str = "utf-8", load: float = 1.0
) -> bytes:
    """The ramp and hold under a head."""
    columns = (TIME, DISPLACEMENT, load * FORCE)
    return table(head, *columns, sign=sign, form="%.12g", comma=comma).encode(code)


def encode_rows(head: str, row: str) -> bytes:
    """The ramp and hold, each row as a form says."""
    return (head + "\n" + "".join(row.format(t, x, f) + "\n" for t, x, f in _ROWS)).encode()


def sweep(head: str, *columns: np.ndarray, code: str = "utf-8", comma: bool = False) -> bytes:
    return table(head, *columns, form="%.12g", comma=comma).encode(code)


_TONGUES = {
    "Swedish": ("Tid [s];Förskjutning [mm];Kraft [N]", "cp1252"),
    "Danish": ("Tid [s];Forskydning [mm];Kraft [N]", "cp1252"),
    "Finnish": ("Aika [s];Siirtymä [mm];Voima [N]", "cp1252"),
    "Hungarian": ("Idő [s];Elmozdulás [mm];Erő [N]", "cp1250"),
    "Romanian": ("Timp [s];Deplasare [mm];Forță [N]", "utf-8"),
    "Slovak": ("Čas [s];Posunutie [mm];Sila [N]", "cp1250"),
    "Croatian": ("Vrijeme [s];Pomak [mm];Sila [N]", "cp1250"),
    "Ukrainian": ("Час, с;Переміщення, мм;Зусилля, Н", "cp1251"),
    "Greek": ("Χρόνος [s];Μετατόπιση [mm];Δύναμη [N]", "utf-8"),
}


def _benches() -> list[Row]:
    wet = "Time (s);Position (mm);Load (N)"
    half = [
        f"1/5/2024 {'11:59' if t < 3 else '12:00'}:{(57 + t) % 60:06.3f} {'AM' if t < 3 else 'PM'}"
        for t in TIME
    ]
    logger = table(
        "Number,Date&Time,ms,CH1,CH2\nNO.,Time,ms,mm,N", np.arange(60.0),
        [f"2024/01/05 10:00:{int(t):02d}" for t in TIME], np.round(TIME % 1 * 1e3), DISPLACEMENT, FORCE, sign=",",
    )  # fmt: skip
    page = "".join(
        f"{t};{x};{f}\n" + f"Page {i // 20 + 1} of 3\n\n" * (i % 20 == 19)
        for i, (t, x, f) in enumerate(_ROWS)
    )
    on_its_side = "\n".join(
        ";".join([name, *map(str, values)])
        for name, values in zip(("Time [s]", "Position [mm]", "Load [N]"), truth(), strict=True)
    )
    named = {
        "rate": 10.0,
        "displacement": "4",
        "force": "5",
        "units": {"displacement": "mm", "force": "N"},
    }
    return [
        *(Row(f"in {tongue}", bench(head, comma=True, code=code)) for tongue, (head, code) in _TONGUES.items()),
        Row("in words that nobody knows, by their units", bench("Muda [s];Mwendo [mm];Nguvu [N]")),
        Row("Big5", bench("時間,位移,力量\n(s),(mm),(N)", ",", code="big5")),
        Row("kilograms of force", bench("Time (s);Position (mm);Load (kgf)", load=1 / _G)),
        Row("centinewtons", bench("Time (s);Position (mm);Load (cN)", load=100.0)),
        Row("decanewtons, Polish", bench("Czas [s];Droga [mm];Siła [daN]", code="cp1250", load=0.1)),
        Row("catman with its rate group", bench("Zeit  1 - Standardmessrate [s]\tWeg [mm]\tKraft [N]", "\t", comma=True)),
        Row("names on two lines", bench("Total\tAxial\tAxial\nTime\tDisplacement\tForce\ns\tmm\tN", "\t")),
        Row("an index without a name", encode_rows(",time_s,position_mm,load_N", "7,{0},{1},{2}")),
        Row("milliseconds since 1970", "".join(["timestamp_ms,position_mm,load_N\n", *(f"{1704448800000 + round(1e3 * t)},{x},{f}\n" for t, x, f in _ROWS)]).encode()),
        Row("halves of a day", table("Date Time;Stroke mm;Load N", half, DISPLACEMENT, FORCE).encode()),
        Row("a date and a clock apart", table("Datum;Uhrzeit;Weg [mm];Kraft [N]", ["05.01.2024"] * 60, [f"10:00:{t:06.3f}" for t in TIME], DISPLACEMENT, FORCE, comma=True).encode()),
        Row("two byte-order marks", b"\xef\xbb\xbf\xef\xbb\xbf" + bench(wet)),
        Row("blanks round the delimiter", bench("Time [s] ; Position [mm] ; Load [N]", " ; ", comma=True)),
        Row("pages with their number", (wet + "\n" + page).encode(), "noted", ("'Page 1 of 3'",)),
        Row("whole seconds beside milliseconds", logger.encode(), "asked", ("looks like displacement",), answer=named),
        Row("words behind the last number", encode_rows(wet, "{0};{1};{2} # ok"), "refused", ("column 'Load' (force) holds words where numbers are expected",)),
        Row("a unit in each cell", encode_rows("Time;Position;Load", "{0} s;{1} mm;{2} N"), "refused", ("each number shares its cell with its unit", "'5.9 s;")),
        Row("a table on its side", on_its_side.encode(), "refused", ("line 1 begins with 'Time [s]' and holds 60 numbers", "Transpose")),
        Row("a web page called a workbook", encode_rows("<html><table>", "<tr><td>{0}</td><td>{1}</td><td>{2}</td></tr>"), "refused", ("is a document ('<html'), not a table",)),
        Row("a workbook of XML", encode_rows('<?xml version="1.0"?><Workbook>', "<Row>{0} {1} {2}</Row>"), "refused", ("is a document ('<?xml')",)),
        Row("rich text", encode_rows("{{\\rtf1".replace("{{", "{"), "{0} {1} {2}\\par"), "refused", ("is a document ('{\\rtf')",)),
    ]  # fmt: skip


def _materials() -> list[Row]:
    omega, both = 2 * np.pi * F, np.concatenate([F, F])
    twice = [np.concatenate([COLD * value, value]) / 1e6 for value in (STORAGE, LOSS)]
    size = np.hypot(STORAGE, LOSS)
    kelvin = np.concatenate([0 * F + 273.15 + value for value in WARMTH])
    untold = "".join(
        f"# T = {warm:g}\n"
        + sweep("f [Hz];E' [MPa];E'' [MPa]", F, k * STORAGE / 1e6, k * LOSS / 1e6).decode()
        for warm, k in zip(WARMTH, (COLD, 1.0), strict=True)
    )
    return [
        Row("primes that are none of the keyboard", sweep("ω [rad/s];G′ [Pa];G″ [Pa]", omega, STORAGE, LOSS), truth=SWEEP),
        Row("dyn/cm2 of an older rheometer", sweep("Freq Hz;G' (dyn/cm2);G'' (dyne/cm^2)", F, 10 * STORAGE, 10 * LOSS), truth=SWEEP),
        Row("omega in 1/s", sweep("ω [1/s];G' [Pa];G'' [Pa]", omega, STORAGE, LOSS), truth=SWEEP),
        Row("an angular frequency in 1/s, beside the size", sweep("Angular frequency in 1/s;G* in MPa;tan δ", omega, size / 1e6, TANGENT), truth=SWEEP),
        Row("omega in Hz", sweep("omega [Hz];G' [Pa];G'' [Pa]", F, STORAGE, LOSS), "asked", ("angular frequency", '"frequency=rad/s"'), SWEEP, answer={"units": {"frequency": "Hz"}}),
        Row("millihertz and kilopascals", sweep("Frequency [mHz];E' [kPa];E'' [kPa]", 1e3 * F, STORAGE / 1e3, LOSS / 1e3), truth=SWEEP),
        Row("pounds on a square inch", sweep("Freq (Hz);E' (psi);E'' (psi)", F, STORAGE / _PSI, LOSS / _PSI), truth=SWEEP),
        Row("newtons on a square millimetre, German", sweep("Frequenz [Hz];Speichermodul [N/mm²];Verlustmodul [N/mm²]", F, STORAGE / 1e6, LOSS / 1e6, code="cp1252", comma=True), truth=SWEEP),
        Row("RheoWin with its segments", table("RheoWin 4.87\n\n;t_seg [s];f [Hz];G' [Pa];G'' [Pa];tan(δ) [-]", [f"1|{i}" for i in range(13)], 9 * F, F, STORAGE, LOSS, TANGENT, comma=True).encode(), "noted", ("begins with '1|0'",), SWEEP),
        Row("isotherms in kelvin", sweep("T [K];f [Hz];E' [MPa];E'' [MPa]", kelvin, both, *twice), truth=ISOTHERMS),
        Row("isotherms in degrees Fahrenheit", sweep("T [°F];f [Hz];E' [MPa];E'' [MPa]", 1.8 * (kelvin - 273.15) + 32, both, *twice, code="cp1252"), truth=ISOTHERMS),
        Row("blocks of two temperatures that nothing says", untold.encode(), "refused", ("moduli differ 2 times", "--file-part segment=1"), SWEEP),
        Row("the second block of two", untold.encode(), "asked", ("moduli differ 2 times",), SWEEP, answer={"segment": 2}),
        Row("names with their units behind in", sweep("t in s;G(t) in Pa;T in °C", DECAY, 1e6 * (2 + DECAY**-0.1), 0 * DECAY + 23), truth=MODULUS),
        Row("a creep in inches and pounds", sweep("Elapsed Time (min);Strain (mm/mm);Stress (psi)", CLOCK / 60, CREPT / 100, 1e5 / _PSI + 0 * CLOCK), truth=CREEP),
        Row("true strain and stress", sweep("True strain [-];True stress [MPa]", np.log(1 + PULLED), PULLED**0.8 * (1 + PULLED)), "noted", ("is true, as its name says",), TENSION),
        Row("a strain from peak to peak", sweep("DSA [%];f [Hz];G' [MPa];G'' [MPa]", 200 * STRAIN, 10 + 0 * STRAIN, SOFT / 1e6, LOST / 1e6), truth=AMPLITUDES),
        Row("an effective strain", sweep("Strain rms [%];f [Hz];G' [MPa];G'' [MPa]", 100 * STRAIN / 2**0.5, 10 + 0 * STRAIN, SOFT / 1e6, LOST / 1e6), truth=AMPLITUDES),
    ]  # fmt: skip


def _analysers() -> list[Row]:
    level = 20 * np.log10(_SIZE)
    return [
        Row("a linear axis over a row of units", sweep("Linear;Real;Imaginary\nHz;(m/s^2)/N;(m/s^2)/N", LINES, OVER_FORCE.real, OVER_FORCE.imag), truth=ACCELERANCE),
        Row("decibels over what they are of", sweep("Frequency [Hz];Magnitude [dB re 1 (m/s^2)/N];Phase [deg]", LINES, level, _ANGLE), truth=ACCELERANCE),
        Row("decibels alone", sweep("Frequency [Hz];Magnitude [dB];Phase [deg]", LINES, level, _ANGLE), "refused", ("'dB', which makes no FRF",), ACCELERANCE),
        Row("decibels of a transmissibility", sweep("Freq [Hz];Transmissibility [dB];Phase [deg]", LINES, 20 * np.log10(np.abs(OVER_BASE)), np.degrees(np.angle(OVER_BASE))), truth=TRANSMISSIBILITY),
        Row("a phase in radians", sweep("f [Hz];|H| [(m/s^2)/N];Phase [rad];Kohärenz [-]", LINES, _SIZE, np.angle(OVER_FORCE), 0 * LINES + 0.99), truth=ACCELERANCE),
        Row("a phase without a unit", sweep("f [Hz];|H| [(m/s^2)/N];Phase", LINES, _SIZE, np.radians(_ANGLE)), "asked", ("has no unit", '"phase=deg"'), ACCELERANCE, answer={"units": {"phase": "rad"}}),
        Row("a phase that goes round", sweep("f [Hz];|H| [(m/s^2)/N];Phase [deg]", LINES, _SIZE, _ANGLE - 360 * (np.arange(len(LINES)) % 3)), truth=ACCELERANCE),
        Row("a phase that is called a lag", sweep("f [Hz];|H| [(m/s^2)/N];Phase lag [deg]", LINES, _SIZE, _ANGLE), "noted", ("must be negative where the response is late",), ACCELERANCE),
        Row("g over pounds", sweep("Frequency (Hz);Magnitude (g/lbf);Phase (deg)", LINES, _SIZE * _LBF / _G, _ANGLE), truth=ACCELERANCE),
        Row("a hammer in pounds, an accelerometer in g", sweep("Time[s];Ch1 Hammer (lbf);Ch2 Accel (g)", TICKS, HIT / _LBF, RUNG / _G), truth=HITS),
    ]  # fmt: skip


EXPORTS = [*_benches(), *_materials(), *_analysers()]
