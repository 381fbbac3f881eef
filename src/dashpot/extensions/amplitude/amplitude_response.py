"""Resonance of a mass on a part at a vibration level, predicted from an amplitude sweep."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, get_args

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import Dimension, convert_to_si
from dashpot.datamodel.frf import FRF, Kind
from dashpot.datamodel.machine import Machine
from dashpot.extensions.amplitude.checks import amplitude_in_tested_range
from dashpot.extensions.amplitude.datamodel import AmplitudeFit, AmplitudeSweep, LoopRecord
from dashpot.extensions.amplitude.fit import fit_amplitude
from dashpot.extensions.amplitude.mass_response import mass_at_level
from dashpot.extensions.amplitude.preprocess import compute_sweep
from dashpot.extensions.amplitude.read import read_amplitude, read_loops
from dashpot.reading.columns.file_kinds import KINDS_OF_FILE
from dashpot.reading.raw_file import add_name_to_errors
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.detect_kind import recognise
from dashpot.registry import RESPONSES
from dashpot.signals.segments import Loading
from dashpot.solids.maxwell import Solid
from dashpot.solids.part_geometry import Block, Disc
from dashpot.vibration.mass_on_seals import add_mount_mass
from dashpot.workflow.frf_prediction import _PART_SHAPES, parse_part_shape
from dashpot.workflow.job import LevelChoices, PartChoices, require_test_for_machine

# Geometry of the part under a mass.


def get_height(part: PartChoices) -> float | None:
    """Return the height of a pad, m; None if the part has none, or no shape is given."""
    shape = next(
        (
            parse_part_shape(flag, lengths)
            for flag in _PART_SHAPES
            if (lengths := getattr(part, flag))
        ),
        None,
    )
    return shape.height if isinstance(shape, Disc | Block) else None


STRAIN_FACTORS = (1.0, 1 / np.sqrt(3))
"""Strain of a sweep that does to the rubber what X/h of the part does: loaded alike; a part in
shear beside a sweep in tension, by equal energy."""
HITS = ("impact",)
"""Kinds of vibration records of a mass on the seals."""
_LOOPS = tuple(kind for kind in get_args(Loading) if kind in KINDS_OF_FILE)
"""Kinds of records with time, displacement and force, read here as loops."""
_MIN_BIC_DIFFERENCE = 10.0
"""Difference of BIC below which two laws of a sweep are not distinguished."""
VANISHING_LEVEL = 1e-9
"""Amplitude of excitation, N or m/s^2, without any slip."""
_COARSE_LINES, _FINE_LINES, _LINE_RANGE = 241, 61, (0.25, 2.5)
"""Lines about the linear resonance, lines about the largest of these, and how far they go."""


@dataclass(frozen=True)
class LevelResonance(Serialisable):
    """Resonance of a mass at a level.

    Attributes
    ----------
    level : float
        Amplitude of the force, N, or of the base's acceleration, m/s^2.
    unit : str
    frequency, value : float
        Frequency and value of the largest magnitude, Hz, and that magnitude.
    frequency_between, value_between : (float, float)
        95 %: what the law leaves of storage and loss about that strain and about the one where the
        part was measured, and the strain measures and laws that the sweep does not distinguish.
    amplitude : float
        Amplitude of the part's displacement there, m.
    strain : float or None
        That over the height; None if the part itself was swept.
    frf : FRF
    """

    _keys = (
        "level",
        "unit",
        "peak",
        Key("frequency_between_hz", "frequency_between"),
        "value_between",
        "amplitude",
        "strain",
    )

    level: float
    unit: str
    frequency: float
    value: float
    frequency_between: tuple[float, float]
    value_between: tuple[float, float]
    amplitude: float
    strain: float | None
    frf: FRF

    @property
    def peak(self) -> dict[str, float]:
        """Frequency and height of the peak by their names."""
        return {"frequency_hz": self.frequency, "value": self.value}


class ReferencePoint(NamedTuple):
    """Amplitude and frequency at which the stiffness of a part was measured.

    Attributes
    ----------
    frequency : float or None
        Frequency of the resonance that determined its geometry, Hz; None where a shape did.
    strain : float
        In the unit of the sweep; 0 for a vanishing one.
    """

    frequency: float | None
    strain: float


_MASTER, _PER_E, _HEIGHT, _ONE_TONE = 0.02, 0.05, 0.05, 0.1
"""Standard deviations, relative: of a stiffness, of it per e-fold of frequency, of a height, and of
a height by the law of one frequency."""
_ABOUT, _NEAREST, _ALONE, _VANISHES = 2.5, 4, 6, 1e-3


@dataclass(frozen=True)
class SweptPart(Serialisable):
    """Amplitude dependence of parts of a material, by an amplitude sweep.

    Attributes
    ----------
    laws : tuple of AmplitudeFit
        The law that fits the sweep best, and those with an equally good fit.
    factors : tuple of float
        Strain of the sweep over that of the part; the first is used, the others are possible as
        well.
    height : float or None
        m; None where the sweep is over displacement.
    fitted_at : float
        Amplitude of the test behind the solid, in the unit of the sweep; 0 for a vanishing one.
    sweep : Source or None
    record : AmplitudeSweep or None
        The samples behind the law.
    """

    _keys = (
        "sweep.file",
        "law.law",
        Key("laws", "names"),
        Key("law.constants", flatten=True),
        "height",
        Key("strain_factors", "factors"),
        "fitted_at",
    )

    laws: tuple[AmplitudeFit, ...]
    factors: tuple[float, ...]
    height: float | None
    fitted_at: float
    sweep: Source | None
    record: AmplitudeSweep | None = None

    @property
    def law(self) -> AmplitudeFit:
        """The one that is taken."""
        return self.laws[0]

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of the sweep."""
        return self.law.checks

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the laws."""
        return tuple(law.law for law in self.laws)

    def stretch(self, factor: float) -> float:
        """Return displacement of the part, m, for each of the sweep's amplitude."""
        return 1.0 if self.height is None else self.height / factor

    def frf(
        self,
        solid: Solid,
        law: AmplitudeFit,
        factor: float,
        *,
        scale: float,
        mass: float,
        level: float,
        kind: Kind,
        frequency: FloatArray,
        coupled: float = 0.0,
    ) -> tuple[FRF, FloatArray]:
        """FRF of a mass at a level, and the stretch of the part, m.

        `solid` is all that carries the mass as it was measured, N/m, `scale` N/m of it for each
        of the sweep's unit, `coupled` the mass by which the mounts couple it to a base, kg.
        """
        dependent = law.build_dependence(
            solid, scale, stretch=self.stretch(factor), since=self.fitted_at
        )
        frf, stretch = mass_at_level(
            solid, dependent, mass=mass, level=level, frequency=frequency, kind=kind
        )
        if coupled > 0:
            frf = add_mount_mass(frf, mass=mass, coupled=coupled)
        return frf, stretch

    def peak(
        self,
        solid: Solid,
        law: AmplitudeFit,
        factor: float,
        *,
        around_hz: float,
        **how: Any,
    ) -> tuple[float, float, float]:
        """Frequency, Hz, and height of the largest magnitude, and the stretch there, m.

        Raises
        ------
        DataError
            If it has no resonance near `around_hz`, Hz.
        """
        compute_frf = partial(self.frf, solid, law, factor, **how)
        f = np.geomspace(around_hz * _LINE_RANGE[0], around_hz * _LINE_RANGE[1], _COARSE_LINES)
        frf, _ = compute_frf(frequency=f)
        top = int(np.abs(frf.value).argmax())
        if top in {0, _COARSE_LINES - 1}:
            raise DataError(
                f"at {how['level']:g} {get_level_unit(how['kind'])} no resonance is found between "
                f"{f[0]:.4g} and {f[-1]:.4g} Hz"
            )
        fine_frequency = np.linspace(
            f[max(top - 2, 0)], f[min(top + 2, _COARSE_LINES - 1)], _FINE_LINES
        )
        frf, stretch = compute_frf(frequency=fine_frequency)
        magnitude = np.abs(frf.value)
        top = min(max(int(magnitude.argmax()), 1), _FINE_LINES - 2)
        left, middle, right = magnitude[top - 1 : top + 2]
        shift = (left - right) / (2 * (left - 2 * middle + right))
        return (
            float(fine_frequency[top] + shift * (fine_frequency[1] - fine_frequency[0])),
            float(middle - shift * (left - right) / 4),
            float(stretch[top]),
        )

    def compute_resonances(
        self,
        solid: Solid,
        levels: Sequence[float],
        *,
        scale: float,
        mass: float,
        kind: Kind,
        around_hz: float,
        frequency: FloatArray,
        coupled: float = 0.0,
        anchor: ReferencePoint | None = None,
    ) -> tuple[LevelResonance, ...]:
        """Return the resonance at each level, with its errors by strain measure, law and samples.

        `anchor` is the resonance that determined the part's geometry, if one did.
        """
        resonances, reference_point = [], anchor or ReferencePoint(None, self.fitted_at)
        for level in levels:
            settings: dict[str, Any] = {
                "scale": scale, "mass": mass, "level": level, "kind": kind, "coupled": coupled,
            }  # fmt: skip
            group = [
                self.peak(solid, law, factor, around_hz=around_hz, **settings)
                for law in self.laws
                for factor in self.factors
            ]
            hz, value, change = group[0]
            frf, _ = self.frf(solid, self.law, self.factors[0], frequency=frequency, **settings)
            strain = change / self.stretch(self.factors[0])
            off_hz, off_value = self.compute_relative_errors(strain, hz, reference_point)
            lowest, highest = (choose(values[0] for values in group) for choose in (min, max))
            lowest_hz, highest_hz = (choose(values[1] for values in group) for choose in (min, max))
            resonances.append(
                LevelResonance(
                    level,
                    get_level_unit(kind),
                    hz,
                    value,
                    (min(lowest, hz * np.exp(-off_hz)), max(highest, hz * np.exp(off_hz))),
                    (
                        min(lowest_hz, value * np.exp(-off_value)),
                        max(highest_hz, value * np.exp(off_value)),
                    ),
                    change,
                    None if self.height is None else change / self.height,
                    frf,
                )
            )
        return tuple(resonances)

    def compute_relative_errors(
        self, strain: float, frequency: float, anchor: ReferencePoint
    ) -> tuple[float, float]:
        r"""Two standard deviations of ln f and of ln of the height at a strain of the sweep.

        .. math:: s_K^2 = r'^2 + r_0'^2 + d^2 + 0.02^2 + (0.05 \ln f_0/f)^2, \qquad
            2 s_f = s_K, \qquad 2 s_T = 2 \sqrt{r''^2 + t^2 + 0.05^2}

        with r what the law leaves of storage (') and loss ('') within a factor 2.5 of a strain, 0
        where the part's stiffness was measured, and d and t what laws of each frequency alone
        differ by; of a sweep at one d is half of what the level does, and t is 0.1. The three
        constants are our choice, tried on two filled rubbers.
        """
        if self.record is None:
            return 0.0, 0.0
        storage, loss = self._compute_law_misfit(strain)
        reference_misfit, _ = self._compute_law_misfit(anchor.strain)
        differ, height = self._between_tones(strain, anchor.strain)
        log_distance = (
            0.0 if anchor.frequency is None else _PER_E * np.log(anchor.frequency / frequency)
        )
        stiffness_error = np.sqrt(
            storage**2 + reference_misfit**2 + differ**2 + _MASTER**2 + log_distance**2
        )
        return float(stiffness_error), float(2 * np.sqrt(loss**2 + height**2 + _HEIGHT**2))

    def _compute_law_misfit(self, strain: float) -> tuple[float, float]:
        """Return the rms misfit of the law in storage and loss, relative, about a strain."""
        assert self.record is not None  # noqa: S101
        record, tones = self.record, np.unique(self.record.frequency)
        model = np.zeros(len(record.amplitude), dtype=complex)
        for i, tone in enumerate(tones):
            selected = record.frequency == tone
            tone_index = int(np.abs(self.law.frequency - tone).argmin()) if len(tones) > 1 else i
            model[selected] = self.law.stiffness(record.amplitude[selected], tone=tone_index)
        log_distance = np.abs(np.log(record.amplitude / max(strain, record.amplitude.min())))
        is_near = log_distance <= max(
            np.log(_ABOUT), float(np.sort(log_distance)[min(_NEAREST, len(log_distance)) - 1])
        )
        parts = (
            model.real / record.storage,
            model.imag / np.where(record.loss, record.loss, np.nan),
        )
        residuals = [float(np.sqrt(np.nanmean((part[is_near] - 1) ** 2))) for part in parts]
        return residuals[0], residuals[1]

    def _between_tones(self, strain: float, amplitude: float) -> tuple[float, float]:
        """Return the difference of the laws by frequency: ln of stiffness and of loss factor."""
        assert self.record is not None  # noqa: S101
        tones = np.unique(self.record.frequency)
        amplitude = max(amplitude, _VANISHES * float(self.record.amplitude.min()))
        sweeps = [self.record.only(self.record.frequency == tone) for tone in tones]
        if len(sweeps) < 2 or min(len(sweep.amplitude) for sweep in sweeps) < _ALONE:
            storage = self.law.stiffness([amplitude, strain]).real
            return 0.5 * abs(float(np.log(storage[1] / storage[0]))), _ONE_TONE
        changes, loss_factor_changes = [], []
        for amplitude_sweep in sweeps:
            amplitude_fit = fit_amplitude(
                amplitude_sweep, law=self.law.law if self.law.law != "none" else "auto"
            )
            stiffness_at_amplitude, stiffness_at_strain = amplitude_fit.stiffness(
                [amplitude, strain]
            ).tolist()
            changes.append(float(np.log(stiffness_at_strain.real / stiffness_at_amplitude.real)))
            factor = amplitude_fit.linear[0].imag / amplitude_fit.linear[0].real
            loss_factor_changes.append(
                float(
                    np.log(
                        max(stiffness_at_strain.imag / stiffness_at_strain.real, 1e-12)
                        / max(factor, 1e-12)
                    )
                )
            )
        return float(np.ptp(changes)), float(np.ptp(loss_factor_changes))

    def check_level_coverage(self, resonances: Sequence[LevelResonance]) -> tuple[Check, ...]:
        """Return whether the sweep covers the motion of the part at each level."""
        return tuple(
            amplitude_in_tested_range(
                resonance.amplitude / self.stretch(self.factors[0]),
                self.law.amplitudes,
                location=f"{resonance.level:.4g} {resonance.unit}",
                subject=self.law.amplitude_unit,
            )
            for resonance in resonances
        )


