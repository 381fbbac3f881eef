"""Public functions that read records and results from files and save them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from inspect import signature
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypedDict, TypeVar

from dashpot.api import refuse_wrong_options, show_typed_keywords
from dashpot.base.errors import DataError, ReadError
from dashpot.base.result_mixins import load_function
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.specimen import Specimen
from dashpot.reading.columns.file_kinds import get_kind_label
from dashpot.reading.read_options import ReadOptions, load_profile
from dashpot.reading.readers.detect_kind import describe_unknown_test, recognise
from dashpot.registry import KINDS, find_handler, load_object, require_handler

if TYPE_CHECKING:
    from dashpot.workflow.inspections import InspectedFile

Place: TypeAlias = str | Path
Column: TypeAlias = str | int | Sequence[str | int]
N = TypeVar("N")


class ReadOptionKeywords(TypedDict, total=False):
    """Keyword arguments of `read`: the reading options of the command line.

    Attributes
    ----------
    columns : mapping of str to str or int
        The column of a role, by name or number: ``{"force": "Kraft"}``.
    units : mapping of str to str
        The unit of a role or a column: ``{"force": "N"}``.
    text, part : mapping
        ``delimiter``, ``decimal``, ``encoding``, ``skip``; ``segment``, ``cycle``, ``sheet``.
    rate : float or str
        Sampling rate, Hz, of a file without a clock.
    window_decay : float or str
        Time constant, s, of an exponential window that hits or an FRF carry; 0 if there is none.
    calibration : path
        File of a six-axis transducer, with `axis`.
    profile : path
        Reading options saved by ``dashpot inspect --save``.
    specimen : Specimen
    test : str
        For stress over strain: ``"uniaxial"``, ``"compression"``, ``"biaxial"``, ``"planar"`` or
        ``"volumetric"``.
    mass, radius, radius_error, drop_height, impact_velocity : float or str
        Data of an indenter.
    role : str
        For a blank test: ``"stop"``, ``"spring"`` or ``"empty"``.
    """

    columns: Mapping[str, Column]
    units: Mapping[str, str]
    text: Mapping[str, Any]
    part: Mapping[str, Any]
    rate: Quantity
    window_decay: Quantity
    calibration: Place
    axis: str
    profile: Place
    specimen: Specimen
    test: str
    mass: Quantity
    radius: Quantity
    radius_error: Quantity
    drop_height: Quantity
    impact_velocity: Quantity
    role: str


_MAPPINGS = {
    "columns": '{"force": "Kraft"}',
    "units": '{"time": "s", "displacement": "mm", "force": "N"}',
    "text": '{"decimal": ","}',
    "part": '{"sheet": 2}',
}
"""Keywords that are mappings, with an example of each."""
_TEXT = {"skip": "skip_rows"}
_CONVERTERS: Mapping[str, Callable[[Any], Any]] = {
    "units": dict,
    "axis": str,
    "calibration": str,
    "rate": lambda rate: convert_to_si(rate, "frequency"),
    "window_decay": lambda decay: convert_to_si(decay, "time"),
}
"""Converters of the keywords that are named as the reading options."""


@refuse_wrong_options
@show_typed_keywords(ReadOptionKeywords)
def read(
    path: Any,
    *,
    kind: str | None = None,
    **keywords: Any,
) -> Any:
    """Read a record or a stored result; its kind is detected.

    Parameters
    ----------
    path : path or sequence of path
        A file; several files of hits are one hammer test. The folder of a batch is a lot. A table
        of pandas, polars or xarray, or a mapping of arrays, is read as a file of its columns.
    kind : str, optional
        Kind of the file, such as ``"relaxation"`` or ``"impact"`` (a hammer test); detected by
        default.
    columns, units, text, part, rate, ...
        Settings that the file does not state; see :class:`ReadOptionKeywords`.

    Returns
    -------
    RelaxationTest, ImpactTest, FRF, ... or a result
        In SI units.

    Raises
    ------
    ReadError
        If the file cannot be read, or a column or a unit is ambiguous.

    Examples
    --------
    >>> import dashpot as dp
    >>> test = dp.read("seal_8mm.csv")
    >>> type(test).__name__, test.source.file
    ('RelaxationTest', 'seal_8mm.csv')
    >>> again = dp.read("seal_8mm.csv", kind="relaxation", columns={"force": 3})
    >>> bool((again.force == test.force).all())
    True
    """
    keywords = _drop_unset(keywords)
    read_frame = None if isinstance(path, str | Path) else find_handler("read", path)
    if read_frame is not None:
        return read_frame(path, kind=kind, **keywords)
    options = _make_read_options(keywords, kind)
    if not isinstance(path, str | Path):
        return _read_several(_list_paths(path), options, keywords)
    detection = recognise(path, options)
    if detection.stored:
        from dashpot.workflow.json_archive import read_json_document

        return read_json_document(path)
    if detection.kind == "profile":
        return load_profile(path)
    read_whole = find_handler("read", detection.kind)
    if read_whole is not None:
        return read_whole(path)
    if detection.kind in {"unclear", "not-a-test"}:
        problem = describe_unknown_test(path, detection.reason, options)
        raise ReadError(f'{problem} To see its columns: dp.inspect("{path}")')
    return _read_record(path, detection.kind, options, keywords)


def _list_paths(places: Any) -> list[Path]:
    """Return several paths; refuse a value that is neither a path nor a table."""
    items = list(places) if isinstance(places, Iterable) else [places]
    others = [type(item).__name__ for item in items if not isinstance(item, str | PathLike)]
    if others or not items:
        raise DataError(
            f"dp.read takes a file, several files, or one table; {(*others, 'an empty list')[0]} "
            "is none of them. Read each table by itself: dp.read(TABLE)"
        )
    return list(map(Path, items))


def _drop_unset(keywords: Mapping[str, Any]) -> dict[str, Any]:
    """Return the given keywords."""
    return {name: value for name, value in keywords.items() if value is not None}


def _make_read_options(keywords: Mapping[str, Any], kind: str | None) -> ReadOptions:
    """Return the reading options that the caller stated."""
    for name, example in _MAPPINGS.items():
        if not isinstance(keywords.get(name, {}), Mapping):
            raise DataError(
                f"{name}= of dp.read is {keywords[name]!r}; expected a mapping, such as "
                f"{name}={example}"
            )
    columns = {
        role: _get_column_text(role, item) for role, item in (keywords.get("columns") or {}).items()
    }
    given_options: dict[str, Any] = {**columns, **(keywords.get("part") or {})}
    given_options |= {
        _TEXT.get(name, name): value for name, value in (keywords.get("text") or {}).items()
    }
    given_options |= {
        name: convert_option(keywords[name])
        for name, convert_option in _CONVERTERS.items()
        if name in keywords
    }
    fields = ReadOptions.__dataclass_fields__
    unknown = next((name for name in given_options if name not in fields), None)
    if unknown is not None:
        raise DataError(
            f"'{unknown}' is no role and no key of a file. Known are {', '.join(fields)}"
        )
    options = ReadOptions(**given_options | {"kind": kind})
    return (
        options.with_defaults(load_profile(keywords["profile"]))
        if "profile" in keywords
        else options
    )


def _get_column_text(role: str, name_or_number: Any) -> str | tuple[str, ...]:
    """The name or number of a role's column as text; of accelerations there may be several."""
    if not isinstance(name_or_number, str | int):
        return tuple(map(str, name_or_number))
    return (str(name_or_number),) if role == "acceleration" else str(name_or_number)


