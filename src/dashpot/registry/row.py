"""Types of registry rows: kind of test, command, file format, solver input, extension.

References are words, ``"package.module:name"``, imported when they are needed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Literal, NamedTuple, TypeAlias

Place: TypeAlias = Literal[
    "", "test", "hammer", "response", "base", "bench", "level", "judged", "part"
]
"""Where the app takes a kind."""

_NONE: Mapping[str, Any] = MappingProxyType({})


class Example(NamedTuple):
    """Example file: its kind, if recognised, and the function that writes it."""

    kind: str
    caption: str
    write: Callable[[], str]


class LotSpecimen(NamedTuple):
    """Specimen of one file of a lot, as options and lot file describe it, in SI.

    Attributes
    ----------
    options : ReadOptions
    temperature, mass : float or None
        Of the test, and of what moves in it.
    length, radius : float or None
        Of the specimen in contact, and of the tip of an indenter.
    compression : float or None
        The nominal one.
    """

    options: Any
    temperature: float | None = None
    mass: float | None = None
    length: float | None = None
    radius: float | None = None
    compression: float | None = None


class KindOfTest(NamedTuple):
    """Kind of test.

    Attributes
    ----------
    name : str
        As a file is recognised; of a test that is said to be one, such as a rod, its command.
    reader : str
        From a file to its record.
    fit : str
        From files to what is found; empty where nothing is.
    nouns : mapping of str to str
        Records and results that are of this kind alone, each with its figure, if it has one; those
        with a schema are read back from their documents.
    meant : str
        What its files are fitted as, if nothing else is given: a word of
        :mod:`dashpot.workflow.fit_routing`; empty of what is not fitted.
    checks : str
        The module of what it is asked.
    place : str
        Where the app takes it: ``"test"`` and ``"hammer"`` of a job, ``"response"`` (of a mass to a
        force) and ``"base"`` (to a motion), that or one of several levels, ``"bench"`` and
        ``"level"`` fitted by themselves, ``"judged"`` too, by their kind alone, ``"part"`` of a
        door; empty where it does not.
    pages : mapping of str to str
        Results of this kind whose page is laid out by hand, each with what does it.
    panel : str
        The module of what the app asks of it beside its files (``ASKS``), and of its fit by what
        was answered (``answered``); empty where nothing is asked.
    also : str
        The kind that no file says it is, as which one of this kind may be taken.
    alone : bool
        Whether its fit takes one file.
    row : str
        Its own row in a lot: from a file and what is known of its specimen to result and numbers.
    columns : tuple of str
        Which no other kind has, of that row.
    needs : str
        What has to be known of the specimen before.
    lot_hint : str
        In a lot, which word it waits for; by default who wants it.
    resonates : bool
        Whether a lot finds a resonance in the file alone.
    examples : str
        Its example files, each with a caption and what writes it.
    fits : str
        From records to what is found, where the fit of a kind takes no more than `takes`.
    said_by : str
        The option of ``dashpot fit`` that says files to be of it, where they do not show it.
    takes : tuple of str
        What of the options of ``dashpot fit`` its fit takes.
    predict : str
        From what was found, and what `asked` holds, to a result, where it predicts by itself.
    asked : str
        The dataclass whose fields are the options of ``dashpot predict`` for it alone.
    follow : str
        What is typed next; FILE stands for where the fit was kept.
    order : int
        Where it stands among all kinds: the order of columns and of examples.
    """

    name: str
    reader: str = ""
    fit: str = ""
    nouns: Mapping[str, str] = _NONE
    meant: str = ""
    checks: str = ""
    place: Place = ""
    pages: Mapping[str, str] = _NONE
    panel: str = ""
    also: str = ""
    alone: bool = False
    row: str = ""
    columns: tuple[str, ...] = ()
    needs: str = ""
    lot_hint: str = ""
    resonates: bool = False
    examples: str = ""
    fits: str = ""
    said_by: str = ""
    takes: tuple[str, ...] = ()
    predict: str = ""
    asked: str = ""
    follow: str = ""
    order: int = 0


class Command(NamedTuple):
    """Command of the command line.

    Attributes
    ----------
    name, group, help : str
        As ``dashpot --help`` lists it.
    module : str
        The module that holds ``command``.
    order : int
        Where it stands among all commands.
    """

    name: str
    group: str
    help: str
    module: str
    order: int = 0


class FileFormat(NamedTuple):
    """File format.

    Attributes
    ----------
    name, module : str
        Its name, and the module that holds ``read(raw, options)``.
    marks : tuple of bytes
        First bytes of its files.
    sandboxed : bool
        Whether a library parses it, in a child process with limits.
    sheets : bool
        Whether its sheets or groups have names.
    """

    name: str
    module: str
    marks: tuple[bytes, ...] = ()
    sandboxed: bool = False
    sheets: bool = False


class SolverInput(NamedTuple):
    """Solver input.

    Attributes
    ----------
    name, module : str
        Its name, and the module that holds the function of this name, ``FORMS`` and ``SUFFIX``.
    order : int
        Where it stands among all.
    synonyms : tuple of str
        Programs that read the same input, and other names, in lower case.
    """

    name: str
    module: str
    order: int = 0
    synonyms: tuple[str, ...] = ()


class FitRow(NamedTuple):
    """Fit for certain records and options.

    Attributes
    ----------
    name : str
        A word of :func:`dashpot.workflow.fit_routing.route`.
    records, files : str
        The function of records (Python), and that of a request of ``dashpot fit``.
    title, command_title : str
        What its records are called where an option does not suit them, in Python and in a terminal.
    options : tuple of str
        The options of ``dashpot fit`` that it uses beside those of reading and result.
    selecting : tuple of str
        Those of Python and of the command line that select it for tests of a vibration.
    order : int
        Where it stands among all.
    """

    name: str
    records: str
    files: str
    title: str
    command_title: str
    options: tuple[str, ...] = ()
    selecting: tuple[str, ...] = ()
    order: int = 0


class Extension(NamedTuple):
    """Contributions of one package to the registry; the core's own rows are one, too.

    Attributes
    ----------
    name : str
    kinds : tuple of KindOfTest
    handlers : mapping of str to mapping of str to str
        For a task, the function that does it for a type (``"package.module:Class"``) or for a
        name.

        Of a result: ``"text"``, ``"figure"``, ``"page"`` (what its page holds), ``"html"`` (a
        page of its own look), ``"export"`` (the input of a solver), ``"deck terms"`` (what the
        solver inputs on its page are asked for), ``"document"`` (the class of a schema), ``"read
        document"`` (fields of that class, or of one without a schema by its name, from its
        values), ``"write frf"`` (to bytes, by the ending of a file), ``"lot columns"`` (what
        the row of a lot lists), ``"solver input"`` (what writes that of a plug-in),
        ``"procedures"`` (under which of a solver a deck was run), ``"part text"``,
        ``"part page"``, ``"deck header"``, ``"deck remarks"`` and ``"shift table"`` (of a result,
        by the type of its part that an extension made).

        Of figures: ``"plot"`` (a figure of `dashpot.plot` by its name), ``"fit figure"`` (of a
        fit and a record, or the tests of its temperatures), ``"pole figure"`` (of a measured
        FRF).

        Of files: ``"former document"`` (what ``"convert"`` and ``"name schema"`` make of a
        document and of a schema of an earlier version), ``"read"`` (of a kind that is no
        record, or a table in memory by its type), ``"inspect"`` (such a table), ``"make
        records"`` (of tables or arrays in memory by the type of the first, with the options
        of a fit), ``"read record"`` (one whose reader asks for more), ``"read several"`` (of
        one kind, or of a base that is shaken), ``"roles"`` (of the columns of a kind),
        ``"table rule"`` (whether a table is of a kind), ``"calibrate"`` (a table by a file of
        its maker), ``"mounts"`` (of a line of seals), ``"stations"`` (of the seal in a file),
        ``"keep"`` (a job and its report, in a folder).

        Of fits: ``"fit records"`` (tests of a bench of which one is of the type), ``"fit at
        several temperatures"`` (prepared tests, by the type of the first), ``"fit at several
        depths"`` (prepared tests, one law of stiffness over depth), ``"fit complex modulus"``
        (from frequencies and moduli to a model), ``"estimate frf"`` (of a record, with its checks
        and modes), ``"leave one out"`` (the hits behind a fit), ``"process capability"`` (of
        values between two limits).

        Of predictions: ``"predict"`` (from a model), ``"predict with option"``, ``"predict with
        sweep"``, ``"read sweep"``, ``"predict at levels"`` (from a fit), ``"random base"`` (what
        a base that shakes at random does to a ``"mass"`` on seals, or to a ``"system"`` of
        bodies), ``"compare"`` (two of a type), ``"simulated record"`` (of a virtual test, through
        an instrument), ``"plan repeats"`` and ``"planned rows"`` (of a test that is repeated at
        other temperatures).

        Of commands: ``"compare files"``, ``"predict file"``, ``"export with option"`` (what
        `export` writes otherwise where an option asks for it), ``"options"`` (those
        that it has besides), ``"option groups"`` (those under titles of their own), ``"files
        beside"`` (those that `simulate` writes beside its record).

        Of the app: ``"job"`` (its class, by a name), ``"fit job"`` (a job to its result and its
        `JobPage`), ``"figure cards"`` (of
        a result, in place of its picture), ``"file row"`` (what the list of files says of a
        suffix), ``"predict open files"`` (of a kind that is not fitted), ``"recorder"`` (a device
        by its driver), ``"record"`` (to a file), ``"open folder"`` (the last job kept in one, and
        what finds its files).
    fits : tuple of FitRow
        Fits that records may mean.
    commands : tuple of Command
    formats : tuple of FileFormat
    solver_inputs : tuple of SolverInput
    """

    name: str
    kinds: tuple[KindOfTest, ...] = ()
    handlers: Mapping[str, Mapping[str, str]] = _NONE
    fits: tuple[FitRow, ...] = ()
    commands: tuple[Command, ...] = ()
    formats: tuple[FileFormat, ...] = ()
    solver_inputs: tuple[SolverInput, ...] = ()
