"""What the programs of small makers, and of those who write to a logger, export.

Written before they were read. Mecmesin, Testometric, Lloyd, Hegewald & Peschke, Galdabini, LabVIEW,
Dewesoft, catman, Simcenter ASCII, and headers as their users type them.
"""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

import numpy as np

from kit.crafted.row import (
    ACCELERANCE,
    LINES,
    LOSS,
    OVER_BASE,
    OVER_FORCE,
    STORAGE,
    SWEEP,
    TANGENT,
    TRANSMISSIBILITY,
    F,
    Row,
    table,
)
from kit.look_alikes import truth

TIME, DISPLACEMENT, FORCE = truth()
NUMBERS = np.arange(1.0, 1 + len(TIME))
OUNCE = 0.27801385095378125


def _testers() -> list[Row]:
    mecmesin = table(
        "VectorPro,2.5.0\nTest name,Seal compression\nOperator,Lab 2\nUnits,N,mm,s\n\nTime (s),Load (N),Displacement (mm)",
        TIME, FORCE, DISPLACEMENT, sign=",",
    )  # fmt: skip
    emperor = table(
        "Emperor (TM) Force\nSample No. 1\n\nLoad\tDisplacement\tTime\n(N)\t(mm)\t(Sec)",
        FORCE, DISPLACEMENT, TIME, sign="\t",
    )  # fmt: skip
    testometric = table(
        '"winTest Analysis"\n"Test No","1"\n"Force @ Peak","1.900","N"\n"Time (Secs)","Force (N)","Def. (mm)"',
        TIME, FORCE, DISPLACEMENT, sign=",", quote=True,
    )  # fmt: skip
    lloyd = table(
        "NEXYGENPlus Data\nBatch Ref.:\tS12\nSample 1\nTime\tLoad\tMachine Extension\ns\tN\tmm\n",
        TIME, FORCE, DISPLACEMENT, sign="\t",
    )  # fmt: skip
    hegewald = table(
        "Prüfung;Druckversuch Dichtung\nDatum;12.03.2024\nProbe;3\n\nPrüfzeit;Prüfkraft;Traversenweg\n[s];[N];[mm]",
        TIME, FORCE, DISPLACEMENT, sign=";", comma=True, end="\r\n",
    )  # fmt: skip
    galdabini = table(
        "Labtest 5;Prova n. 4\nCliente;\nTempo (s);Carico (N);Spostamento (mm)",
        TIME, FORCE, DISPLACEMENT, sign=";", comma=True,
    )  # fmt: skip
    inspekt = table(
        "Zeit in s;Standardweg in mm;Standardkraft in N;Zyklus",
        TIME, DISPLACEMENT, FORCE, 1 + 0 * TIME, sign=";", comma=True,
    )  # fmt: skip
    mark10 = table(
        "IntelliMESUR\nReading,Load [ozF],Travel [mm],Time [s]", NUMBERS, FORCE / OUNCE, DISPLACEMENT, TIME,
        sign=",", form="%.10g",
    )  # fmt: skip
    imada = table(
        "Force Recorder\nNo.,Time(s),Force(N),Disp(mm)", NUMBERS, TIME, FORCE, DISPLACEMENT, sign=",",
    )  # fmt: skip
    texture = table(
        "Exponent Connect\nForce\tDistance\tTime\ng\tmm\tsec",
        FORCE / 9.80665e-3, DISPLACEMENT, TIME, sign="\t", form="%.10g",
    )  # fmt: skip
    return [
        Row("VectorPro", mecmesin.encode()),
        Row("Emperor: units in a row of their own", emperor.encode()),
        Row("winTest: quoted, with the peak above", testometric.encode()),
        Row("NEXYGENPlus: a blank line below the units", lloyd.encode()),
        Row("LabMaster: German", hegewald.encode("cp1252")),
        Row("Labtest: Italian", galdabini.encode()),
        Row("LabMaster: names with in", inspekt.encode()),
        Row("IntelliMESUR: ounces of force", mark10.encode()),
        Row("Force Recorder", imada.encode()),
        Row(
            "Exponent: grams", texture.encode(), "asked", ("g",), answer={"units": {"force": "gf"}}
        ),
    ]