def _read_record(path: Place, kind: str, options: ReadOptions, keywords: Mapping[str, Any]) -> Any:
    """Return the record in a file of one of the kinds of the register."""
    name = Path(path).name
    reader = KINDS[kind].reader if kind in KINDS else ""
    accepted = signature(load_object(reader)).parameters if reader else ()
    if "options" not in accepted:
        raise ReadError(
            f"{name} is {get_kind_label(kind)}, which holds no record. To see what is in it: "
            f'dp.inspect("{path}")'
        )
    for owner in KINDS.values():
        for word in owner.read_keywords:
            if word in keywords and owner.name != kind:
                raise DataError(
                    f"{word}= is for {get_kind_label(owner.name)}. {name} is "
                    f"{get_kind_label(kind)}: leave {word}= out, or give "
                    f'kind="{owner.name}" if it is one after all'
                )
    if "specimen" in keywords and "specimen" not in accepted:
        raise DataError(f"specimen= does not suit {name}, {get_kind_label(kind)}. Leave it out")
    arguments: dict[str, Any] = {"options": options}
    read_special = _SPECIAL.get(kind) or find_handler("read record", kind)
    if read_special is not None:
        return read_special(path, arguments, keywords)
    if "specimen" in keywords:
        arguments["specimen"] = keywords["specimen"]
    return load_object(reader)(path, **arguments)


