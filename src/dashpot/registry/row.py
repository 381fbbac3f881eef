"""Types of registry rows: kind of test, command, file format, solver input, extension.

References are words, ``"package.module:name"``, imported when they are needed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Literal, NamedTuple, TypeAlias

Place: TypeAlias = Literal[
    "", "test", "hammer", "response", "base", "bench", "level", "standalone", "part"
]
"""Place of a kind in the app."""

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
        Values of the test, and of what moves in it.
    length, radius : float or None
        Values of the specimen in contact, and of the tip of an indenter.
    compression : float or None
        The nominal one.
    machine : Machine or None
    """

    options: Any
    temperature: float | None = None
    mass: float | None = None
    length: float | None = None
    radius: float | None = None
    compression: float | None = None
    machine: Any = None


class KindOfTest(NamedTuple):
    """Kind of test.

    Attributes
    ----------
    name : str
        Name by which a file is recognised; for one that the user names, such as a rod, its command.
    reader : str
        Function that reads a file.
    fit : str
        Function that fits files; empty if there is none.
    classes : mapping of str to str
        Classes of records and results of this kind alone, and for each the function that draws its
        figure, or an empty text. Those with a schema are read back from documents.
    fit_route : str
        Route of :mod:`dashpot.workflow.fit_routing` by default; empty if it is not fitted.
    checks : str
        Module of its criteria.
    app_section : str
        Section of the app: ``"test"`` and ``"hammer"`` of a job, ``"response"`` (of a mass to a
        force), ``"base"`` (to a motion), ``"bench"`` and ``"level"`` fitted by themselves,
        ``"standalone"``, fitted by the kind alone, ``"part"`` of a door; empty if the app has none.
    pages : mapping of str to str
        Result classes with a page of their own, and the function that renders it.
    app_form : str
        Module with the form fields of the app (``FORM_FIELDS``) and the fit from their values
        (``fit_form_files``); empty if there are no fields.
    alternative_kind : str
        Kind as which the user may take a file of this one, such as a rod.
    takes_one_file : bool
        Whether its fit takes one file.
    lot_row : str
        Function from a file and its specimen to result and numbers of a row in a lot.
    columns : tuple of str
        Columns of that row which no other kind has.
    required_value : str
        Value of the specimen that the row needs.
    lot_hint : str
        Message of a lot without that value; by default which command takes the file.
    resonates : bool
        Whether a lot finds a resonance in the file alone.
    examples : str
        Mapping of its example files.
    fits : str
        Function that fits records by `fit_options` only; plug-ins name it so in their TOML file.
    kind_option : str
        Option of ``dashpot fit`` that selects the kind where the file does not show it.
    fit_options : tuple of str
        Options of ``dashpot fit`` that its fit takes.
    read_keywords : tuple of str
        Keywords of ``dp.read`` that only its reader takes.
    predict : str
        Function that predicts from a result and its `predict_options`.
    predict_options : str
        Dataclass of the options of ``dashpot predict`` for it alone.
    next_command : str
        Command to run next; FILE is replaced by the saved fit.
    order : int
        Position among all kinds, in columns and examples.
    """

    name: str
    reader: str = ""
    fit: str = ""
    classes: Mapping[str, str] = _NONE
    fit_route: str = ""
    checks: str = ""
    app_section: Place = ""
    pages: Mapping[str, str] = _NONE
    app_form: str = ""
    alternative_kind: str = ""
    takes_one_file: bool = False
    lot_row: str = ""
    columns: tuple[str, ...] = ()
    required_value: str = ""
    lot_hint: str = ""
    resonates: bool = False
    examples: str = ""
    fits: str = ""
    kind_option: str = ""
    fit_options: tuple[str, ...] = ()
    read_keywords: tuple[str, ...] = ()
    predict: str = ""
    predict_options: str = ""
    next_command: str = ""
    order: int = 0