def get_level_unit(kind: Kind) -> str:
    """Return the unit of a level: of the acceleration of the base or of the force."""
    return "m/s^2" if kind.over_base else "N"


def parse_level(word: str, kind: Kind) -> float:
    """Return a level as it was typed, N or m/s^2."""
    dimension: Dimension = "acceleration" if kind.over_base else "force"
    value = convert_to_si(word, dimension)
    if not value > 0:
        raise DataError(f"--amplitude {word}; expected an amplitude > 0")
    return value


def fit_swept_part(
    choices: LevelChoices,
    *,
    unit: str,
    part: PartChoices | None = None,
    options: ReadOptions | None = None,
) -> SweptPart | None:
    """Return the fit of the user's amplitude sweep; None if there is none.

    Parameters
    ----------
    choices : LevelChoices
    unit : str
        Unit of the solid that was fitted: Pa or N/m.
    part : PartChoices, optional

    Raises
    ------
    DataError
        If level and sweep, or a resonance and its level, do not come together, the height is not
        known, or the sweep is of a part and the solid of a material.
    """
    if choices == LevelChoices(levels=choices.levels):
        return None  # of a fit whose own law bends
    if not choices.levels or choices.sweep is None:
        raise DataError(
            "--amplitude is how far the part is moved and --sweep what this does to it; give "
            "both, or neither (FRFs at several amplitudes go to dashpot fit)"
        )
    if choices.resonance_level is not None and (part is None or part.resonance is None):
        raise DataError(
            "--resonance-amplitude is the amplitude at which a --resonance was measured; add that, "
            "or leave it out"
        )
    kind = recognise(choices.sweep, options).kind
    if kind in {*RESPONSES, *HITS}:
        raise DataError(
            f"{Path(choices.sweep).name} is of a mass ({kind}), not of the rubber; expected "
            "storage and loss over strain or displacement, or recorded loops (a mass at "
            "several amplitudes goes to dashpot fit)"
        )
    law, record, _ = amplitude_file(choices.sweep, kind, options=options)
    return make_swept_part(law, record, choices, unit=unit, part=part)