def _read_impact(path: Place, options: dict[str, Any], _: Mapping[str, Any]) -> Any:
    if options["options"].base_acceleration is not None:
        return require_handler("read several", "shaken base")([path], options=options["options"])
    return load_object(KINDS["impact"].reader)(path, **options)


def _read_transmissibility(path: Place, options: dict[str, Any], _: Mapping[str, Any]) -> Any:
    return load_object(KINDS["transmissibility"].reader)(path, **options)


_SPECIAL = {"impact": _read_impact, "transmissibility": _read_transmissibility}
"""Kinds whose readers take other arguments than the options and the specimen."""


def _read_several(paths: Sequence[Path], options: ReadOptions, keywords: Mapping[str, Any]) -> Any:
    """Files that are one record: hits of one hammer test, or points of one structure."""
    kinds = {path: recognise(path, options).kind for path in paths}
    kind_set = set(kinds.values())
    if kind_set == {"impact"}:
        if options.base_acceleration is not None:
            return require_handler("read several", "shaken base")(paths, options=options)
        return load_object(KINDS["impact"].reader)(paths, options=options)
    read_set = find_handler("read several", next(iter(kind_set))) if len(kind_set) == 1 else None
    if read_set is not None:
        return read_set(paths, options=options)
    if len(paths) == 1:
        return read(paths[0], kind=options.kind, **keywords)
    text = "; ".join(f"{path.name} is {get_kind_label(kind)}" for path, kind in kinds.items())
    raise ReadError(
        f"only hits, or FRFs at several points, are one record in several files: {text}. Read "
        "each file by itself, and fit them together: dp.fit(one, two)"
    )


@refuse_wrong_options
@show_typed_keywords(ReadOptionKeywords)
def inspect(
    path: Any,
    *,
    kind: str | None = None,
    **keywords: Any,
) -> InspectedFile:
    """Return the kind, columns, units, sampling and open questions of a file.

    Parameters
    ----------
    path : path, or a table in memory
    kind, columns, units, text, part, rate, ...
        As :func:`read` takes them.

    Raises
    ------
    ReadError
        If the file cannot be opened or holds no table.

    Examples
    --------
    >>> import dashpot as dp
    >>> dp.inspect("cld_1.csv").kind
    'cld'
    """
    from dashpot.workflow.inspections import inspect_files

    keywords = _drop_unset(keywords)
    inspect_frame = None if isinstance(path, str | PathLike) else find_handler("inspect", path)
    if inspect_frame is not None:
        result: InspectedFile = inspect_frame(path, kind=kind, **keywords)
        return result
    return inspect_files([path], options=_make_read_options(keywords, kind)).files[0]


@refuse_wrong_options
def save(result: N, path: Place, *, overwrite: bool = False) -> N:
    """Write a record or a result to a file, and return it.

    Parameters
    ----------
    result : object
        A record or a result.
    path : path
        The suffix decides the format: ``.json``, which :func:`read` takes back; ``.png``, ``.svg``
        or ``.pdf``, its picture; ``.html``, its page; ``.csv``, its numbers.
    overwrite : bool
        Whether to replace a file that dashpot did not write.

    Raises
    ------
    ExportError
        If the result has no such format, or the file exists and dashpot did not write it.

    Examples
    --------
    >>> import dashpot as dp, tempfile, pathlib
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "solid.json"
    >>> solid = dp.save(dp.GeneralizedMaxwell(200.0, k=(100.0,), tau=(0.5,)), path)
    >>> dp.read(path) == solid
    True
    """
    load_function("report.result_output", "save")(result, path, overwrite=overwrite)
    return result
