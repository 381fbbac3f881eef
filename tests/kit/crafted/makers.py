"""What the programs of ten makers export, from their manuals and from what labs publish of them.

Written before the reader was changed. TA TRIOS, Netzsch Proteus, Anton Paar RheoCompass, Malvern
rSpace, Metravib, Gabo Eplexor, Zwick testXpert, Instron Bluehill, MTS TestSuite, Shimadzu Trapezium.
"""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

import numpy as np

from kit.crafted.row import (
    AMPLITUDES,
    CLOCK,
    COLD,
    CREEP,
    CREPT,
    DECAY,
    DEFLECTION,
    ISOTHERMS,
    LOSS,
    LOST,
    MODULUS,
    PRESSED,
    PULLED,
    RAMP,
    SOFT,
    STORAGE,
    STRAIN,
    SWEEP,
    TANGENT,
    TENSION,
    F,
    Row,
    table,
)
from kit.look_alikes import truth

TIME, DISPLACEMENT, FORCE = truth()
NUMBERS = [str(i + 1) for i in range(len(F))]
SIZE = np.hypot(STORAGE, LOSS)
WARM = np.array([23.0 + 0.01 * (i % 3) for i in range(len(F))])


def _trios() -> list[Row]:
    top = (
        "Filename\tC:\\Data\\seal 3.tri\nInstrument name\tDMA850\nProcedure name\tSweeps\nrundate\t"
    )
    names = (
        "Angular frequency\tStep time\tTemperature\tStorage modulus\tLoss modulus\tTan(delta)\t"
        "Oscillation strain\n"
    )
    units = "rad/s\ts\t°C\tMPa\tMPa\t\t%"
    omega = 2 * np.pi * F

    def block(title: str, warm: float, factor: float) -> str:
        head = f"\n[step]\n{title}\n{names}{units}"
        return table(
            head, omega, 9 * F, warm + 0 * F, factor * STORAGE / 1e6, factor * LOSS / 1e6, TANGENT,
            0 * F + 0.1, sign="\t", end="\r\n",
        )  # fmt: skip

    both = (
        top
        + "05/02/2024\r\n"
        + block("Frequency sweep - 1", 0.0, COLD)
        + block("Frequency sweep - 2", 23.0, 1.0)
    )
    german = table(
        "Dateiname\tDichtung.tri\nProbenname\tEPDM\n\n[step]\nFrequenzsweep - 1\n"
        "Kreisfrequenz\tSchrittzeit\tTemperatur\tSpeichermodul\tVerlustmodul\tTan(delta)\n"
        "rad/s\ts\t°C\tPa\tPa\t",
        omega, F, WARM, STORAGE, LOSS, TANGENT, sign="\t", comma=True, end="\r\n",
    )  # fmt: skip
    relaxed = table(
        "[step]\nStress relaxation - 1\nStep time\tTemperature\tRelaxation modulus\ns\t°C\tMPa",
        DECAY, 23 + 0 * DECAY, 2 + DECAY**-0.1, sign="\t",
    )  # fmt: skip
    both_clocks = table(
        "[step]\nStress relaxation - 1\nTime\tStep time\tRelaxation modulus E(t)\tAxial strain\n"
        "s\ts\tMPa\t%",
        DECAY + 31, DECAY, 2 + DECAY**-0.1, 1 + 0 * DECAY, sign="\t", end="\r\n",
    )  # fmt: skip
    crept = table(
        "[step]\nCreep - 1\nStep time,Strain,Stress\ns,%,Pa",
        CLOCK,
        CREPT,
        1e5 + 0 * CLOCK,
        sign=",",
    )
    return [
        Row("TRIOS: two steps, UTF-8", b"\xef\xbb\xbf" + both.encode(), truth=ISOTHERMS),
        Row("TRIOS: two steps, UTF-16", both.encode("utf-16"), truth=ISOTHERMS),
        Row("TRIOS: German", german.encode("cp1252"), truth=SWEEP),
        Row("TRIOS: a step of relaxation", relaxed.encode(), truth=MODULUS),
        Row("TRIOS: a step of creep", crept.encode(), truth=CREEP),
        Row(
            "TRIOS: a relaxation, clocks of the step and of the whole",
            both_clocks.encode("utf-16"),
            truth=MODULUS,
        ),
    ]


