"""Registry rows of binary file formats."""

from dashpot.registry.row import Extension, FileFormat

_FRAMES = (
    "pandas:DataFrame",
    "pandas.core.frame:DataFrame",
    "polars.dataframe.frame:DataFrame",
    "xarray.core.dataset:Dataset",
    "builtins:dict",
)
_COLUMNS = (
    "numpy:ndarray",
    "pandas:Series",
    "pandas.core.series:Series",
    "polars.series.series:Series",
    "xarray.core.dataarray:DataArray",
)
_NO_TABLES = ("builtins:NoneType", "builtins:int", "builtins:float")
EXTENSION = Extension(
    "formats",
    handlers={
        "calibrate": {
            "dashpot.reading.table:FileTable": "dashpot.extensions.formats.ati:add_calibrated_force",
        },
        "adapt table": {
            "dashpot.reading.table:FileTable": "dashpot.extensions.formats.specimens:adapt_table",
        },
        "read": {
            **dict.fromkeys(_FRAMES, "dashpot.extensions.formats.frames:read_frame"),
            **dict.fromkeys(_COLUMNS, "dashpot.extensions.formats.frames:refuse_array"),
            **dict.fromkeys(_NO_TABLES, "dashpot.extensions.formats.frames:refuse_value"),
        },
        "inspect": {
            **dict.fromkeys(_FRAMES, "dashpot.extensions.formats.frames:inspect_frame"),
            **dict.fromkeys(_COLUMNS, "dashpot.extensions.formats.frames:refuse_array"),
            "builtins:object": "dashpot.extensions.formats.frames:refuse_value",
        },
        "make records": dict.fromkeys((*_FRAMES, *_COLUMNS, "builtins:list"), "dashpot.extensions.formats.frames:make_records"),
        "write frf": {
            ".uff": "dashpot.extensions.formats.write_uff:frf_uff",
            ".unv": "dashpot.extensions.formats.write_uff:frf_uff",
        },
    },
    formats=(
        FileFormat("lvm", "dashpot.extensions.formats.lvm", marks=(b"LabVIEW Measurement",)),
        FileFormat("hdf5", "dashpot.extensions.formats.hdf5", marks=(b"\x89HDF\r\n\x1a\n", b"MATLAB 7.3 MAT-file",), sandboxed=True, sheets=True),
        FileFormat("matlab", "dashpot.extensions.formats.matlab", marks=(b"MATLAB 5.0 MAT-file", b"\0\0\0\0"), sandboxed=True),
        FileFormat("tdms", "dashpot.extensions.formats.tdms", marks=(b"TDSm",), sandboxed=True, sheets=True),
        FileFormat("mdf", "dashpot.extensions.formats.mdf", marks=(b"MDF ", b"UnFinMF "), sheets=True),
        FileFormat("wav", "dashpot.extensions.formats.wav", marks=(b"RIFF", b"RIFX", b"RF64", b"BW64"), sandboxed=True),
        FileFormat("arrow", "dashpot.extensions.formats.arrow", marks=(b"PAR1", b"ARROW1", b"\xff\xff\xff\xff"), sandboxed=True),
        FileFormat(
            "unread", "dashpot.extensions.formats.unread",
            marks=(
                b"|CF,", b"\x1f\x8b\x08", b"\x92\x13", b"\x93\x13", b"\x94\x13", b"\x95\x13", b"FEA1",
                b"riff\x2e\x91\xcf\x11", b"fLaC", b"OggS", b"\x93NUMPY", b"\x80\x04\x95", b"\x80\x05\x95",
                b"SQLite format 3", b"MULTI_STREAM_FILE", b"FORMAT\0\0", b"DIAHEAD", b"CDF\x01", b"CDF\x02",
                b"CDF\x05", b"\x0e\x03\x13\x01", b"CPYA ", b"CPYUA ", b"\0\1\0\0Standard", b"$FL2", b"%PDF",
                b"BZh", b"\xfd7zXZ", b"7z\xbc\xaf", b"Rar!", b"\x28\xb5\x2f\xfd",
            ),
        ),
        FileFormat("workbook", "dashpot.extensions.formats.workbook", marks=(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", b"PK\x03\x04",), sheets=True),
        FileFormat("uff", "dashpot.extensions.formats.uff", sandboxed=True),
        FileFormat("trios", "dashpot.extensions.formats.trios", sandboxed=True),
    ),
)  # fmt: skip
