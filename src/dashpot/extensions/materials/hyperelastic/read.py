"""Reader of stress-strain tests: nominal stress over stretch of a material."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from dashpot.base import units
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.extensions.materials.hyperelastic.datamodel import StressStrainTest
from dashpot.extensions.materials.hyperelastic.size_checks import strain_of_a_rubber
from dashpot.extensions.materials.hyperelastic.strain_energy import poisson_of
from dashpot.extensions.materials.options import MODES, Measures, Mode, ModeFiles
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.role_assignment import format_column, quote_column, score_columns
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import Channel, OpenedFile
from dashpot.reading.readers.relaxation import signals
from dashpot.reading.readers.size_checks import stress_of_a_rubber
from dashpot.reading.table import Column

_REST_SHARE, _HOLD_SHARE, _RELAXATION_SHARE = 0.02, 0.5, 0.02
"""By how much a held strain moves, in parts of its range; shortest hold, in parts of the record;
least fall of the stress in the hold, in parts of the stress."""
_MODE_PATTERNS = {
    word: re.compile(pattern, re.IGNORECASE)
    for word, pattern in (
        ("uniaxial", r"\b(uni-?axial tension|tensile test)\b"),
        ("compression", r"\b(uni-?axial compression|compression test)\b"),
        ("biaxial", r"\b(equi-?)?bi-?axial\b"),
        ("planar", r"\b(planar (tension|test)|pure shear)\b"),
        ("volumetric", r"\bvolumetric (test|compression)\b"),
    )
}
_WRONG_SIGN_SHARE = 0.05
"""Part of the largest stress that may have the wrong sign: noise about zero."""


def read_stress_strain(
    path: str | Path,
    mode: Mode | None,
    *,
    is_compression: bool = False,
    measures: Measures | None = None,
    options: ReadOptions | None = None,
) -> StressStrainTest:
    """Return the stress over stretch of a material in a file, in SI units.

    Parameters
    ----------
    path : path
        With columns of stress, and of stretch or strain; a column of time is kept.
    mode : str or None
        ``"uniaxial"``, ``"equibiaxial"``, ``"planar"`` or ``"volumetric"``; None: what the lines
        above the table say, or else uniaxial.
    is_compression : bool
        The specimen was compressed: strain and stress count as magnitudes. Always so of a
        volumetric test, whose stress is a pressure.
    measures : Measures, optional
    options : ReadOptions, optional

    Raises
    ------
    ReadError
        If the file cannot be read, or leaves open which column is what, in which unit or sense.
    """
    measures = measures or Measures()
    with channels.open_file(path, options) as file:
        mode_notes: list[str] = []
        if mode is None:
            (_, mode, is_compression), mode_notes = _find_mode(file.table.header)
        is_compression = is_compression or mode == "volumetric"
        elongated = _select_elongation_role(file)
        _require_stress_strain_file(file, elongated)
        channels_chosen, values, notes = signals(
            file, elongated, "stress", min_count=4, clock_matters=False
        )
        strain, stress = values[elongated], values["stress"]
        if "time" in values and file.options.kind is None:
            _refuse_relaxation(file, channels_chosen, strain, stress)
        notes += mode_notes
        # of a volume a hundredth is much
        difference = None if mode == "volumetric" else strain - (elongated == "stretch")
        refuse_sizes(file, channels_chosen, difference, stress)
        is_stated = True
        if elongated == "strain":
            is_true, is_stated, text = _is_true(file, channels_chosen[-2], measures.strain_is)
            notes.append(text)
            strain = -np.abs(strain) if is_compression else strain
            strain = np.exp(strain) if is_true else 1 + strain
        strain, stress, sign_notes = _apply_stress_sign(
            strain, stress, is_compression=is_compression
        )
        notes += sign_notes
        if mode != "volumetric":
            is_true, said_so, text = _is_true(file, channels_chosen[-1], measures.stress_is)
            notes.append(text)
            is_stated = is_stated and said_so
            # in each mode the area across is the volume over the length
            stress = stress / strain if is_true else stress
        poisson = None
        if mode == "uniaxial" and elongated == "strain":
            poisson, said_sideways = _read_lateral_strain(
                file, channels_chosen[-2], measures, is_compression=is_compression
            )
            notes += said_sideways
        source = channels.make_source(file, [channel.message for channel in channels_chosen], notes)
        return StressStrainTest(
            mode, strain, stress, values.get("time"), is_stated, source, poisson, units="SI"
        )


def _find_mode(header: Sequence[str]) -> tuple[ModeFiles, list[str]]:
    """Return the mode that the lines above a table name, and a note; uniaxial if not just one."""
    named_modes = {
        word: f"the test is {word}, as its header says: '{line.strip()}'"
        for line in header
        for word, pattern in _MODE_PATTERNS.items()
        if pattern.search(line)
    }
    if len(named_modes) != 1:
        return MODES["uniaxial"], []
    word, note = next(iter(named_modes.items()))
    return MODES[word], [note]


def _refuse_relaxation(
    file: OpenedFile, channels_chosen: Sequence[Channel], strain: FloatArray, stress: FloatArray
) -> None:
    """Refuse a strain that is held while the stress relaxes: an elastic law would take its ramp."""
    is_held = np.abs(strain - np.median(strain)) < _REST_SHARE * float(np.ptp(strain))
    if is_held.mean() < _HOLD_SHARE or not np.ptp(strain):
        return
    stress_at_start, end = (
        float(np.median(part)) for part in np.array_split(stress[is_held], 10)[::9]
    )
    if abs(stress_at_start - end) < _RELAXATION_SHARE * abs(stress_at_start) or abs(end) > abs(
        stress_at_start
    ):
        return
    strain_channel, stress_channel = channels_chosen[-2:]
    columns = file.table.columns
    lengths = ",".join(
        f"{role}={'' if size == 1 else f'{size:.6g}'}{word}"
        for role, size, word in (
            ("displacement", strain_channel.unit.factor, "mm"), ("force", stress_channel.unit.factor
            / 1e6, "N")
        )
    )  # fmt: skip
    raise ReadError(
        "is a relaxation test in strain and stress: its strain is held for "
        f"{100 * is_held.mean():.0f} % of the record while its stress falls, and a law of stress "
        "over strain would take the ramp alone. Fit its moduli, in MPa: --kind modulus. For N/mm "
        "of a specimen, give multiples of these, which are of 1 mm by 1 mm²: --column "
        f'displacement="{quote_column(columns, strain_channel.index)}" --column '
        f'force="{quote_column(columns, stress_channel.index)}" --units "{lengths}". '
        "To fit its ramp nevertheless: --kind stress-strain"
    )


def refuse_sizes(
    file: OpenedFile,
    channels_chosen: Sequence[Channel],
    strain: FloatArray | None,
    stress: FloatArray,
) -> None:
    """Ask again for units that give an implausible size for a test of rubber.

    Parameters
    ----------
    file : OpenedFile
    channels_chosen : sequence of Channel
        The last two are those of strain or stretch, and of stress.
    strain : array, shape (n,), or None
        None if the strain is not checked.
    stress : array, shape (n,)
        Pa.

    Raises
    ------
    ReadError
    """
    strain_channel, stress_channel = channels_chosen[-2:]
    max_stress = float(np.abs(stress).max(initial=0.0))
    answers = [(stress_channel, [stress_of_a_rubber(max_stress, stress_channel.unit.word)])]
    if strain is not None:
        max_strain = float(np.abs(strain).max(initial=0.0))
        answers.insert(
            0, (strain_channel, [strain_of_a_rubber(max_strain, strain_channel.unit.word)])
        )
    channels.refuse_sizes(file, answers)


def _is_sideways(column: Column) -> bool:
    """Return whether a column holds a transverse strain."""
    is_named = vocabulary.has_word(column.name, vocabulary.SIDEWAYS)
    return (
        column.content == "number"
        and is_named
        and bool(units.find_unit(column.unit or "", "strain"))
    )


def _read_lateral_strain(
    file: OpenedFile, axial_channel: Channel, measures: Measures, *, is_compression: bool
) -> tuple[float | None, list[str]]:
    """Poisson's ratio from a column of transverse strain, and a note."""
    columns = file.table.columns
    indices = [
        i for i, column in enumerate(columns) if i != axial_channel.index and _is_sideways(column)
    ]
    if not indices:
        return None, []
    index = indices[0]
    file_with_strain = replace(
        file, options=replace(file.options, strain=quote_column(columns, index))
    )
    (lateral_channel,) = channels.choose_channels(file_with_strain, ["strain"])
    loaded_columns = channels.load(file.table, [axial_channel.index, index], file.options.segment)
    rows, _ = channels.select_complete_rows(loaded_columns)
    strains = [
        channel.unit.factor * rows[:, j]
        for j, channel in enumerate((axial_channel, lateral_channel))
    ]
    if is_compression:  # both are sizes
        strains = [-np.abs(strains[0]), np.abs(strains[1])]
    are_true = [
        _is_true(file, channel, measures.strain_is)[0]
        for channel in (axial_channel, lateral_channel)
    ]
    ratio = poisson_of(
        *(np.exp(e) if log else 1 + e for e, log in zip(strains, are_true, strict=True))
    )
    more_text = f"; {len(indices) - 1} more such columns are left out" if len(indices) > 1 else ""
    return ratio, [f"{format_column(columns, index)} shows Poisson's ratio {ratio:.3g}{more_text}"]