def _proteus() -> list[Row]:
    def head(mark: str, sign: str) -> str:
        keys = (
            "#EXPORTTYPE:DATA ALL", "#FILE:seal.ngb-dm5", "#FORMAT:NETZSCH5", "#FTYPE:ANSI",
            "#IDENTITY:EPDM 70", f"#DECIMAL:{mark}", f"#SEPARATOR:{sign}", "#MTYPE:DMA",
            "#INSTRUMENT:NETZSCH DMA 242", "#SAMPLE:EPDM", "#DATE/TIME:04.11.2024 10:07:12",
            "#SAMPLE LENGTH /mm:5,05", "#RANGE:23°C/0,0(K/min)/23°C", "#SEGMENT:S1/1", "",
        )  # fmt: skip
        return "\n".join(keys)

    names = "##Temp./°C;Time/min;f/Hz;E'/MPa;E''/MPa;tan d"
    columns = (WARM, F / 60, F, STORAGE / 1e6, LOSS / 1e6, TANGENT)
    plain = table(head("COMMA", "SEMICOLON") + "\n" + names, *columns, comma=True, end="\r\n")
    tabbed = table(
        head("POINT", "TAB") + "\n" + names.replace(";", "\t"), *columns, sign="\t", form="%12.6g"
    )
    return [
        Row("Proteus: semicolons, decimal commas", plain.encode("cp1252"), truth=SWEEP),
        Row("Proteus: padded cells between tabs", tabbed.encode("cp1252"), truth=SWEEP),
    ]


def _rheocompass() -> list[Row]:
    def export(sign: str, *, comma: bool, quote: bool, status: bool = True) -> str:
        def line(*cells: str) -> str:
            return sign.join(f'"{c}"' if quote and c else c for c in cells) + "\r\n"

        text = line("Project:", "Door seals") + line("Test:", "Frequency sweep") + "\r\n"
        blocks = zip(("0", "23"), (COLD, 1.0), strict=True)
        last = ("Status",) if status else ()
        for number, (warm, factor) in enumerate(blocks, start=1):
            text += line("Result:", f"seal {number}")
            text += line("Interval and data points:", str(number), str(len(F))) + "\r\n"
            names = ("Point No.", "Temperature", "Frequency", "Storage Modulus", "Loss Modulus",
                     "Loss Factor", "Deflection Angle", "Torque")  # fmt: skip
            text += line("Interval data:", *names, *last) + line(*[""] * (len(names) + 1))
            units = ("", "[°C]", "[Hz]", "[Pa]", "[Pa]", "[1]", "[mrad]", "[mN·m]")
            text += line("", *units, *[""] * len(last))
            for i, f in enumerate(F):
                values = (f, factor * STORAGE[i], factor * LOSS[i], TANGENT[i], 0.4, 12.5)
                cells = [str(i + 1), warm, *(f"{v:.8g}" for v in values)]
                cells = [c.replace(".", ",") for c in cells] if comma else cells
                text += line("", *cells, *(("Dy_auto",) if status else ()))
            text += "\r\n"
        return text

    french = (
        export("\t", comma=True, quote=False)
        .replace("Interval and data points:", "Intervalle et points de données:")
        .replace("Interval data:", "Interval données:")
        .replace("Storage Modulus", "Module de conservation")
        .replace("Loss Modulus", "Module de perte")
        .replace("Frequency", "Fréquence")
        .replace("Temperature", "Température")
    )
    return [
        Row("RheoCompass: UTF-16, decimal commas", export("\t", comma=True, quote=False).encode("utf-16"), truth=ISOTHERMS),
        Row("RheoCompass: UTF-16 without its mark", export("\t", comma=False, quote=False).encode("utf-16-le"), truth=ISOTHERMS),
        Row("RheoCompass: quoted, decimal commas", export(",", comma=True, quote=True).encode("utf-16"), truth=ISOTHERMS),
        Row("RheoCompass: quoted between semicolons", export(";", comma=True, quote=True, status=False).encode(), truth=ISOTHERMS),
        Row("RheoCompass: French", french.encode("utf-16"), truth=ISOTHERMS),
    ]  # fmt: skip


def _rspace() -> list[Row]:
    names = (
        "Action Name;Time (action)(s);Temperature(°C);Frequency(Hz);Complex shear strain(%);"
        "Complex shear modulus(Pa);Phase angle(°)"
    )
    angle = np.degrees(np.arctan(TANGENT))
    label = ["Frequency table"] * len(F)
    columns = (label, F, WARM, F, 0.1 + 0 * F, SIZE, angle)
    parts = table(
        "Action Name,Time (action)(s),Temperature(°C),Frequency(Hz),"
        "Shear modulus (elastic component)(Pa),Shear modulus (viscous component)(Pa)",
        label, F, WARM, F, STORAGE, LOSS, sign=",",
    )  # fmt: skip
    return [
        Row("rSpace: modulus and phase angle", table(names, *columns, form="%.9g").encode("utf-8-sig"), truth=SWEEP),
        Row("rSpace: elastic and viscous component", parts.encode("utf-8-sig"), truth=SWEEP),
        Row("rSpace: decimal commas", table(names, *columns, form="%.9g", comma=True).encode("cp1252"), truth=SWEEP),
    ]  # fmt: skip