def make_swept_part(
    law: AmplitudeFit,
    record: AmplitudeSweep,
    choices: LevelChoices,
    *,
    unit: str,
    part: PartChoices | None = None,
) -> SweptPart:
    """Return the effect of amplitude on parts by the law of a sweep; see :func:`fit_swept_part`."""
    if law.unit != unit:
        raise DataError(
            f"the sweep is in {law.unit} and the fit in {unit}; expected both of the material, or "
            "both of the part"
        )
    height = _get_part_height(choices, law, None if part is None else get_height(part))
    factors = (
        (choices.strain_factor,) if choices.strain_factor else _list_strain_factors(law.source)
    )
    if height is None:
        factors = (1.0,)
    fitted_at = 0.0
    if choices.fitted_at is not None:
        fitted_at = convert_to_si(
            choices.fitted_at, "strain" if law.amplitude_unit == "strain" else "length"
        )
    return SweptPart(
        (law, *_list_rival_laws(law, record)), factors, height, fitted_at, law.source, record
    )


def amplitude_file(
    path: str | Path,
    kind: str,
    *,
    law: str = "auto",
    options: ReadOptions | None = None,
    machine: Machine | None = None,
) -> tuple[AmplitudeFit, AmplitudeSweep, AmplitudeSweep | LoopRecord]:
    """Return the law of an amplitude sweep or of recorded loops, the sweep, and the record as read.

    `kind` is what the file was taken for, `law` ``"auto"`` or one of
    ``kinds.level.laws.LAWS``.
    """
    if kind in _LOOPS:
        record = read_loops(path, options=options)
        with add_name_to_errors(Path(path).name):
            amplitude_sweep = compute_sweep(record, machine)
            return fit_amplitude(amplitude_sweep, law=law), amplitude_sweep, record
    require_test_for_machine(machine, tests=0, add="recorded loops")
    amplitude_sweep = read_amplitude(path, options=options)
    with add_name_to_errors(Path(path).name):
        return fit_amplitude(amplitude_sweep, law=law), amplitude_sweep, amplitude_sweep


