"""The register of kinds of tests: one row each, and the rooms of those that have one.

A row says of a kind by word, ``"module:name"`` under dashpot, what every other room asks of it: who
reads and fits it, what nouns it is and how they are drawn, its row in a lot, its place in the app.
What a table must hold to be of the kind, and what it is then called, stands in
`dashpot.reading.columns.kind_detection`: a low room recognises, and names nothing above it. A word
is imported when it is asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

from dashpot.base.result_mixins import verb

if TYPE_CHECKING:
    from dashpot.base.form_fields import Ask
    from dashpot.reading.read_options import ReadOptions

FIT_FILES = "workflow.fit_bench_tests:fit_files"
_PAIR = (
    "say of which test (--pair, or the column 'hammer' of --manifest), or fit both with dashpot fit"
)
_RELAXATION = "reading.readers.relaxation:read_relaxation"
_DYNAMIC = "extensions.curves.dynamic.read:read_dynamic"


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
            "datamodel.relaxation:RelaxationTest": "",
            "datamodel.relaxation:RampHold": "plot.relaxation:segments",
        },
        pages={
            "datamodel.fit:Fit": "report.result_pages.solid_page:page",
            "workflow.vibration.impact_tests:Identified": "report.result_pages.solid_page:identified_page",
            "workflow.response.frf_prediction:Prediction": (
                "report.result_pages.frf_pages:prediction_page"
            ),
        },
        checks="preprocessing.checks",
    ),
    KindOfTest(
        "impact", "reading.readers.impact:read_impact", "workflow.vibration.impact_tests:impact_files",
        place="hammer", says=_PAIR, resonates=True, meant="hits",
        nouns={"datamodel.impact:ImpactTest": ""},
        pages={
            "workflow.vibration.modes:Modes": "report.result_pages.frf_pages:modes_page",
            "workflow.vibration.impact_tests:Agreement": "report.result_pages.frf_pages:agreement_page",
        },
        checks="vibration.impact.checks",
    ),
    KindOfTest(
        "frf", "reading.readers.frf:read_frf", "extensions.modes.measured_modes:modes_files",
        place="response", says=_PAIR, resonates=True, meant="modes", also="rod",
        nouns={"datamodel.frf:FRF": "plot.frf_figure:frf"},
        pages={
            "extensions.modes.mass_series_files:ModesByMass": "report.result_pages.frf_pages:masses_page",
        },
        checks="vibration.modal.checks",
    ),
    KindOfTest(
        "transmissibility", "reading.readers.frf:read_frf",
        "extensions.modes.measured_modes:modes_files", place="base", meant="modes", also="rod",
    ),
    KindOfTest(
        "dma", _DYNAMIC, FIT_FILES, place="bench", meant="bench",
        nouns={"extensions.curves.datamodel.dynamic:DynamicTest": ""},
        checks="extensions.curves.checks",
    ),
    KindOfTest(
        "master-curve", _DYNAMIC, FIT_FILES, place="bench", meant="bench",
        nouns={"extensions.curves.datamodel.superposition:Superposition": "extensions.curves.superposition.figure:superposition"},
        checks="extensions.curves.superposition.checks",
    ),
    KindOfTest(
        "strain-sweep", "extensions.amplitude.read:read_amplitude", "extensions.amplitude.fit_files:level_files",
        place="level", meant="level",
        nouns={
            "extensions.amplitude.datamodel:AmplitudeSweep": "extensions.amplitude.figure:amplitude_sweep",
            "extensions.amplitude.datamodel:AmplitudeFit": "",
            "extensions.amplitude.level_results:LevelFit": "",
        },
        pages={"extensions.amplitude.fit_files:Levels": "extensions.amplitude.page:page"},
        checks="extensions.amplitude.checks",
    ),
    KindOfTest("temperature-sweep"),
    KindOfTest("one-frequency"),
    KindOfTest(
        "modulus", "extensions.curves.modulus.read:read_modulus", FIT_FILES, place="bench", meant="bench",
        nouns={"extensions.curves.datamodel.modulus:RelaxationModulus": ""},
        checks="extensions.curves.checks",
    ),
    KindOfTest(
        "creep", "extensions.curves.creep.read:read_creep", FIT_FILES, place="bench", meant="bench",
        nouns={
            "extensions.curves.datamodel.creep:CreepTest": "",
            "extensions.curves.datamodel.creep:LoadHold": "",
            "extensions.curves.datamodel.creep:CreepCompliance": "",
        },
        checks="extensions.curves.creep.checks",
    ),
    KindOfTest(
        "cld", "extensions.materials.cld.read:read_cld", "extensions.materials.cld.fit_files:cld_files", meant="cld",
        place="judged",
        nouns={
            "extensions.materials.cld.datamodel:CompressionTest": "",
            "extensions.materials.cld.datamodel:CLD": "extensions.materials.cld.figure:cld",
        },
        pages={"extensions.materials.cld.fit_files:Pieces": "extensions.materials.cld.page:page"},
        panel="extensions.materials.cld.app_form",
        checks="extensions.materials.cld.checks",
        row="extensions.materials.cld.lot_row:row",
        columns=(
            "cld_at_m", "cld_force_N", "cld_force_se_N", "cld_per_100mm_N", "cld_slope_N_per_m",
            "cld_hysteresis", "cld_softening", "cld_set_m",
        ),
        examples="extensions.materials.cld.examples:EXAMPLES",
    ),
    KindOfTest(
        "indentation", "extensions.materials.indentation.read:read_indentation",
        "extensions.materials.indentation.fit_files:indent_file", meant="indentation", place="judged",
        nouns={
            "extensions.materials.indentation.datamodel:IndentationTest": "",
            "extensions.materials.indentation.datamodel:IndentationFit": "extensions.materials.indentation.figure:indentation",
        },
        pages={"extensions.materials.indentation.datamodel:IndentationFit": "extensions.materials.indentation.page:page"},
        panel="extensions.materials.indentation.app_form", alone=True,
        checks="extensions.materials.indentation.checks",
        row="extensions.materials.indentation.lot_row:row", needs="mass",
        says="give the indenter's mass (--mass, or the column 'mass' of --manifest)",
        columns=(
            "indent_modulus_Pa", "indent_modulus_low_Pa", "indent_modulus_high_Pa",
            "indent_depth_m", "restitution", "contact_s",
        ),
        examples="extensions.materials.indentation.examples:EXAMPLES",
    ),
    KindOfTest(
        "rod", "reading.readers.frf:read_frf", "extensions.materials.rod.fit_files:rod_files", meant="rod",
        nouns={"extensions.materials.rod.datamodel:RodModulus": "extensions.materials.rod.figure:rod"},
        pages={"extensions.materials.rod.fit_files:Rod": "extensions.materials.rod.page:page"},
        panel="extensions.materials.rod.app_form", alone=True,
        checks="extensions.materials.rod.checks",
        examples="extensions.materials.rod.examples:EXAMPLES",
    ),
    KindOfTest(
        "stress-strain", "extensions.materials.hyperelastic.read:read_stress_strain",
        "extensions.materials.hyperelastic.fit_files:hyperelastic_files", meant="stress-strain", place="judged",
        nouns={
            "extensions.materials.hyperelastic.datamodel:StressStrainTest": "",
            "extensions.materials.hyperelastic.datamodel:HyperelasticFit": "extensions.materials.hyperelastic.figure:hyperelastic",
        },
        pages={"extensions.materials.hyperelastic.datamodel:HyperelasticFit": "extensions.materials.hyperelastic.page:page"},
        panel="extensions.materials.hyperelastic.app_form",
        checks="extensions.materials.hyperelastic.checks",
        examples="extensions.materials.hyperelastic.examples:EXAMPLES",
    ),
    KindOfTest(
        "csr", "extensions.materials.csr.read:read_csr", "extensions.materials.csr.fit_files:csr_files", meant="csr",
        place="judged",
        nouns={
            "extensions.materials.csr.datamodel:CounterforceTest": "",
            "extensions.materials.csr.datamodel:Aging": "extensions.materials.csr.figure:csr",
            "extensions.materials.csr.lifetime_prediction:Aged": "extensions.materials.csr.figure:aged",
        },
        pages={"extensions.materials.csr.datamodel:Aging": "extensions.materials.csr.page:page"},
        checks="extensions.materials.csr.checks",
        row="extensions.materials.csr.lot_row:row",
        columns=(
            "csr_loss_per_decade", "csr_chemical_time_s", "csr_chemical_time_low_s",
            "csr_activation_J_per_mol",
        ),
        examples="extensions.materials.csr.examples:EXAMPLES",
        fits="extensions.materials.csr.fit:fit_aging", takes=("temperatures", "machine"),
        predict="extensions.materials.csr.lifetime_prediction:predict_aged", asked="extensions.materials.csr.options:AgingAsked",
        follow="predict FILE --temperature 70degC --until 50%",
    ),
    KindOfTest(
        "slam", "extensions.materials.slam.read:read_slams", "extensions.materials.slam.fit_files:slam_files", meant="slam",
        place="judged",
        nouns={
            "extensions.materials.slam.datamodel:SlamTest": "",
            "extensions.materials.slam.datamodel:SlamFit": "extensions.materials.slam.figure:slams",
            "extensions.materials.slam.prediction:Slam": "extensions.materials.slam.figure:slam",
        },
        panel="extensions.materials.slam.app_form",
        checks="extensions.materials.slam.checks",
        examples="extensions.materials.slam.examples:EXAMPLES",
        fits="extensions.materials.slam.fit:fit_slams", takes=("mass", "slam", "memory", "specimen"),
    ),
    KindOfTest(
        "cyclic", _RELAXATION, "extensions.amplitude.fit_files:level_files", place="level",
        meant="level",
        checks="extensions.amplitude.checks",
        examples="extensions.amplitude.examples:EXAMPLES",
    ),
    KindOfTest(
        "plug-in", "extensions.plugins.read:read_plugged", "extensions.plugins.fit_files:plugged_files",
        meant="plug-in",
        nouns={
            "extensions.plugins.datamodel:PluggedTest": "",
            "extensions.plugins.datamodel:PluggedFit": "extensions.plugins.figure:plugged",
        },
        fits="extensions.plugins.fit:fit_plugged",
    ),
    KindOfTest("seal-line", place="part"),
    KindOfTest("free-modes", "extensions.door.read_modes:read_modes", place="part"),
)})  # fmt: skip
"""Every kind, in the order in which columns and examples stand."""

RESPONSES = tuple(kind.name for kind in KINDS.values() if kind.place in {"response", "base"})
"""Kinds that are what a mass on its seals does, over frequency."""

_NOUNS = {noun: kind for kind in KINDS.values() for noun in kind.nouns}
FIGURES = {noun: figure for kind in KINDS.values() for noun, figure in kind.nouns.items()} | {
    "extensions.door.result:DoorResult": "extensions.door.figure:door",
    "extensions.door.closing_result:ClosingResult": "extensions.door.closing_figure:closing",
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
