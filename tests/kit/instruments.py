"""Small files of each instrument format, made by hand."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np

from dashpot.records.frf import FRF, Kind
from kit.look_alikes import truth


def lvm(
    *, decimal: str = ".", x_columns: str = "No", segments: int = 1, units: str = "N\tm/s^2",
    samples: int = 20, rows: int = 20, step: str = "1.000000E-3", comment: str = "",
) -> str:  # fmt: skip
    """A LabVIEW measurement of a hammer and an accelerometer."""
    top = (
        "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\n"
        f"Decimal_Separator\t{decimal}\nMulti_Headings\tYes\nX_Columns\t{x_columns}\n"
        "Time_Pref\tAbsolute\nDate\t2024/01/05\nTime\t09:51:39.197\n***End_of_Header***\t\n\t\n"
    )
    text = top
    for k in range(segments):
        blank = "\t" if x_columns == "Multi" else ""
        text += (
            f"Channels\t2\t\t\t\nSamples\t{samples}\t{blank}{samples}\t\nDate\t2024/01/05\t\t\n"
            f"Y_Unit_Label\t{units}\t\nX_Dimension\tTime\t{blank}Time\t\n"
            f"X0\t0.0000000000000000E+0\t{blank}0.0\t\nDelta_X\t{step}\t{blank}{step}\t\n"
            "***End_of_Header***\t\t\t\n"
        ).replace(".", decimal)
        names = "X_Value\tHammer\tX_Value\tResponse" if blank else "X_Value\tHammer\tResponse"
        text += f"{names}\tComment\n"
        for i in range(rows):
            clock = f"{1e-3 * i:.6f}" if x_columns != "No" else ""
            cells = [clock, f"{i + 100 * k:.6f}", *([clock] if blank else []), f"{-i:.6f}"]
            text += "\t".join(cells).replace(".", decimal) + (f"\t{comment}\n" if comment else "\n")
        text += "\n"
    return text


def tdms(path: Path, offsets: tuple[float, float] = (0.0, 0.0), hits: int = 1) -> None:
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(str(path)) as writer:
        for k in range(hits):
            channels = []
            for name, unit, offset, sign in zip(
                ("Hammer", "Response"), ("N", "m/s^2"), offsets, (1, -1), strict=True
            ):
                instants = offset + 1e-3 * np.arange(50)
                properties = {"wf_increment": 1e-3, "wf_start_offset": offset, "unit_string": unit}
                channels.append(
                    ChannelObject(
                        f"Hit {k + 1}", name, sign * instants * 1e3, properties=properties
                    )
                )
            writer.write_segment(channels)


def workbook(path: Path, sheets: dict[str, list[list[object]]]) -> None:
    """A small xlsx file, written by hand."""
    space = "http://schemas.openxmlformats.org"
    kinds = "".join(
        f'<Override PartName="/xl/worksheets/sheet{i + 1}.xml" ContentType="application/'
        'vnd.openxmlformats-officedocument.spreadsheetml.worksheet+xml"/>'
        for i in range(len(sheets))
    )
    names = "".join(
        f'<sheet name="{n}" sheetId="{i + 1}" r:id="rId{i + 1}"/>' for i, n in enumerate(sheets)
    )
    links = "".join(
        f'<Relationship Id="rId{i + 1}" Type="{space}/officeDocument/2006/relationships/worksheet" '
        f'Target="worksheets/sheet{i + 1}.xml"/>'
        for i in range(len(sheets))
    )
    relations = f'<Relationships xmlns="{space}/package/2006/relationships">'
    main = f'xmlns="{space}/spreadsheetml/2006/main"'
    with zipfile.ZipFile(path, "w") as file:
        file.writestr(
            "[Content_Types].xml",
            f'<Types xmlns="{space}/package/2006/content-types"><Default Extension="rels" '
            'ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Override '
            'PartName="/xl/workbook.xml" ContentType="application/vnd.openxmlformats-officedocument'
            f'.spreadsheetml.sheet.main+xml"/>{kinds}</Types>',
        )
        file.writestr(
            "_rels/.rels",
            f'{relations}<Relationship Id="rId1" Type="{space}/officeDocument/2006/relationships/'
            'officeDocument" Target="xl/workbook.xml"/></Relationships>',
        )
        file.writestr(
            "xl/workbook.xml",
            f'<workbook {main} xmlns:r="{space}/officeDocument/2006/relationships"><sheets>{names}'
            "</sheets></workbook>",
        )
        file.writestr("xl/_rels/workbook.xml.rels", f"{relations}{links}</Relationships>")
        for i, rows in enumerate(sheets.values()):
            body = "".join(
                "<row>" + "".join(
                    f'<c t="inlineStr"><is><t>{cell}</t></is></c>' if isinstance(cell, str)
                    else f"<c><v>{cell!r}</v></c>"
                    for cell in row
                ) + "</row>"
                for row in rows
            )  # fmt: skip
            file.writestr(
                f"xl/worksheets/sheet{i + 1}.xml",
                f"<worksheet {main}><sheetData>{body}</sheetData></worksheet>",
            )


def sheet() -> list[list[object]]:
    rows = [list(map(float, row)) for row in zip(*truth(), strict=True)]
    return [["Prüfung"], ["Zeit", "Weg", "Kraft"], ["s", "mm", "N"], *rows]


def uff(path: Path, *, labels: tuple[str, str], length: float | None) -> None:
    """A hammer and an accelerometer as time records, with or without dataset 164."""
    import pyuff

    common = {
        "type": 58, "binary": 0, "func_type": 1, "x": 1e-3 * np.arange(30), "rsp_node": 1,
        "rsp_dir": 3, "ref_node": 1, "ref_dir": 3, "abscissa_spec_data_type": 17,
        "abscissa_axis_lab": "Time", "abscissa_axis_units_lab": "s",
        "orddenom_spec_data_type": 0, "z_axis_spec_data_type": 0, "ord_data_type": 4,
        "num_pts": 30, "abscissa_spacing": 1, "abscissa_min": 0.0, "abscissa_inc": 1e-3,
        "id1": "hit", "id2": "NONE", "id3": "NONE", "id4": "NONE", "id5": "NONE",
    }  # fmt: skip
    sets = []
    if length is not None:
        sets.append(
            pyuff.prepare_164(units_code=9, units_description="user", temp_mode=1, length=length,
                              force=1.0, temp=1.0, temp_offset=0.0)
        )  # fmt: skip
    for name, kind, label in (("hammer", 13, labels[0]), ("response", 12, labels[1])):
        sets.append(
            {**common, "data": np.arange(30.0), "ordinate_spec_data_type": kind,
             "ordinate_axis_lab": name, "ordinate_axis_units_lab": label}
        )  # fmt: skip
    pyuff.UFF(str(path)).write_sets(sets, mode="overwrite")


def frf(kind: Kind = Kind.ACCELERANCE, *, measured: bool = True, n: int = 40) -> FRF:
    rng = np.random.default_rng(3)
    return FRF(
        np.linspace(1.0, 40.0, n),
        rng.normal(size=n) + 1j * rng.normal(size=n),
        kind,
        coherence=rng.uniform(size=n) if measured else None,
        sd=rng.uniform(size=n) if measured else None,
        shift=0.25 if measured else 0.0,
        record=8.0 if measured else None,
        averages=5 if measured else 0,
    )
