"""Look-alikes of what test machines write: one ramp and hold, in many dialects."""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

from kit.crafted.row import Row
from kit.look_alikes import table, truth


def _zwick() -> str:
    head = '"Prüfinstitut"\t"Institut"\n"Datum/Uhrzeit"\t44335.4\t""\n"Messlänge"\t80\t"mm"\n'
    names = '"Prüfzeit"\t"Standardkraft"\t"Standardweg"\n"s"\t"N"\t"mm"\n'
    time, displacement, force = truth()
    return head + names + table("\t", columns=(time, force, displacement))


def _bluehill(unit: str = "N") -> str:
    head = "".join(
        f'Próbka : {word};"{value}";{u}\r\n'
        for word, value, u in (("Szybkość", "15,00000", "mm/min"), ("Szerokość", "20,00000", "mm"))
    )
    names = f"\r\nGodzina;Przemieszczenie;Obciążenie\r\n(s);(mm);({unit})\r\n"
    return head + names + table(";", decimal=",", quote=True, end="\r\n")


def _wavematrix() -> str:
    names = '"Gesamtzeit (s)";"Weg(8800 (0:1):Weg) (mm)";"Last(8800 (0:3):Last) (N)";\r\n'
    return names + table(";", decimal=",", tail=";", end="\r\n")


def _chinese() -> str:
    return "试验日期,2024-01-05\n试样编号,A1\n时间(s),位移(mm),力(N)\n" + table(",")


def _format_padded_table() -> str:
    head = "$ Prüfung an Stück 7\n$ Temperatur 23 °C\n$ Zeit [s]  Weg [mm]  Kraft [N]\n"
    return head + table("", pad=14)


