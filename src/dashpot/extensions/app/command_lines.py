"""A job as the command that is typed for it, so that what a page shows can be repeated."""

from __future__ import annotations

import shlex
from dataclasses import Field, fields, replace
from glob import escape
from pathlib import Path
from typing import Any, TypeVar

from dashpot.base.option_fields import get_option_flag, get_option_key, iterate_option_fields
from dashpot.base.units import (
    Dimension,
    find_unit,
    get_default_unit,
    parse_quantity,
    parse_unit,
    si_unit,
)
from dashpot.datamodel.frf import FRF
from dashpot.reading.read_options import ReadOptions
from dashpot.workflow.job import Job, replace_paths

T = TypeVar("T")


def format_command_words(attribute: Field[Any], text: str) -> list[str]:
    """Return the words by which a field is typed: ``["--machine", "sync=0.5ms"]``."""
    if "keyed_flag" not in attribute.metadata:
        return [get_option_flag(attribute), text]
    return [
        get_option_flag(attribute),
        f"{get_option_key(attribute)}{attribute.metadata.get('sign', '=')}{text}",
    ]


_part_files: dict[Any, str] = {}
"""Parts of a job that a file stated, each with the name of that file."""


def note_file(part: T, name: str) -> T:
    """Return a part of a job stated in a file; its option is the name of that file."""
    _part_files[part] = name
    return part


def format_options(result: Any, *names: str) -> list[str]:
    """Return the options of a dataclass value, or of some of its fields, as they are typed.

    Nothing of its defaults; its parts say theirs.

    >>> from dashpot.reading.read_options import ReadOptions
    >>> format_options(ReadOptions(units={"force": "N"}, skip_rows=3))
    ['--units', 'force=N', '--text-format', 'skip=3']
    """
    option_words: list[str] = []
    for glob, item in getattr(result, "file_options", ()):
        words = iter(format_options(item))
        option_words += [word for flag in words for word in (flag, f"{glob}:{next(words)}")]
    for attribute in fields(result):
        value = getattr(result, attribute.name)
        if names and attribute.name not in names:
            continue
        if "options_class" in attribute.metadata and value in _part_files:
            option_words += [f"--{attribute.name}", _part_files[value]]
        elif "options_class" in attribute.metadata:
            option_words += format_options(value)
        elif value != attribute.default and attribute in iterate_option_fields(result):
            if "is_flag" in attribute.metadata:
                option_words.append(get_option_flag(attribute))
            else:
                option_words += [
                    word
                    for text in format_values(attribute, value)
                    for word in format_command_words(attribute, text)
                ]
    return option_words


def format_values(attribute: Field[Any], value: Any) -> list[str]:
    """Return a field's value as it is typed, one text for every time."""
    metadata = attribute.metadata
    if "unparse" in metadata:
        return list(metadata["unparse"](value))
    if "is_range" in metadata:
        return [f"{value[0]!r}:{format_command_quantity(value[1], metadata['unit'])}"]
    values = value if isinstance(value, tuple) else (value,)
    if "unit" in metadata:
        return [format_command_quantity(item, metadata["unit"]) for item in values]
    return [repr(number).removesuffix(".0") if isinstance(number, float) else str(number)
            for number in values]  # fmt: skip


def format_command_quantity(value: float, dimension: Dimension) -> str:
    """Return an SI value as it is typed: a text that is read as exactly this value.

    In the customary unit if no digit is lost, else in the SI unit.

    >>> format_command_quantity(0.1148, "mass"), format_command_quantity(296.15,
    ...     "temperature"), format_command_quantity(1 / 3, "length")
    ('114.8g', '23degC', '0.3333333333333333m')
    >>> format_command_quantity(0.01, "strain"), format_command_quantity(1 / 3, "strain")
    ('1%', '0.3333333333333333m/m')
    """
    # behind a number the unit 1 is a digit more
    is_share = dimension == "strain"
    si = parse_unit("m/m", dimension) if is_share else si_unit(dimension)
    display_unit = find_unit("%" if is_share else get_default_unit(dimension), dimension) or si
    text = f"{(value - display_unit.offset) / display_unit.factor:.12g}{display_unit.word}"
    return text if parse_quantity(text, dimension) == value else f"{value!r}{si.word}"


# Command of a job, so that a result of the page can be repeated in a shell.


FIT_FILE = "fit.json"
"""File name of the solid that one command writes and the next reads."""


def format_job_command(command: str, job: Any) -> str:
    """Return ``dashpot command ...`` for a job: run where its files are, it gives its numbers.

    The job is a :class:`~dashpot.workflow.job.Job`, or that of a kind of tests.

    >>> format_job_command("fit", Job("tests/seal.csv", arms=2, temperatures=(296.15,)))
    'dashpot fit seal.csv --arms 2 --temperature 23degC'
    """
    files: list[str] = []
    named_job = replace_paths(job, lambda path: Path(path).name)
    records = [field for field in fields(named_job) if "argument" in field.metadata]
    for record in sorted(records, key=lambda field: int(field.metadata["argument"])):
        value = getattr(named_job, record.name)
        files += [value] if isinstance(value, str) else value
    if isinstance(named_job, Job):
        named_job = replace(
            named_job, reading=_merge_read_options(named_job), reading_impact=ReadOptions()
        )
        # of a hammer test alone can it be said that it is not fitted, too
        named_job = (
            named_job
            if named_job.impact
            else replace(named_job, joint=Job(named_job.relaxation).joint)
        )
    return shlex.join(["dashpot", command, *files, *format_options(named_job)])


def format_predict_command(job: Job, frf: FRF, fit: str = FIT_FILE) -> str:
    """Return ``dashpot predict ... --base`` for the mass of a job on the solid in the file `fit`.

    It gives the lines of `frf`, a transmissibility, evenly spaced.
    """
    requested_job = replace(job, band=(float(frf.frequency[0]), float(frf.frequency[-1])))
    words = format_options(requested_job, "mass", "seal_mass", "seals", "compression", "band")
    return shlex.join(["dashpot", "predict", fit, *words, "--base"])


def _merge_read_options(job: Job) -> ReadOptions:
    """Return the reading options: the units of all files, and the other options of each.

    A column or a mark of one file would make the other another kind of test.
    """
    if not job.impact:
        return job.reading
    bench, hammer = job.reading, job.reading_impact
    shared_fields = ("units",) if bench.units == hammer.units else ()
    options_by_paths = ((job.relaxation, *job.other_tests), bench), (job.impact, hammer)
    pairs = [
        (escape(path), replace(options, file_options=()).drop_fields(shared_fields))
        for paths, options in options_by_paths
        for path in dict.fromkeys(paths)
    ]
    return replace(
        bench.select_fields(shared_fields),
        file_options=(*pairs, *bench.file_options, *hammer.file_options),
    )