def _list_strain_factors(sweep: Source | None) -> tuple[float, ...]:
    """Return the possible strain factors: of equal loading, or of shear beside tension."""
    text = " ".join(sweep.columns) if sweep else ""
    equal_factors, other_factor = STRAIN_FACTORS
    return (
        equal_factors,
        1 / other_factor if "storage: G" in text or "shear" in text.lower() else other_factor,
    )


def _get_part_height(
    choices: LevelChoices, law: AmplitudeFit, height: float | None
) -> float | None:
    """Return the height of the part, m; None for a sweep over displacement."""
    if law.amplitude_unit == "m":
        if law.unit == "Pa":
            raise DataError(
                f"{choices.sweep}: a modulus over a displacement does not give the strain; write "
                "strain into the file"
            )
        if choices.height is not None or choices.strain_factor is not None:
            raise DataError(
                "--height and --strain-factor turn the strain of a sweep into a displacement, and "
                "this sweep is over displacement; leave them out"
            )
        return None
    value = height if choices.height is None else choices.height
    if value is None:
        raise DataError(
            "the sweep is over strain: the height of the part turns it into a displacement "
            "(--height 20mm, or a shape: --shape disc:20mm,20mm)"
        )
    return value


def _list_rival_laws(law: AmplitudeFit, sweep: AmplitudeSweep) -> tuple[AmplitudeFit, ...]:
    """Return the alternative laws consistent with the sweep, such as one that scales the solid."""
    kraus, plus, spring = law.law.partition("+")
    other = {"factor": "additive", "additive": "factor"}.get(kraus, "") + plus + spring
    scores = dict(law.orders)
    if other not in scores or scores[other] > scores[law.law] + _MIN_BIC_DIFFERENCE:
        return ()
    return (fit_amplitude(sweep, law=other),)