DIALECTS = [
    Row("plain", ("time [s],displacement [mm],force [N]\n" + table(",")).encode()),
    Row("parentheses", ("Time (s), Displacement (mm), Force (N)\n" + table(", ")).encode()),
    Row("units row", ("Time;Weg;Kraft\ns;mm;N\n" + table(";", decimal=",")).encode()),
    Row("bracketed units row", ("Time\tPosition\tLoad\n[s]\t[mm]\t[N]\n" + table("\t")).encode()),
    Row("slash", ("Zeit / s;Weg / mm;Kraft / N\n" + table(";", decimal=",")).encode("cp1252")),
    Row("in", ("Time in s|Stroke in mm|Force in N\n" + table("|")).encode()),
    Row("bom", b"\xef\xbb\xbf" + ("t [s];x [mm];F [N]\n" + table(";")).encode()),
    Row("utf-16", ("Zeit [s]\tWeg [mm]\tKraft [N]\r\n" + table("\t", end="\r\n")).encode("utf-16")),
    Row("utf-16-be bare", ("Zeit [s]\tWeg [mm]\tKraft [N]\n" + table("\t")).encode("utf-16-be")),
    Row("zwick", _zwick().encode()),
    Row("zwick latin-1", _zwick().encode("cp1252")),
    Row("bluehill polish cp1250", _bluehill().encode("cp1250")),
    Row("bluehill polish utf-8", _bluehill().encode()),
    Row("wavematrix german", b"\xef\xbb\xbf" + _wavematrix().encode()),
    Row("matlab mangled", ("TotalTime_s_,Position__mm_,Load_8800_0_3__Load__N_\n" + table(",")).encode()),
    Row("underscores", ("Zeit_s;Weg_mm;Kraft_N\n" + table(";")).encode()),
    Row("cr cr lf", ("Time (s),Displacement (mm),Load (N)\r\r\n" + table(",", end="\r\r\n")).encode()),
    Row("old mac", ("Time (s),Displacement (mm),Load (N)\r" + table(",", end="\r")).encode()),
    Row("chinese gbk", _chinese().encode("gb18030")),
    Row("chinese utf-8", _chinese().encode()),
    Row("fixed width", _format_padded_table().encode("latin-1")),
    Row("comment header", ("# time [s] displacement [mm] force [N]\n" + table(" ")).encode()),
    Row("percent comment", ("% simulated\n% t (s)\tx (mm)\tF (N)\n" + table("\t")).encode()),
    Row("labelled comment", ("# columns: t x F\n# units: s mm N\n" + table(" ")).encode()),
    Row("french", ("Temps (s);Déplacement (mm);Effort (N)\n" + table(";", decimal=",")).encode("cp1252")),
    Row("turkish", ("Süre (s);Yer değiştirme (mm);Kuvvet (N)\n" + table(";", decimal=",")).encode("cp1254")),
    Row("russian", ("Время, с;Перемещение, мм;Усилие, Н\n" + table(";", decimal=",")).encode("cp1251")),
    Row("japanese", ("時間(s),変位(mm),荷重(N)\n" + table(",")).encode("cp932")),
    Row("spanish", ("Tiempo (s);Desplazamiento (mm);Fuerza (N)\n" + table(";", decimal=",")).encode()),
    Row("italian", ("Tempo [s];Spostamento [mm];Forza [N]\n" + table(";", decimal=",")).encode()),
    Row("leading delimiter", ("\tTime (s)\tExtension (mm)\tLoad (N)\n" + table("\t", lead="\t")).encode()),
    Row("trailing delimiters", ("Time;Way;Load;;\ns;mm;N;;\n" + table(";", tail=";;")).encode()),
    Row("quoted comma", ('"Time (s)","Position (mm)","Load (N)"\n' + table(",", decimal=",", quote=True)).encode()),
    Row("semicolon comment", ("; exported\n;Time [s],Displacement [mm],Force [N]\n" + table(",")).encode()),
    Row("blank lines", ("Time (s),Extension (mm),Load (N)\n\n" + table(",").replace("\n", "\n\n")).encode()),
    Row("unit names spelled", ("Time (seconds),Displacement (millimeters),Force (Newtons)\n" + table(",")).encode()),
    Row("mts", ("Data Header: Time Data\nAxial Displacement \tAxial Force \tRunning Time \t\nmm\tN\tSec\t\n" + table("\t", columns=(truth()[1], truth()[2], truth()[0]), tail="\t")).encode()),
    Row("colon units", ("Time:s,Displacement:mm,Force:N\n" + table(",")).encode()),
    Row("footer", ("Time (s),Displacement (mm),Load (N)\n" + table(",") + "\nEnd of test\nMaximum,8.0,1.9\n").encode()),
    Row("index row", ("No,Time (s),Displacement (mm),Load (N)\n" + "".join(f"{i + 1},{row}\n" for i, row in enumerate(table(",").splitlines()))).encode()),
    Row("status column", ("Time (s);Position (mm);Load (N);Status\n" + table(";", decimal=",", tail=";OK")).encode()),
    Row("date and clock", ("Date;Time (s);Position (mm);Load (N)\n" + "".join(f"2024-01-05;{row}\n" for row in table(";").splitlines())).encode()),
    Row("short names", ("t_s,x_mm,F_N\n" + table(",")).encode()),
    Row("symbols", ("Zeit t [s];Weg s [mm];Kraft F [N]\n" + table(";", decimal=",")).encode()),
    Row("no blank before unit", ("t[s];z[mm];Fz[N]\n" + table(";")).encode()),
    Row("axis names", ("Time [s]\tz-position [mm]\tF_z [N]\n" + table("\t")).encode()),
    Row("excel sep line", ("sep=;\nTime (s);Extension (mm);Load (N)\n" + table(";", decimal=",")).encode()),
    Row("dashes under names", ("Time (s)  Stroke (mm)  Force (N)\n--------  -----------  ---------\n" + table("", pad=12)).encode()),
    Row("units above names", ("s;mm;N\nTime;Displacement;Force\n" + table(";")).encode()),
    Row("full-width brackets", ("时间（秒）,位移（毫米）,载荷（牛）\n" + table(",")).encode("gb18030")),
    Row("typeset minus", ("Time (s);Extension (mm);Load (N)\n" + table(";").replace("0.00000;0.00000;0.00000", "\u22120.0;0.0;0.0", 1)).encode()),
    Row("two clocks", ("Total Time (s);Cycle Elapsed Time (s);Position (mm);Load (N)\n" + table(";", columns=(truth()[0], truth()[0] % 1, *truth()[1:]))).encode()),
    Row("command beside signal", ("Time (s);Displacement Command (mm);Displacement (mm);Load (N)\n" + table(";", columns=(truth()[0], truth()[1] + 1, *truth()[1:]))).encode()),
    Row("many columns", ("Time (s);Temp (°C);Load (N);Extension (mm);Tensile strain (%);Stress (MPa);Speed (mm/s)\n" + table(";", columns=(truth()[0], truth()[0], truth()[2], truth()[1], truth()[1], truth()[2], truth()[0]))).encode("cp1252")),
    Row("clock times", ("Time;Weg [mm];Kraft [N]\n" + "".join(f"00:00:{t:08.5f};{x:.5f};{f:.5f}\n" for t, x, f in zip(*truth(), strict=True))).encode()),
    Row("korean", ("시간(s),변위(mm),하중(N)\n" + table(",")).encode("cp949")),
    Row("czech", ("Čas [s];Dráha [mm];Síla [N]\n" + table(";", decimal=",")).encode("cp1250")),
    Row("portuguese", ("Tempo (s);Deslocamento (mm);Força (N)\n" + table(";", decimal=",")).encode("cp1252")),
    Row("dutch", ("Tijd (s);Verplaatsing (mm);Kracht (N)\n" + table(";", decimal=",")).encode()),
    Row("numbers in the header", ("Sample,3\nLength,100,mm\nSpeed,8,mm/s\nTime (s),Extension (mm),Load (N)\n" + table(",")).encode()),
    Row("long header", ("".join(f"# setting.{i}: {i}\n" for i in range(3000)) + "# time [s], displacement [mm], force [N]\n" + table(",")).encode()),
    Row("thousands", ('"Time (s)","Extension (mm)","Load (N)","Microstrain"\n' + "".join(f'"{t:.5f}","{x:.5f}","{f:.5f}","1,{i:03d}.50"\n' for i, (t, x, f) in enumerate(zip(*truth(), strict=True)))).encode()),
    Row("mixed marks", ("Time [s];Weg [mm];Kraft [N]\n" + "".join(f"{t:.5f};{x:.5f};{f:.5f}\n".replace(".", ",", 1) for t, x, f in zip(*truth(), strict=True))).encode()),
    Row("exponents", ("Time (s)\tExtension (m)\tLoad (kN)\n" + "".join(f"{t:.6E}\t{x * 1e-3:.9E}\t{f * 1e-3:+.9E}\n" for t, x, f in zip(*truth(), strict=True))).encode()),
    Row("fortran exponents", ("Time (s)  Extension (mm)  Load (N)\n" + "".join(f"{t:.9E} {x:.9E} {f:.9E}\n".replace("E", "D") for t, x, f in zip(*truth(), strict=True))).encode()),
    Row("inches and pounds", ("Time (min),Extension (in),Load (lbf)\n" + "".join(f"{t / 60:.12f},{x / 25.4:.15f},{f / 4.4482216152605:.15f}\n" for t, x, f in zip(*truth(), strict=True))).encode()),
    Row("milli", ("Time (ms);pos (µm);F (mN)\n" + "".join(f"{t * 1e3:.2f};{x * 1e3:.2f};{f * 1e3:.2f}\n" for t, x, f in zip(*truth(), strict=True))).encode("cp1252")),
    Row("fixed width with blanks", ("Time (s)    Temp (C)       Position (mm)  Load (N)\n" + "".join(f"{t:10.5f}  {20.0 if i % 10 == 0 else '':>8}     {x:12.5f}   {f:10.5f}\n" for i, (t, x, f) in enumerate(zip(*truth(), strict=True)))).encode()),
    Row("apostrophes", ("Zeit [ms];Weg [µm];Kraft [mN]\n" + "".join(f"{t * 1e3:,.2f};{x * 1e3:,.2f};{f * 1e3:,.2f}\n".replace(",", "'") for t, x, f in zip(*truth(), strict=True))).encode()),
    Row("german thousands", ("Zeit [ms];Weg [µm];Kraft [mN]\n" + "".join(f"{t * 1e3:,.2f};{x * 1e3:,.2f};{f * 1e3:,.2f}\n".translate(str.maketrans(",.", ".,")) for t, x, f in zip(*truth(), strict=True))).encode("cp1252")),
    Row("iso date times", ("timestamp,position_mm,load_N\n" + "".join(f"1970-01-01T00:00:{t:09.6f},{x:.5f},{f:.5f}\n" for t, x, f in zip(*truth(), strict=True))).encode()),
    Row("unit before name", ("[s] Time,[mm] Position,[N] Load\n" + table(",")).encode()),
    Row("three header rows", ("Sensor;Clock;LVDT 1;Cell 2\nChannel;Time;Displacement;Force\nUnit;s;mm;N\n" + "".join(f"{i + 1};{row}\n" for i, row in enumerate(table(";").splitlines()))).encode()),
    Row("catman", ("HBM_CATMAN_DATAFILE_40;;;\n;;;\nKanal 0;Kanal 1;Kanal 2;\nZeit;Wegaufnehmer;Kraftaufnehmer;\ns;mm;N;\n" + table(";", decimal=",", tail=";")).encode()),
    Row("results before raw data", ('"Results Table"\n\n"","Maximum Load (N)","Extension at max (mm)"\n"1","1.93","8.0"\n\n"Raw Data"\n"Time","Extension","Load"\n"(s)","(mm)","(N)"\n' + table(",", quote=True)).encode()),
    Row("nul padded", ("Time (s),Position (mm),Load (N)\n" + table(",")).encode() + b"\0" * 100),
    Row("clock with a units row", ("Uhrzeit;Weg;Kraft\nhh:mm:ss;mm;N\n" + "".join(f"00:00:{t:08.5f};{x:.5f};{f:.5f}\n" for t, x, f in zip(*truth(), strict=True))).encode()),
    Row("six units for five names", ("Time,Force,Displacement,Mold opening,Temp\r\r\ns,N,mm,mm,C,-\r\r\n" + table(",", columns=(truth()[0], truth()[2], truth()[1], truth()[1] + 1, truth()[0]), end="\r\r\n")).encode()),
    Row("tags round the data", ("<INFO>\nDate:\t01\n<DATA>\nTime, s\tPosition (z), mm\tFz, N\n" + table("\t") + "<END DATA>\n").encode()),
]  # fmt: skip
