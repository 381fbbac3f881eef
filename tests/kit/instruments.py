"""Small files of each instrument format, made by hand."""

from __future__ import annotations

import struct
import zipfile
from pathlib import Path

import numpy as np

from dashpot.datamodel.frf import FRF, Kind
from kit.look_alikes import truth
from kit.mdf_files import Channel, Group, mdf3, mdf4


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


def workbook(
    path: Path, sheets: dict[str, list[list[object]]], *, body: str = "", strings: str = ""
) -> None:
    """A small xlsx file, written by hand; `body` is XML at the end of every sheet."""
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
    more = body
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as file:
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
                f"<worksheet {main}><sheetData>{body}{more}</sheetData></worksheet>",
            )
        if strings:
            file.writestr("xl/sharedStrings.xml", f"<sst {main}>{strings}</sst>")


def ods(path: Path, rows: str) -> None:
    """An OpenDocument workbook of one sheet, its rows as XML."""
    names = "".join(
        f' xmlns:{name}="urn:oasis:names:tc:opendocument:xmlns:{name}:1.0"'
        for name in ("office", "table", "text")
    )
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as file:
        kind = "application/vnd.oasis.opendocument.spreadsheet"
        file.writestr("mimetype", kind, zipfile.ZIP_STORED)
        file.writestr(
            "META-INF/manifest.xml",
            '<manifest:manifest xmlns:manifest="urn:oasis:names:tc:opendocument:xmlns:manifest:1.0"'
            f'><manifest:file-entry manifest:full-path="/" manifest:media-type="{kind}"/>'
            "</manifest:manifest>",
        )
        file.writestr(
            "content.xml",
            f"<office:document-content{names}><office:body><office:spreadsheet><table:table "
            f'table:name="One">{rows}</table:table></office:spreadsheet></office:body>'
            "</office:document-content>",
        )


def ods_rows(rows: list[list[object]]) -> str:
    """Rows as OpenDocument writes them."""
    out = []
    for row in rows:
        cells = (
            f'<table:table-cell office:value-type="string"><text:p>{cell}</text:p>'
            "</table:table-cell>"
            if isinstance(cell, str)
            else f'<table:table-cell office:value-type="float" office:value="{cell!r}">'
            f"<text:p>{cell!r}</text:p></table:table-cell>"
            for cell in row
        )
        out.append(f"<table:table-row>{''.join(cells)}</table:table-row>")
    return "".join(out)


def xls(path: Path, rows: list[list[object]], *, more: bytes = b"") -> None:
    """A workbook of one sheet as Excel 97 wrote it: BIFF8 records in a compound file.

    `more` is further records of the sheet.
    """

    def record(kind: int, data: bytes) -> bytes:
        return struct.pack("<HH", kind, len(data)) + data

    def begin(what: int) -> bytes:
        return record(0x809, struct.pack("<HHHHII", 0x600, what, 0, 1997, 0, 6))

    cells = b""
    for i, row in enumerate(rows):
        for j, cell in enumerate(row):
            if isinstance(cell, str):
                text = struct.pack("<HB", len(cell), 1) + cell.encode("utf-16-le")
                cells += record(0x204, struct.pack("<HHH", i, j, 0) + text)
            else:
                cells += record(0x203, struct.pack("<HHHd", i, j, 0, float(str(cell))))
    name = struct.pack("<BB", 3, 0) + b"One"
    end = record(0x0A, b"")
    book = begin(5)
    place = len(book) + 4 + 6 + len(name) + len(end)
    book += record(0x85, struct.pack("<IBB", place, 0, 0) + name) + end
    book += begin(0x10) + cells + more + end
    path.write_bytes(_compound(book.ljust(4096, b"\0")))