def _metravib() -> list[Row]:
    top = "DMA+300\nSpecimen;EPDM 70\nLength;12,5;mm\nDate;04/11/2024\n\n"
    names = (
        "Frequency;Temperature;Dyn. displacement;Dyn. force;E';E'';Tan delta\nHz;°C;µm;N;Pa;Pa;-"
    )
    both = "Frequency;Temperature;E';E'';K';K'';Tan delta\nHz;°C;Pa;Pa;N/m;N/m;-"
    columns = (F, WARM, 10 + 0 * F, 5 + 0 * F, STORAGE, LOSS, TANGENT)
    twice = (F, WARM, STORAGE, LOSS, STORAGE / 40, LOSS / 40, TANGENT)
    return [
        Row("Metravib: moduli", table(top + names, *columns, comma=True).encode("cp1252"), truth=SWEEP),
        Row(
            "Metravib: moduli and stiffnesses", table(top + both, *twice, comma=True).encode("cp1252"),
            "asked", ("could each be the storage",), SWEEP,
            answer={"storage": "E'"},
        ),
    ]  # fmt: skip


def _eplexor() -> list[Row]:
    top = "GABO QUALIMETER EPLEXOR 500N\nProbe: EPDM\nProbengeometrie: Zylinder\n\n"
    names = "Nr.\tTemp.\tFreq.\tstat. Dehnung\tdyn. Dehnung\t|E*|\tE'\tE''\ttan delta"
    units = "\t[°C]\t[Hz]\t[%]\t[%]\t[MPa]\t[MPa]\t[MPa]\t[-]"
    swept = (
        NUMBERS,
        WARM,
        F,
        5 + 0 * F,
        0.1 + 0 * F,
        SIZE / 1e6,
        STORAGE / 1e6,
        LOSS / 1e6,
        TANGENT,
    )
    count = [str(i + 1) for i in range(len(STRAIN))]
    warm = 23 + 0 * STRAIN
    strained = (
        count, warm, 10 + 0 * STRAIN, 5 + 0 * STRAIN, 100 * STRAIN, np.hypot(SOFT, LOST) / 1e6,
        SOFT / 1e6, LOST / 1e6, LOST / SOFT,
    )  # fmt: skip
    head = f"{top}{names}\n{units}"
    return [
        Row("Eplexor: over frequency", table(head, *swept, sign="\t", comma=True).encode("cp1252"), truth=SWEEP),
        Row("Eplexor: over strain", table(head, *strained, sign="\t", comma=True).encode("cp1252"), truth=AMPLITUDES),
    ]  # fmt: skip


def _testxpert() -> list[Row]:
    head = (
        '"Prüfnorm"\t"ISO 3384"\n"Prüfer"\t"Kim"\n"Vorkraft"\t0,5\t"N"\n"Geschwindigkeit"\t8\t"mm/s"\n'
        '"Prüfzeit"\t"Standardweg"\t"Standardkraft"\n"s"\t"mm"\t"N"'
    )
    plain = table(head, TIME, DISPLACEMENT, FORCE, sign="\t", comma=True, end="\r\n")
    two = table(
        '"Prüfzeit";"Traversenweg absolut";"Standardweg";"Standardkraft"\n"s";"mm";"mm";"N"',
        TIME, DISPLACEMENT + 80, DISPLACEMENT, FORCE, comma=True,
    )  # fmt: skip
    polish = table(
        "Próbka;1\nCzas próby;Droga trawersy;Siła standardowa\ns;mm;N",
        TIME,
        DISPLACEMENT,
        FORCE,
        comma=True,
    )
    pulled = table("Wydłużenie względne;Naprężenie\n%;MPa", 100 * PULLED, PULLED**0.8, comma=True)
    return [
        Row("testXpert: German, quoted, units row", plain.encode("cp1252")),
        Row("testXpert: the same in UTF-16", plain.encode("utf-16")),
        Row(
            "testXpert: two ways", two.encode("cp1252"), "asked",
            ("'Traversenweg absolut [mm]' and 'Standardweg [mm]' could each be",),
            answer={"displacement": "Standardweg"},
        ),
        Row("testXpert: Polish", polish.encode("cp1250")),
        Row("testXpert: a Polish tension test", pulled.encode("cp1250"), truth=TENSION),
    ]  # fmt: skip


