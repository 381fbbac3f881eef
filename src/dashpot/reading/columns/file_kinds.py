"""Kinds of files: their names, the command that reads each, and tables that are not tests."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias

from dashpot.base import dataclass
from dashpot.base.lazy import compile_on_use
from dashpot.reading.raw_file import RawFile
from dashpot.registry import FILE_KINDS

if TYPE_CHECKING:
    from dashpot.reading.columns.vocabulary import Role


FileKind: TypeAlias = Literal[
    "relaxation", "impact", "frf", "transmissibility", "dma", "master-curve", "strain-sweep",
    "temperature-sweep", "single-frequency", "modulus", "creep", "indentation", "cld", "cyclic",
    "stress-strain", "csr", "drop", "seal-line", "free-modes", "plug-in", "blank", "preload-map",
    "not-a-test", "unclear",
]  # fmt: skip

SWEEP_KINDS: tuple[FileKind, ...] = (
    "dma", "master-curve", "strain-sweep", "temperature-sweep", "single-frequency",
)  # fmt: skip
"""The kinds of a table of storage and loss."""


class KindOfFile(NamedTuple):
    """Kind of file: its name, its purpose, and the roles of its columns.

    Attributes
    ----------
    label, usage : str
        Its name, and the command that reads it or the reason for none.
    roles : tuple of str
        Roles of its columns; the reader of a creep test or a sweep finds its own.
    takes_all_accelerations : bool
        Whether every acceleration column belongs to the record as well.
    by_hand : bool
        Whether its rows were read by hand, so that a sampling rate makes no sense.
    """

    label: str
    usage: str
    roles: tuple[Role, ...] = ()
    takes_all_accelerations: bool = False
    by_hand: bool = False


RAMP_ROLES: tuple[Role, ...] = ("time", "displacement", "force")
_FRF_ROLES: tuple[Role, ...] = ("frequency", "real", "imaginary", "magnitude", "phase", "coherence")
_SWEEP_ROLES: tuple[Role, ...] = ("frequency", "storage", "loss", "temperature")
_NO_TAU = "it shows no relaxation times; sweep the frequency"
KINDS_OF_FILE: Mapping[str, KindOfFile] = MappingProxyType({
    "relaxation": KindOfFile("a relaxation test", "use dashpot fit or dashpot report", RAMP_ROLES),
    "impact": KindOfFile("a hammer test", "use dashpot fit", ("time", "hammer"), True),
    "frf": KindOfFile("an FRF", "use dashpot fit or dashpot compare", _FRF_ROLES),
    "transmissibility": KindOfFile(
        "a transmissibility", "use dashpot fit, with the mass for the model, or compare", _FRF_ROLES
    ),
    "dma": KindOfFile("a dynamic (DMA) sweep", "use dashpot fit", _SWEEP_ROLES),
    "master-curve": KindOfFile(
        "a master curve of storage and loss", "use dashpot fit", _SWEEP_ROLES
    ),
    "strain-sweep": KindOfFile(
        "an amplitude sweep at one frequency or a few", "use dashpot fit", _SWEEP_ROLES
    ),
    "temperature-sweep": KindOfFile("a temperature sweep at one frequency", _NO_TAU, _SWEEP_ROLES),
    "single-frequency": KindOfFile("a dynamic test at one frequency", _NO_TAU, _SWEEP_ROLES),
} | {kind: KindOfFile(*row) for kind, row in FILE_KINDS.items()})  # fmt: skip
"""Every kind of file by its name; its readers and figures are rows of ``dashpot.registry``."""

_SCHEMA = compile_on_use(rb'"schema"\s*:\s*"dashpot/([a-z-]+)@')
_SCHEMA_BYTES = 1 << 16
"""Bytes that contain the schema of a document; dashpot writes it first."""
DOCUMENT_KINDS: Mapping[str, KindOfFile] = MappingProxyType({
    "fit": KindOfFile("a fit", "use dashpot predict, compare or export"),
    "model": KindOfFile("a solid", "use dashpot export"),
    "levels": KindOfFile("a fit over amplitude", "use dashpot export"),
    "hyperelastic": KindOfFile("a fit of a hyperelastic law", "use dashpot export"),
    "study": KindOfFile("a study of one seal", "use dashpot verify"),
    "job": KindOfFile("the inputs of a report", "use dashpot report"),
    "door": KindOfFile("a door", "use dashpot predict"),
    "profile": KindOfFile("a reading profile", "give it as --profile"),
    "machine": KindOfFile("a machine file", "use dashpot fit --machine"),
    "limits": KindOfFile(
        "a file of acceptance limits", "use dashpot fit --limits or dashpot report --limits"
    ),
    "project": KindOfFile("a project", "use dashpot verify"),
    "lot": KindOfFile("a lot", "use dashpot compare with another lot"),
    "batch": KindOfFile(
        "the result of a lot",
        "use dashpot fit with the file of one specimen, or dashpot compare with two folders of "
        "lots",
    ),
    "folder": KindOfFile("a folder", "use dashpot batch"),
})  # fmt: skip
"""Files that are no table of a test: their name in messages, and the command that reads them."""


@dataclass(frozen=True)
class RecognisedKind:
    """Kind of a file, and the reason for it.

    Attributes
    ----------
    kind : str
        A key of `KINDS_OF_FILE`; of a document of dashpot's own the name in its
        schema, such as ``"fit"``; or ``"door"``, ``"profile"``, ``"project"``, ``"lot"``,
        ``"folder"``.
    reason : str
    stored : bool
        Whether it is a result, or a record, that dashpot wrote as JSON.
    simulated : bool
        Whether the header marks the table as simulated.
    on_a_base : bool
        Whether an acceleration is that of the base: base excitation, no hammer.
    """

    kind: str
    reason: str
    stored: bool = False
    simulated: bool = False
    on_a_base: bool = False

    @property
    def kind_title(self) -> str:
        """Name of such a file in messages."""
        return "a shaken base with its mass" if self.on_a_base else get_kind_label(self.kind)

    @property
    def use(self) -> str:
        """The command that reads it, or why there is none; empty if unknown."""
        return get_kind_command(self.kind)


def get_kind_label(kind: str) -> str:
    """Return the name of a kind of file in messages, such as "a relaxation test".

    >>> get_kind_label("cyclic"), get_kind_label("fit"), get_kind_label("comparison")
    ('cyclic loops without a hold', 'a fit', 'a stored comparison')
    """
    kinds = KINDS_OF_FILE if kind in KINDS_OF_FILE else DOCUMENT_KINDS
    if kind in kinds:
        return kinds[kind].label
    test = {
        "unclear": "no known test",
        "not-a-test": "no test",
        "aged": "a predicted aging",
        "slammed": "a predicted drop test",
        "plugged": "a stored result of a plug-in",
    }
    return test.get(kind, f"a stored {kind.replace('-', ' ')}")


def get_kind_command(kind: str) -> str:
    """Return the command that reads a kind of file, or why there is none; empty if unknown."""
    kinds = KINDS_OF_FILE if kind in KINDS_OF_FILE else DOCUMENT_KINDS
    return kinds[kind].usage if kind in kinds else ""


def identify_json(raw: RawFile) -> RecognisedKind | None:
    """Return the kind in a document's schema; None of JSON that is not dashpot's own."""
    match = _SCHEMA.search(raw.head(_SCHEMA_BYTES))
    if match is None:
        return None
    word = match[1].decode()
    return RecognisedKind(word, f"its schema is dashpot/{word}", stored=True)