def _require_stress_strain_file(file: OpenedFile, strain_role: Role) -> None:
    """Refuse another kind of file, unless it has both columns."""
    if not (file.column(strain_role) and file.column("stress")):
        signal_names = ("stress", *_ELONGATED)
        channels.refuse_other_kinds(
            file, ["stress-strain"], "stress over strain is", stated_columns=signal_names
        )


def _select_elongation_role(file: OpenedFile) -> Role:
    """Return whether the file has a stretch or a strain."""
    options = file.options
    if options.stretch or options.strain:
        return "stretch" if options.stretch else "strain"
    best = {
        role: max(score_columns(file.table, role, options).values(), default=0.0)
        for role in _ELONGATED
    }  # fmt: skip
    return max(_ELONGATED, key=lambda role: best[role])


_ELONGATED: tuple[Role, Role] = ("strain", "stretch")


def _is_true(file: OpenedFile, channel: Channel, text: str) -> tuple[bool, bool, str]:
    """Return whether a stress or strain is true or nominal; whether the file states it; and why."""
    column = file.table.columns[channel.index]
    name = format_column(file.table.columns, channel.index)
    if text != "auto":
        return text == "true", True, f"{name} is {text}, as given"
    if vocabulary.has_word(column.name, vocabulary.OF_ACTUAL):
        return True, True, f"{name} is true, as its name says"
    if vocabulary.has_word(column.name, vocabulary.OF_REST):
        return False, True, f"{name} is nominal, as its name says"
    if column.unit and units.is_same_unit(column.unit, "%"):
        return False, True, f"{name} is nominal: a logarithm is not written in per cent"
    return False, False, f"{name} is taken to be nominal (--{channel.role}-is)"


def _apply_stress_sign(
    stretch: FloatArray, stress: FloatArray, *, is_compression: bool
) -> tuple[FloatArray, FloatArray, list[str]]:
    """Return stretch, stress with the sign of its strain (tension > 0), and notes."""
    if is_compression:
        return np.where(stretch > 1, 2 - stretch, stretch), -np.abs(stress), []
    strain = stretch - 1
    strain_stress_product = float(strain @ stress)
    if strain_stress_product >= 0:
        return stretch, stress, []
    if float(strain.max()) <= _WRONG_SIGN_SHARE * float(np.abs(strain).max()):
        sign_notes = ["the specimen was pressed, and its stress is counted > 0: sign changed"]
        return stretch, -stress, sign_notes
    raise ReadError(
        "the stress falls where the strain grows: one of them has the other sign; if the specimen "
        "was pressed, say so: --test compression (Python: test='compression')"
    )