def _bluehill() -> list[Row]:
    results = (
        '"Results Table 1"\n"","Compressive load at Maximum (N)","Extension at Maximum (mm)"\n'
        '"1","1.90","8.00"\n"Mean","1.90","8.00"\n\n"Raw Data 1"\n"Time","Extension","Load"\n'
        '"(s)","(mm)","(N)"'
    )
    plain = table(results, TIME, DISPLACEMENT, FORCE, sign=",", quote=True, end="\r\n")
    top = 'Próbka : Szybkość;"480,00000";mm/min\nPróbka : Wysokość;"20,00000";mm\n\n'
    polish = table(
        top + "Godzina;Przesunięcie;Obciążenie\n(s);(mm);(N)", TIME, DISPLACEMENT, FORCE,
        comma=True, quote=True, end="\r\n",
    )  # fmt: skip
    german = table(
        '"Kompression","Kompressionslast"\n"(mm)","(N)"', PRESSED, 0.2 * PRESSED,
        sign=",", quote=True, end="\r\n",
    )  # fmt: skip
    universal = table(
        '"Time (s)","Displacement (mm)","Force (kN)","Compressive strain (Displacement) (%)"',
        TIME, DISPLACEMENT, FORCE / 1e3, 5 * DISPLACEMENT, sign=",", form="%.10g", quote=True,
    )  # fmt: skip
    return [
        Row("Bluehill: results before the raw data", plain.encode()),
        Row("Bluehill: Polish", polish.encode("cp1250")),
        Row("Bluehill: a German deflection", german.encode("utf-8-sig"), truth=DEFLECTION),
        Row("Bluehill Universal", universal.encode("utf-8-sig")),
    ]


def _testsuite() -> list[Row]:
    head = "Data Header:\t\t\tTime:\t{:.4f}\tSec\nData Acquisition: Timed\nStation Name: seal.cfg\n"
    names = "Test File Name: seal.tst\nTime\tAxial Force\tAxial Displacement\ns\tN\tmm"

    def block(start: int, stop: int) -> str:
        part = slice(start, stop)
        return table(
            head.format(TIME[start]) + names, TIME[part], FORCE[part], DISPLACEMENT[part], sign="\t"
        )

    blocks = "MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n\n" + block(0, 20) + "\n\n" + block(20, 60)
    elite = table(
        '"Running Time (s)","Axial Displacement (mm)","Axial Force (kN)","Axial Count (cycles)"',
        TIME, DISPLACEMENT, FORCE / 1e3, 0 * TIME, sign=",", form="%.10g",
    )  # fmt: skip
    return [
        Row("TestSuite: blocks of one clock", blocks.encode(), "noted", ("2 segments joined",)),
        Row("TestSuite Elite: one table", elite.encode("utf-8-sig")),
    ]


def _trapezium() -> list[Row]:
    japanese = table(
        '"1 _ 1",,\n"時間","試験力","ストローク"\n"sec","N","mm"',
        TIME,
        FORCE,
        DISPLACEMENT,
        sign=",",
        quote=True,
    )
    korean = table(
        '"1 _ 1",,\n"시간","하중","스트로크"\n"sec","N","mm"', TIME, FORCE, DISPLACEMENT, sign=","
    )
    twice = table(
        '"1 _ 1",,,"1 _ 2",,\n"Czas","Siła","Przemieszczenie","Czas","Siła","Przemieszczenie"\n'
        '"sec","N","mm","sec","N","mm"',
        TIME, FORCE, DISPLACEMENT, TIME + 0.01, 1.02 * FORCE, DISPLACEMENT, sign=",", comma=True, quote=True,
    )  # fmt: skip
    return [
        Row("Trapezium: Japanese", japanese.encode("cp932")),
        Row("Trapezium: Korean", korean.encode("cp949")),
        Row(
            "Trapezium: two specimens, Polish", twice.encode("cp1250"), "asked",
            ("2 sets of columns", "--file-part segment=1"), RAMP, answer={"segment": 1},
        ),
    ]  # fmt: skip


MAKERS = [
    *_trios(), *_proteus(), *_rheocompass(), *_rspace(), *_metravib(), *_eplexor(), *_testxpert(),
    *_bluehill(), *_testsuite(), *_trapezium(),
]  # fmt: skip
