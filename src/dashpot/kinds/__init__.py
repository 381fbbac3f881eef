"""The register of kinds of tests: one row each, and the rooms of those that have one.

A row says of a kind by word, ``"module:name"`` under dashpot, what every other room asks of it: who
reads and fits it, what nouns it is and how they are drawn, its row in a lot, its place in the app.
What a table must hold to be of the kind, and what it is then called, stands in
`dashpot.io.columns.kinds`: a low room recognises, and names nothing above it. A word is imported
when it is asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

from dashpot.base.offered import verb

if TYPE_CHECKING:
    from dashpot.base.asks import Ask
    from dashpot.io.options import ReadOptions

FIT_FILES = "workflow.fits:fit_files"
_PAIR = (
    "say of which test (--pair, or the column 'hammer' of --manifest), or fit both with dashpot fit"
)
_RELAXATION = "io.readers.relaxation:read_relaxation"
_DYNAMIC = "io.readers.dynamic:read_dynamic"


def load(word: str) -> Any:
    """Return what a word names."""
    return verb(*word.split(":"))


Meant: TypeAlias = Literal[
    "bench",
    "hits",
    "modes",
    "level",
    "rod",
    "cld",
    "stress-strain",
    "indentation",
    "csr",
    "slam",
    "plug-in",
]
"""What records of one kind are fitted as."""


Place: TypeAlias = Literal[
    "", "test", "hammer", "response", "base", "bench", "level", "judged", "part"
]
"""Where the app takes a kind."""


class Example(NamedTuple):
    """A file to learn on: the kind that it is recognised as, if any, and what writes it."""

    kind: str
    caption: str
    write: Callable[[], str]


@dataclass(frozen=True)
class Piece:
    """What a lot knows of one file besides what stands in it, SI.

    Attributes
    ----------
    options : ReadOptions
    temperature, mass : float or None
        Of the test, and of what moves in it.
    length, radius : float or None
        Of the piece in contact, and of the tip of an indenter.
    compression : float or None
        The nominal one.
    """

    options: ReadOptions
    temperature: float | None = None
    mass: float | None = None
    length: float | None = None
    radius: float | None = None
    compression: float | None = None


@dataclass(frozen=True)
class KindOfTest:
    """A kind of test.

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
        :mod:`dashpot.workflow.routing`; empty of what is not fitted.
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
        Its own row in a lot: from a file and what is known of its piece to result and numbers.
    columns : tuple of str
        Which no other kind has, of that row.
    needs : str
        What has to be known of the piece before.
    says : str
        In a lot, which word it waits for; by default who wants it.
    resonates : bool
        Whether a lot finds a resonance in the file alone.
    examples : str
        Its example files, each with a caption and what writes it.
    fits : str
        From records to what is found, where the fit of a kind takes no more than `takes`.
    takes : tuple of str
        What of the options of ``dashpot fit`` its fit takes.
    predict : str
        From what was found, and what `asked` holds, to a result, where it predicts by itself.
    asked : str
        The noun whose fields are the options of ``dashpot predict`` for it alone.
    follow : str
        What is typed next; FILE stands for where the fit was kept.
    """

    name: str
    reader: str = ""
    fit: str = ""
    nouns: Mapping[str, str] = field(default_factory=dict)
    meant: Meant | Literal[""] = ""
    checks: str = ""
    place: Place = ""
    pages: Mapping[str, str] = field(default_factory=dict)
    panel: str = ""
    also: str = ""
    alone: bool = False
    row: str = ""
    columns: tuple[str, ...] = ()
    needs: str = ""
    says: str = ""
    resonates: bool = False
    examples: str = ""
    fits: str = ""
    takes: tuple[str, ...] = ()
    predict: str = ""
    asked: str = ""
    follow: str = ""


KINDS: Mapping[str, KindOfTest] = MappingProxyType({kind.name: kind for kind in (
    KindOfTest(
        "relaxation", _RELAXATION, FIT_FILES, place="test", meant="bench",
        nouns={
            "records.relaxation:RelaxationTest": "",
            "records.relaxation:RampHold": "plot.relaxation:segments",
        },
        pages={
            "records.fit:Fit": "report.kind_pages.solid:page",
            "workflow.vibration.impacts:Identified": "report.kind_pages.solid:identified_page",
            "workflow.response.predictions:Prediction": (
                "report.kind_pages.response:prediction_page"
            ),
        },
        checks="preparation.checks",
    ),
    KindOfTest(
        "impact", "io.readers.impact:read_impact", "workflow.vibration.impacts:impact_files",
        place="hammer", says=_PAIR, resonates=True, meant="hits",
        nouns={"records.impact:ImpactTest": ""},
        pages={
            "workflow.vibration.modes:Modes": "report.kind_pages.response:modes_page",
            "workflow.vibration.impacts:Agreement": "report.kind_pages.response:agreement_page",
        },
        checks="vibration.impact.checks",
    ),
    KindOfTest(
        "frf", "io.readers.frf:read_frf", "workflow.vibration.measured_modes:modes_files",
        place="response", says=_PAIR, resonates=True, meant="modes", also="rod",
        nouns={"records.frf:FRF": "plot.vibration:frf"},
        pages={
            "workflow.vibration.under_masses:ModesByMass": "report.kind_pages.response:masses_page",
        },
        checks="vibration.modal.checks",
    ),
    KindOfTest(
        "transmissibility", "io.readers.frf:read_frf",
        "workflow.vibration.measured_modes:modes_files", place="base", meant="modes", also="rod",
    ),
    KindOfTest(
        "dma", _DYNAMIC, FIT_FILES, place="bench", meant="bench",
        nouns={"records.dynamic:DynamicTest": ""},
        checks="fitting.checks.curves",
    ),
    KindOfTest(
        "master-curve", _DYNAMIC, FIT_FILES, place="bench", meant="bench",
        nouns={"records.superposition:Superposition": "plot.superposition_figure:superposition"},
        checks="fitting.checks.temperature",
    ),
    KindOfTest(
        "strain-sweep", "kinds.level.read:read_amplitude", "workflow.vibration.levels:level_files",
        place="level", meant="level",
        nouns={
            "kinds.level.record:AmplitudeSweep": "kinds.level.figure:amplitude_sweep",
            "kinds.level.record:AmplitudeFit": "",
            "kinds.level.levels:LevelFit": "",
        },
        pages={"workflow.vibration.levels:Levels": "report.kind_pages.level:page"},
        checks="kinds.level.checks",
    ),
    KindOfTest("temperature-sweep"),
    KindOfTest("one-frequency"),
    KindOfTest(
        "modulus", "io.readers.modulus:read_modulus", FIT_FILES, place="bench", meant="bench",
        nouns={"records.modulus:RelaxationModulus": ""},
        checks="fitting.checks.curves",
    ),
    KindOfTest(
        "creep", "io.readers.creep:read_creep", FIT_FILES, place="bench", meant="bench",
        nouns={
            "records.creep:CreepTest": "",
            "records.creep:LoadHold": "",
            "records.creep:CreepCompliance": "",
        },
        checks="fitting.checks.creep",
    ),
    KindOfTest(
        "cld", "kinds.cld.read:read_cld", "kinds.cld.from_files:cld_files", meant="cld",
        place="judged",
        nouns={
            "kinds.cld.record:CompressionTest": "",
            "kinds.cld.record:CLD": "kinds.cld.figure:cld",
        },
        pages={"kinds.cld.from_files:Pieces": "report.kind_pages.cld:page"},
        panel="kinds.cld.panel",
        checks="kinds.cld.checks",
        row="kinds.cld.row:row",
        columns=(
            "cld_at_m", "cld_force_N", "cld_force_se_N", "cld_per_100mm_N", "cld_slope_N_per_m",
            "cld_hysteresis", "cld_softening", "cld_set_m",
        ),
        examples="kinds.cld.examples:EXAMPLES",
    ),
    KindOfTest(
        "indentation", "kinds.indentation.read:read_indentation",
        "kinds.indentation.from_files:indent_file", meant="indentation", place="judged",
        nouns={
            "kinds.indentation.record:IndentationTest": "",
            "kinds.indentation.record:IndentationFit": "kinds.indentation.figure:indentation",
        },
        pages={"kinds.indentation.record:IndentationFit": "report.kind_pages.indentation:page"},
        panel="kinds.indentation.panel", alone=True,
        checks="kinds.indentation.checks",
        row="kinds.indentation.row:row", needs="mass",
        says="give the indenter's mass (--mass, or the column 'mass' of --manifest)",
        columns=(
            "indent_modulus_Pa", "indent_modulus_low_Pa", "indent_modulus_high_Pa",
            "indent_depth_m", "restitution", "contact_s",
        ),
        examples="kinds.indentation.examples:EXAMPLES",
    ),
    KindOfTest(
        "rod", "io.readers.frf:read_frf", "workflow.vibration.rods:rod_files", meant="rod",
        nouns={"kinds.rod.record:RodModulus": "kinds.rod.figure:rod"},
        pages={"workflow.vibration.rods:Rod": "report.kind_pages.rod:page"},
        panel="workflow.vibration.rod_panel", alone=True,
        checks="kinds.rod.checks",
        examples="kinds.rod.examples:EXAMPLES",
    ),
    KindOfTest(
        "stress-strain", "kinds.hyperelastic.read:read_stress_strain",
        "kinds.hyperelastic.from_files:hyperelastic_files", meant="stress-strain", place="judged",
        nouns={
            "kinds.hyperelastic.record:StressStrainTest": "",
            "kinds.hyperelastic.record:HyperelasticFit": "kinds.hyperelastic.figure:hyperelastic",
        },
        pages={"kinds.hyperelastic.record:HyperelasticFit": "report.kind_pages.hyperelastic:page"},
        panel="kinds.hyperelastic.panel",
        checks="kinds.hyperelastic.checks",
        examples="kinds.hyperelastic.examples:EXAMPLES",
    ),
    KindOfTest(
        "csr", "kinds.csr.read:read_csr", "kinds.csr.from_files:csr_files", meant="csr",
        place="judged",
        nouns={
            "kinds.csr.record:CounterforceTest": "",
            "kinds.csr.record:Aging": "kinds.csr.figure:csr",
            "kinds.csr.aged:Aged": "kinds.csr.figure:aged",
        },
        pages={"kinds.csr.record:Aging": "report.kind_pages.csr:page"},
        checks="kinds.csr.checks",
        row="kinds.csr.row:row",
        columns=(
            "csr_loss_per_decade", "csr_chemical_time_s", "csr_chemical_time_low_s",
            "csr_activation_J_per_mol",
        ),
        examples="kinds.csr.examples:EXAMPLES",
        fits="kinds.csr.fit:fit_aging", takes=("temperatures", "machine"),
        predict="kinds.csr.aged:predict_aged", asked="kinds.csr.asked:AgingAsked",
        follow="predict FILE --temperature 70degC --until 50%",
    ),
    KindOfTest(
        "slam", "kinds.slam.read:read_slams", "kinds.slam.from_files:slam_files", meant="slam",
        place="judged",
        nouns={
            "kinds.slam.record:SlamTest": "",
            "kinds.slam.record:SlamFit": "kinds.slam.figure:slams",
            "kinds.slam.predicted:Slam": "kinds.slam.figure:slam",
        },
        panel="kinds.slam.panel",
        checks="kinds.slam.checks",
        examples="kinds.slam.examples:EXAMPLES",
        fits="kinds.slam.fit:fit_slams", takes=("mass", "slam", "memory", "specimen"),
    ),
    KindOfTest(
        "cyclic", _RELAXATION, "workflow.vibration.levels:level_files", place="level",
        meant="level",
        checks="kinds.level.checks",
        examples="kinds.level.examples:EXAMPLES",
    ),
    KindOfTest(
        "plug-in", "kinds.plugged.read:read_plugged", "kinds.plugged.from_files:plugged_files",
        meant="plug-in",
        nouns={
            "kinds.plugged.record:PluggedTest": "",
            "kinds.plugged.record:PluggedFit": "kinds.plugged.figure:plugged",
        },
        fits="kinds.plugged.fit:fit_plugged",
    ),
    KindOfTest("seal-line", place="part"),
    KindOfTest("free-modes", "door.read_modes:read_modes", place="part"),
)})  # fmt: skip
"""Every kind, in the order in which columns and examples stand."""

RESPONSES = tuple(kind.name for kind in KINDS.values() if kind.place in {"response", "base"})
"""Kinds that are what a mass on its seals does, over frequency."""

_NOUNS = {noun: kind for kind in KINDS.values() for noun in kind.nouns}
FIGURES = {noun: figure for kind in KINDS.values() for noun, figure in kind.nouns.items()} | {
    "door.result:DoorResult": "door.figure:door",
    "door.closing_result:ClosingResult": "door.closing_figure:closing",
}
"""What draws each noun of a kind, and those of a door, which is no kind of test."""


_PAGES = {noun: page for kind in KINDS.values() for noun, page in kind.pages.items()}

PREDICTED = tuple(kind for kind in KINDS.values() if kind.predict)
"""Kinds whose fit predicts by itself, and not as a solid."""


def takers(option: str) -> str:
    """Return the kinds whose fit takes an option of the command, as its help wants them."""
    return " ".join(kind.name for kind in KINDS.values() if option in kind.takes)


def row_of(noun: object) -> KindOfTest | None:
    """Return the kind that a record or a result is of; None of what is of none, or of several."""
    return _NOUNS.get(_word(type(noun)))


def figure_of(noun: object) -> Any:
    """Return the function that draws a record or a result; None if none does."""
    word = FIGURES.get(_word(type(noun)))
    return load(word) if word else None


def page_of(noun: object) -> Any:
    """Return what lays out the page of a result or of what it is one of; None if nothing does."""
    words = (_PAGES.get(_word(one)) for one in type(noun).__mro__)
    return next((load(word) for word in words if word), None)


def asks_of(name: str) -> tuple[Ask, ...]:
    """Return what the app asks beside the files of a kind."""
    kind = KINDS.get(name)
    return load(f"{kind.panel}:ASKS") if kind is not None and kind.panel else ()


def _word(noun: type) -> str:
    return f"{noun.__module__.removeprefix('dashpot.')}:{noun.__qualname__}"