def _loggers() -> list[Row]:
    labview = table(
        "Time (s)\tPlot 0 [mm]\tPlot 1 [N]", TIME, DISPLACEMENT, FORCE, sign="\t", comma=True, end="\r\n",
    )  # fmt: skip
    express = table(
        "waveform\t[0]\t[1]\nt0\t12.03.2024 10:00:00\t12.03.2024 10:00:00\ndelta t\t0,100000\t0,100000\n\ntime[s]\tWeg[mm]\tKraft[N]",
        TIME, DISPLACEMENT, FORCE, sign="\t", comma=True,
    )  # fmt: skip
    dewesoft = table(
        "Export time: 12.03.2024 10:00:00\nSample rate: 10 Hz\n\nTime (s);Weg (mm);Kraft (N)",
        TIME, DISPLACEMENT, FORCE, sign=";", comma=True,
    )  # fmt: skip
    statistics = table(
        "Time[s]\tForce/AVE[N]\tWay/AVE[mm]", TIME, FORCE, DISPLACEMENT, sign="\t",
    )  # fmt: skip
    catman = table(
        "HBM_CATMAN_DATAFILE_40\n\nZeit  1 - Standardmessrate [s]\tKraft [N]\tWeg [mm]",
        TIME, FORCE, DISPLACEMENT, sign="\t", comma=True,
    )  # fmt: skip
    packed = table(
        "t/ms  s/µm  F/mN", TIME * 1e3, DISPLACEMENT * 1e3, FORCE * 1e3, sign="  ", form="%.9g"
    )
    slashed = table("t/s;s/mm;F/N", TIME, DISPLACEMENT, FORCE, sign=";")
    commented = table(
        "# time: s\n# displacement: mm\n# force: N", TIME, DISPLACEMENT, FORCE, sign=" "
    )
    numbered = table(
        "# column 1: time [s]\n# column 2: displacement [mm]\n# column 3: force [N]", TIME, DISPLACEMENT, FORCE, sign=" ",
    )  # fmt: skip
    simcenter = table(
        'Function type: FRF\nX axis: Frequency, Hz\n"Frequency (Hz)"\t"Real (m/s^2/N)"\t"Imag (m/s^2/N)"',
        LINES, OVER_FORCE.real, OVER_FORCE.imag, sign="\t", form="%.9g",
    )  # fmt: skip
    ratio = table(
        "Frequency [Hz];Amplitude Mass/Base [g/g];Phase Mass/Base [°]",
        LINES, np.abs(OVER_BASE), np.angle(OVER_BASE, deg=True), sign=";", form="%.9g",
    )  # fmt: skip
    return [
        Row("LabVIEW: plots", labview.encode("cp1252")),
        Row("LabVIEW: waveforms", express.encode("cp1252")),
        Row("Dewesoft: German", dewesoft.encode()),
        Row("Dewesoft: averages", statistics.encode()),
        Row("catman: the rate in the name of the clock", catman.encode("cp1252")),
        Row("symbols over units, between blanks", packed.encode()),
        Row("symbols over units, between semicolons", slashed.encode()),
        Row("a comment for each column", commented.encode()),
        Row("a numbered comment for each column", numbered.encode()),
        Row("Simcenter: an FRF", simcenter.encode(), truth=ACCELERANCE),
        Row("Simcenter: a transmissibility", ratio.encode(), truth=TRANSMISSIBILITY),
    ]


def _sweeps() -> list[Row]:
    dynatest = table(
        "Freq.[Hz];E'[N/mm²];E''[N/mm²];tanD[-]", F, STORAGE / 1e6, LOSS / 1e6, TANGENT, sign=";",
        comma=True,
    )  # fmt: skip
    perkin = table(
        "Pyris\n\nFrequency\tStorage Modulus E'\tLoss Modulus E''\tTan d\nHz\tPa\tPa\t", F, STORAGE, LOSS, TANGENT,
        sign="\t",
    )  # fmt: skip
    mettler = table(
        "Index f         M'          M''         tan(delta)\n      [Hz]      [MPa]       [MPa]       []",
        np.arange(1.0, 1 + len(F)), F, STORAGE / 1e6, LOSS / 1e6, TANGENT, sign="   ",
    )  # fmt: skip
    hitachi = table(
        "Freq(Hz),E'(Pa),E\"(Pa),tanD", F, STORAGE, LOSS, TANGENT, sign=",",
    )  # fmt: skip
    return [
        Row("DYNATEST: German", dynatest.encode("cp1252"), truth=SWEEP),
        Row("Pyris: no unit for the last", perkin.encode(), truth=SWEEP),
        Row("STARe: an index, empty brackets", mettler.encode(), truth=SWEEP),
        Row("a quote for two primes", hitachi.encode(), truth=SWEEP),
    ]


SMALL_MAKERS = [*_testers(), *_loggers(), *_sweeps()]