def _compound(stream: bytes) -> bytes:
    """A compound file with one stream, "Workbook", of at least 4096 bytes."""
    free, end, fat_mark, size = 0xFFFFFFFF, 0xFFFFFFFE, 0xFFFFFFFD, 512
    count = -(-len(stream) // size)
    fats = -(-(count + 2) // 126)
    chain = [*range(1, count), end, end, *[fat_mark] * fats]  # the stream, the folder, the table
    chain += [free] * (fats * 128 - len(chain))
    header = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(16)
    header += struct.pack("<HHHHH6xIIIIIIIII", 0x3E, 3, 0xFFFE, 9, 6, 0, fats, count, 0, 4096,
                          end, 0, end, 0)  # fmt: skip
    places = [*range(count + 1, count + 1 + fats)]
    header += struct.pack("<109I", *places, *[free] * (109 - fats))

    def entry(name: str, kind: int, child: int, start: int, length: int) -> bytes:
        text = name.encode("utf-16-le") + b"\0\0"
        return text.ljust(64, b"\0") + struct.pack(
            "<HBBIII16xI8x8xIQ", len(text), kind, 1, free, free, child, 0, start, length
        )

    folder = entry("Root Entry", 5, 1, end, 0) + entry("Workbook", 2, free, 0, len(stream))
    table = struct.pack(f"<{len(chain)}I", *chain)
    return header + stream.ljust(count * size, b"\0") + folder.ljust(size, b"\0") + table


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
    named = (("hammer", 13, labels[0]), ("response", 12, labels[1]))
    for scale, (name, kind, label) in enumerate(named, start=1):
        sets.append(
            {**common, "data": scale * np.arange(30.0), "ordinate_spec_data_type": kind,
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
        units="SI",
    )


def write_format_examples(folder: Path) -> dict[str, bytes]:
    """One small file of each format that is not delimited text."""
    import h5py
    import polars as pl
    from scipy.io import savemat, wavfile

    from dashpot.extensions.formats.write_uff import frf_uff

    tdms(folder / "tdms", hits=2)
    (folder / "uff frf").write_bytes(frf_uff(frf(n=10)))
    uff(folder / "uff", labels=("N", "g"), length=1000.0)
    workbook(folder / "xlsx", {"One": sheet()[:12], "Two": [["a", 1.0]]})
    ods(folder / "ods", ods_rows(sheet()[:12]))
    xls(folder / "xls", sheet()[:12])
    arrays = {"time_s": np.arange(9.0), "force_N": np.arange(9.0)}
    savemat(folder / "mat", {**arrays, "s": {"data": np.eye(3), "unit": "mm"}, "c": [1j, "a"]})
    savemat(folder / "mat packed", arrays, do_compression=True)
    savemat(folder / "mat 4", arrays, format="4")
    with h5py.File(folder / "hdf5", "w") as file:
        for name, values in arrays.items():
            file.create_dataset(f"run/{name}", data=values, compression=1).attrs["unit"] = "s"
        file["run"].attrs["columns"] = ["a", "b"]
    with h5py.File(folder / "hdf5 links", "w") as file:
        file["run/data"] = np.eye(3)
        file["run/data"].attrs["names"] = ["a", "b", "c"]
        file["run/unit"] = "mm"
        file["run/self"] = file
        file["run/soft"] = h5py.SoftLink("/run/data")
        file["run/other"] = h5py.ExternalLink("other.h5", "/a")
        file["records"] = np.array([(1, 2.0)] * 3, [("a", "i4"), ("b", "f8")])
    made = [
        Channel("time", np.arange(9.0), "s", kind=2, sync=1),
        Channel("force", np.arange(9.0), "N"),
    ]
    (folder / "mdf").write_bytes(mdf4([Group(made)], how="HL"))
    (folder / "mdf unsorted").write_bytes(mdf4([Group(made), Group(made, "b", 1)], id_size=1))
    (folder / "mdf 3").write_bytes(mdf3(made))
    wavfile.write(folder / "wav", 100, np.eye(5))
    frame = pl.DataFrame(arrays)
    frame.write_parquet(folder / "parquet")
    frame.write_ipc(folder / "arrow")
    (folder / "lvm").write_text(lvm(segments=2))
    (folder / "lvm clocks").write_text(lvm(x_columns="Multi", decimal=","))
    return {path.name: path.read_bytes() for path in folder.iterdir()}