class Command(NamedTuple):
    """Command of the command line.

    Attributes
    ----------
    name, group, help : str
        As ``dashpot --help`` lists it.
    module : str
        The module of ``command``.
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
        Its name, and the module of ``read(raw, options)``.
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
        The function for records (Python), and the one for a request of ``dashpot fit``.
    title, command_title : str
        Name of its records in messages about an unsuitable option, in Python and in a terminal.
    options : tuple of str
        The options of ``dashpot fit`` that it uses beside those of reading and result.
    selecting : tuple of str
        Options of Python and of the command line that select it for vibration tests.
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
        Function of each task, by type (``"package.module:Class"``) or name:

        ==============================  =================================================
        task                            returns
        ==============================  =================================================
        text                            text in a terminal, by type
        figure                          figure, by type
        page                            content of its page
        html                            page with a layout of its own
        export                          solver input from a result
        deck terms                      options of the solver inputs on its page
        document                        class of a schema
        read document                   field values of a class from a document
        write frf                       bytes of an FRF, by file suffix
        lot columns                     numbers in a row of a lot
        solver input                    writer of a plug-in's solver input
        procedures                      solver procedures under which a deck was run
        part text, part page            part of a result that an extension made, by its type
        deck header, deck remarks       lines of a solver input on such a part
        shift table                     rows of shift factors, by the type of that part
        plot                            figure of `dashpot.plot`, by name
        fit figure                      figure of a fit and its record or temperatures
        pole figure, poles              figure of the poles of a measured FRF; the poles
        former document                 present form of a former document or schema
        read                            reader of a kind that is no record, or of a table in memory
        inspect                         description of such a table
        make records                    records from tables or arrays in memory
        read record                     reader that needs options of its own
        read several                    reader of several files of one kind, or of a base excitation
        roles                           roles of the columns of a kind
        propose roles                   questions of a kind besides; it adds to the proposed roles
        adapt table                     table with the columns that its reader expects
        first point                     first point of a file with several
        read resonance                  mode of the highest peak of an ``"frf"``
        table rule                      whether a table is of a kind
        over amplitude                  what a ``"column"`` is over an amplitude, by its name
        record rule                     whether a record is of a kind, by its motion
        read signals                    signals of the columns of a kind, by name
        refuse sizes                    nothing; refuses units of strain and stress that none has
        calibrate                       table corrected by a calibration file
        mounts                          mounts of a seal line
        stations                        stations of the seal in a file
        suggest                         words that a user may have meant, by command
        suggest key                     what to give for an unknown key of an option, by flag
        choice                          advice on a word that an option does not take, by the word
        check arguments                 refusal of arguments of a wrong type, by language
        add advice                      what to do instead of a call from Python that failed
        install command                 command that installs an extra in this installation
        keep                            job and report saved in a folder
        fit records                     fit of bench tests, one of the type
        fit at several temperatures     fit of prepared tests
        fit at several depths           fit of one stiffness law over depth
        fit complex modulus             model from frequencies and moduli
        limits over spectra             fit whose errors are those of every admissible spectrum
        estimate frf                    FRF of a record, with checks and modes
        leave one out                   hits of a fit, for leave-one-out
        process capability              indices of values between two limits
        predict                         prediction from a model
        predict with option             the same where an option asks
        predict with sweep, read sweep  with a strain sweep; its reader
        predict at levels               FRFs of a fit at several amplitudes
        sweep at level                  sweep of a ``"mass"`` at one level of the force
        random base                     response of a ``"mass"`` or a ``"system"`` to a random base
        compare                         comparison of two results of a type
        simulated record                record of a simulated instrument
        plan repeats, planned rows      plan of a test repeated at other temperatures
        plan advice                     what tests of the ``"machine"`` would improve
        plan test                       plan of a test of its own where an option asks
        scatter of specimens            standard deviations between and within the seals of a lot
        dynamic stiffness               stiffness over frequency of what a test or a fit holds
        retained force                  share of the force that an aged seal retains
        recognise limits                whether the tables of a TOML ``"file"`` are limits
        read limits, judge interval     acceptance limits from a file; one against an interval
        judge limits                    section of the ``"app"``, options and document of limits
        bound value                     a value by its name, with what its standard error leaves out
        compare files                   comparison of two files
        predict file                    prediction from a file
        export with option              output of `export` where an option asks
        options, option groups          additional options; those under titles of their own, of
                                        ``"fit"`` and of ``"fit ..."``
        read option                     value of an option from a file, by flag
        files beside                    additional files of `simulate`
        job, fit job                    class of a job; its result and `JobPage`
        figure cards                    cards in place of a picture
        app file                        name, media type and text of what the app saves of a result
        file row                        entry of a file in the list, or None, by suffix and word
        predict open files              prediction for a kind without a fit
        recorder, record                device by its driver; recording to a file
        open folder                     last job of a folder
        ==============================  =================================================
    fits : tuple of FitRow
        Fits that records may mean.
    commands : tuple of Command
    formats : tuple of FileFormat
    solver_inputs : tuple of SolverInput
    file_kinds : mapping of str to tuple
        Arguments of `KindOfFile` of ``reading/columns/file_kinds.py``, by kind.
    """

    name: str
    kinds: tuple[KindOfTest, ...] = ()
    handlers: Mapping[str, Mapping[str, str]] = _NONE
    fits: tuple[FitRow, ...] = ()
    commands: tuple[Command, ...] = ()
    formats: tuple[FileFormat, ...] = ()
    solver_inputs: tuple[SolverInput, ...] = ()
    file_kinds: Mapping[str, tuple[Any, ...]] = _NONE
