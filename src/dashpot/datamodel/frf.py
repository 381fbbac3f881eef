"""Frequency response functions (FRF), hits and modes."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import (
    SI,
    BoolArray,
    ComplexArray,
    EqualByValue,
    FloatArray,
    convert_field_to_si,
    get_unit_words,
    make_units_field,
    require_increasing,
    require_same_length,
    validate_complex_samples,
    validate_samples,
)
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.option_fields import require_choice
from dashpot.base.provenance import Source, Step
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import Plottable, Series, collect_arrays, load_function
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import Dimension, Quantity, Range, convert_to_si, parse_unit, si_range

if TYPE_CHECKING:
    from dashpot.vibration.modal.dynamic_stiffness import DynamicStiffness


class Kind(StrEnum):
    """Kind of an FRF: motion per force, its inverse, or motion per base motion (ISO 2041)."""

    RECEPTANCE = "receptance"  # x / F, m/N
    MOBILITY = "mobility"  # v / F, m/(N s)
    ACCELERANCE = "accelerance"  # a / F, 1/kg
    DYNAMIC_STIFFNESS = "dynamic_stiffness"  # F / x, N/m
    TRANSMISSIBILITY = "transmissibility"  # x / x of the base, both absolute
    RELATIVE_TRANSMISSIBILITY = "relative_transmissibility"  # (x - x of the base) / x of the base

    @classmethod
    def _missing_(cls, value: object) -> None:
        require_choice("the kind of an FRF", value, cls)

    @property
    def label(self) -> str:
        """Name of the kind in a sentence, such as "dynamic stiffness"."""
        return self.value.replace("_", " ")

    @property
    def over_base(self) -> bool:
        """Whether it is of a mass over a base that moves, not of a force on it."""
        return self in _OVER_BASE


_OVER_BASE = (Kind.TRANSMISSIBILITY, Kind.RELATIVE_TRANSMISSIBILITY)


UNITS = {
    Kind.RECEPTANCE: "m/N",
    Kind.MOBILITY: "m/(N s)",
    Kind.ACCELERANCE: "(m/s^2)/N",
    Kind.DYNAMIC_STIFFNESS: "N/m",
    Kind.TRANSMISSIBILITY: "m/m",
    Kind.RELATIVE_TRANSMISSIBILITY: "m/m",
}

# Relative random error above which a line does not determine a peak.
MAX_LINE_ERROR = 0.5
# noise cannot be estimated from fewer quiet lines
MIN_QUIET_LINES = 5
# line frequencies below this, Hz, are 0
ZERO_FREQUENCY = 1e-9
# a motion per force is the receptance times s to this power
_POWERS_OF_S = {Kind.RECEPTANCE: 0, Kind.MOBILITY: 1, Kind.ACCELERANCE: 2}


@dataclass(frozen=True)
class Hit:
    """Hammer hit and its verdict.

    Attributes
    ----------
    name : str
        What the user calls it to accept or reject it by hand, ``"1"``, ``"2"``...
    time : float
        When it struck, s on the clock of its record.
    accepted : bool
    reasons : tuple of str
        Reasons for its rejection or for doubt, one sentence each.
    peak : float
        Largest force, N.
    duration : float
        Pulse width at 10 % of the peak, s.
    frequency, damping_ratio, modal_mass : float or None
        Resonance of the ringing after this hit alone, Hz, 1 and kg; None where not determined.
    amplitude : float or None
        Initial displacement of that ringing, m.
    """

    name: str
    time: float
    accepted: bool
    reasons: tuple[str, ...] = ()
    peak: float = 0.0
    duration: float = 0.0
    frequency: float | None = None
    damping_ratio: float | None = None
    modal_mass: float | None = None
    amplitude: float | None = None


@dataclass(frozen=True, eq=False, repr=False)
class FRF(EqualByValue, Plottable, Serialisable):
    r"""A frequency response function, measured or predicted.

    Sign convention: x(t) = Re X e^{+j omega t}; the receptance of a passive system has a
    negative imaginary part.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz, increasing.
    value : complex array, shape (n,)
        In the SI unit of `quantity`.
    quantity : Kind
        What it relates: ``"accelerance"``, ``"receptance"``, ``"transmissibility"``...
    coherence : array, shape (n,) or None
        Ordinary coherence; None when predicted or when there was one hit only.
    sd : array, shape (n,) or None
        Standard deviation of the real part and of the imaginary part, unit of `value`.
    shift : float
        The exponential window's decay a, 1/s, on force and response alike: the FRF is
        :math:`H(s)` at :math:`s = j\omega + a`. 0 without a window.
    shift_sd : float
        Its standard deviation, 1/s, where the record itself determined it.
    record : float or None
        Length of the record after the hit, s, where the response may be cut short; None for
        a prediction or an untruncated one.
    pulse : float
        Rms width of the hammer's pulse, s; the record begins at its middle.
    averages : int
        Number of hits averaged; 0 when predicted.
    hits : tuple of Hit
        Every hit found, with its verdict.
    checks, source, steps
        As in a fit.
    units : str
        Units of `frequency` and `value`: ``"Hz, (m/s^2)/N"``, or ``"SI"``. Stored in SI.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> t = np.linspace(0, 10, 50)
    >>> frf = dp.FRF(frequency=t, value=t + 1j, quantity="accelerance", units="Hz, (m/s^2)/N")
    >>> frf.unit, frf.to("receptance").unit
    ('(m/s^2)/N', 'm/N')
    """

    schema = "dashpot/frf@2"
    _keys = (
        "frequency",
        "value",
        Key("kind", "quantity"),
        "coherence",
        "sd",
        "shift",
        "shift_sd",
        "record",
        "pulse",
        "averages",
        "hits",
        "checks",
        "source",
        "steps",
    )

    frequency: FloatArray
    value: ComplexArray
    quantity: Kind = Kind.ACCELERANCE
    coherence: FloatArray | None = None
    sd: FloatArray | None = None
    shift: float = 0.0
    shift_sd: float = 0.0
    record: float | None = None
    pulse: float = 0.0
    averages: int = 0
    hits: tuple[Hit, ...] = ()
    checks: tuple[Check, ...] = ()
    source: tuple[Source, ...] = ()
    steps: tuple[Step, ...] = ()
    units: str = make_units_field()

    def __post_init__(self) -> None:
        self._into_si()
        frequency = require_increasing("frequency", validate_samples("frequency", self.frequency))
        if frequency[0] < 0:
            raise DataError(f"frequency[0] = {frequency[0]:g} Hz; expected >= 0")
        object.__setattr__(self, "frequency", frequency)
        object.__setattr__(self, "value", validate_complex_samples("value", self.value))
        object.__setattr__(self, "quantity", Kind(self.quantity))
        for name in ("coherence", "sd"):
            values = getattr(self, name)
            if values is not None:
                object.__setattr__(self, name, validate_samples(name, values))
        require_same_length(
            frequency=self.frequency, value=self.value, coherence=self.coherence, sd=self.sd
        )

    def stiffness(
        self,
        *,
        mass: Quantity,
        seals: float = 1.0,
        mass_sd: Quantity | None = None,
        phase_sd: float | None = None,
        band: Range | None = None,
    ) -> DynamicStiffness:
        """Stiffness, damping and loss factor of one seal under a mass, line by line.

        As :func:`~dashpot.vibration.modal.dynamic_stiffness.dynamic_stiffness` finds them.
        """
        compute_stiffness = load_function("vibration.modal.dynamic_stiffness", "dynamic_stiffness")
        errors = {} if phase_sd is None else {"phase_sd": phase_sd}
        stiffness: DynamicStiffness = compute_stiffness(
            self, mass, seals=seals, mass_sd=mass_sd, band=band, **errors
        )
        return stiffness

    def _into_si(self) -> None:
        """Convert frequencies and values to SI; the ratio of two units shows the kind of FRF."""
        if self.units == SI:
            return
        example = f"Hz, {UNITS[Kind(self.quantity)]}"
        arrays: dict[str, Dimension] = {"frequency": "frequency", "value": "compliance"}
        hertz, of_value = get_unit_words(self, arrays, example)
        ratio = load_function("reading.columns.header_units", "parse_response_unit")(of_value)
        if ratio is None or ratio.order or ratio.kind.over_base != Kind(self.quantity).over_base:
            raise DataError(
                f"FRF: '{of_value}' is no unit of {Kind(self.quantity).label}. Write for example "
                f'units="{example}"'
            )
        if ratio.kind != self.quantity and not ratio.kind.over_base:
            raise DataError(
                f"FRF: '{of_value}' is a unit of {ratio.kind.label}, and the quantity is "
                f'{Kind(self.quantity).label}. Add quantity="{ratio.kind.value}", or write for '
                f'example units="{example}"'
            )
        convert_field_to_si(self, "frequency", parse_unit(hertz, "frequency"))
        for name in ("value", "sd"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, ratio.factor * np.asarray(getattr(self, name)))
        object.__setattr__(self, "units", SI)

    @classmethod
    def from_receptance(
        cls,
        frequency: FloatArray,
        receptance: ComplexArray,
        *,
        kind: Kind | str = Kind.ACCELERANCE,
        shift: float = 0.0,
    ) -> FRF:
        """Return the FRF, of any kind per force, whose receptance at `frequency`, Hz, is this."""
        kind, s = Kind(kind), np.asarray(2j * np.pi * frequency + shift)
        if kind.over_base:
            raise DataError(
                "a receptance alone is no transmissibility, which is of a base that moves; "
                "expected a kind per force, such as accelerance"
            )
        return cls(frequency, _as_kind(receptance, s, kind), kind, shift=shift, units=SI)

    @property
    def _table_columns(self) -> Series:
        """The response over frequency, and how well it is known."""
        return collect_arrays(self, frequency="Hz", value=self.unit, coherence="", sd=self.unit)

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the kind of FRF, its range, and its highest line."""
        size = np.abs(self.value)
        peak = int(size.argmax())
        text = f"{self.averages} averages" if self.averages else "predicted, or of unknown averages"
        files = ", ".join(source.file for source in self.source)
        return (
            (
                f"{self.quantity.label}, {self.unit}, {len(self.value)} lines, "
                f"{self.frequency[0]:.6g} to {self.frequency[-1]:.6g} Hz, "
                f"{text}{f', {files}' if files else ''}"
            ),
            f"highest line: {size[peak]:.5g} {self.unit} at {self.frequency[peak]:.6g} Hz",
        )

    @property
    def omega(self) -> FloatArray:
        """Angular frequency, rad/s."""
        return 2 * np.pi * self.frequency

    @property
    def s(self) -> ComplexArray:
        r"""Points of the Laplace plane at which the values were taken: :math:`j\omega + a`, 1/s."""
        return np.asarray(1j * self.omega + self.shift, dtype=complex)

    @property
    def is_from_hits(self) -> bool:
        """Whether it is known to be of hits: it has them, their window, or their record."""
        return bool(self.hits) or self.shift != 0 or self.record is not None

    @property
    def unit(self) -> str:
        """The SI unit of `value`."""
        return UNITS[self.quantity]

    @property
    def read(self) -> str:
        """Unit in which people read the values: 1/kg for an accelerance."""
        return "1/kg" if self.quantity is Kind.ACCELERANCE else self.unit

    def to(self, kind: Kind | str, *, mass: float | None = None) -> FRF:
        r"""Return the same FRF as receptance, mobility, accelerance or dynamic stiffness.

        Motion is differentiated by a factor s, so a windowed FRF stays exact. The line at
        frequency 0 is dropped where it would divide by zero.

        A base that moves pulls at a rigid mass as its inertia would, so that the transmissibility
        T to it and its accelerance A are one another's measure,

        .. math:: T = 1 - m A, \qquad R = T - 1 = -m A

        the second, R, being the motion relative to the base.

        Parameters
        ----------
        kind : Kind or str
        mass : float, optional
            kg; between a motion over a base and one per force. Results are as accurate as the mass.

        Raises
        ------
        DataError
            If the mass cannot be, or is needed and missing.
        """
        kind = Kind(kind)
        if kind is self.quantity:
            return self
        if kind.over_base and self.quantity.over_base:
            # a sum with 1 keeps the scatter, and the coherence not
            add = 1 if kind is Kind.TRANSMISSIBILITY else -1
            return replace(self, value=self.value + add, quantity=kind, sd=self.line_scatter)
        if kind.over_base or self.quantity.over_base:
            return self._over_base(kind, mass)
        nonzero_frf = self.only((np.abs(self.s) > 0) & (np.abs(self.value) > 0))
        if nonzero_frf.quantity in _POWERS_OF_S:
            receptance = nonzero_frf.value / nonzero_frf.s ** _POWERS_OF_S[nonzero_frf.quantity]
        else:
            receptance = 1 / nonzero_frf.value
        value = _as_kind(receptance, nonzero_frf.s, kind)
        # a relative error is the same for every kind
        sd = (
            None
            if nonzero_frf.sd is None
            else nonzero_frf.sd * np.abs(value) / np.abs(nonzero_frf.value)
        )
        return replace(nonzero_frf, value=value, quantity=kind, sd=sd)

    def _over_base(self, kind: Kind, mass: float | None) -> FRF:
        """Return the same to or from the motion of a mass over a base; see :meth:`to`."""
        if mass is None or not (np.isfinite(mass) and mass > 0):
            text = "no mass is given" if mass is None else f"mass = {mass!r} kg"
            raise DataError(
                "a transmissibility relates two motions, the others a motion and a force, and only "
                f"the mass between them, > 0 kg, gives one from the other: {text} "
                "(Python: frf.to(kind, mass=m))"
            )
        relative = Kind.RELATIVE_TRANSMISSIBILITY
        if self.quantity.over_base:
            return self.to(relative)._scale_value(-1 / mass, Kind.ACCELERANCE).to(kind)
        return self.to(Kind.ACCELERANCE)._scale_value(-mass, relative).to(kind)

    def _scale_value(self, factor: float, kind: Kind) -> FRF:
        """Return the FRF scaled by a factor, as another kind."""
        sd = None if self.sd is None else abs(factor) * self.sd
        return replace(self, value=factor * self.value, quantity=kind, sd=sd)

    @property
    def random_sd(self) -> FloatArray | None:
        r"""Standard deviation of the real and of the imaginary part, shape (n,); None if unknown.

        The FRF's own `sd` where it has one, else from coherence and n averages,
        :math:`|H| \sqrt{(1-\gamma^2) / (2 n \gamma^2)}` (ISO 7626-2, annex A).
        """
        if self.sd is not None or self.averages < 2:
            return self.sd
        scatter = self.single_average_sd
        return None if scatter is None else np.asarray(scatter / np.sqrt(self.averages))

    @property
    def single_average_sd(self) -> FloatArray | None:
        r"""Scatter of a single average by the coherence, :math:`|H|\sqrt{(1-\gamma^2)/2\gamma^2}`.

        Shape (n,); None without coherence. Of an FRF whose number of averages is not known it
        shows which lines are better than others.
        """
        if self.coherence is None:
            return None
        squared = np.clip(self.coherence, 1e-6, 1.0)
        return np.asarray(np.abs(self.value) * np.sqrt((1 - squared) / (2 * squared)))

    @property
    def line_scatter(self) -> FloatArray | None:
        """Relative scatter of the lines, by `random_sd` or its substitute."""
        return self.single_average_sd if self.random_sd is None else self.random_sd

    @property
    def usable(self) -> BoolArray:
        """Lines to hold against a model: not 0 Hz, not zero, not mere noise, shape (n,)."""
        keep = (self.frequency > ZERO_FREQUENCY) & (np.abs(self.value) > 0)
        sd = self.line_scatter
        if sd is not None:
            low_noise = keep & (sd < MAX_LINE_ERROR * np.abs(self.value))
            keep = low_noise if np.count_nonzero(low_noise) >= MIN_QUIET_LINES else keep
        return np.asarray(keep)

    def only(self, keep: BoolArray) -> FRF:
        """Return the chosen lines, `keep` of shape (n,)."""
        return replace(
            self,
            frequency=self.frequency[keep],
            value=self.value[keep],
            coherence=None if self.coherence is None else self.coherence[keep],
            sd=None if self.sd is None else self.sd[keep],
        )

    def band(self, low: Quantity, high: Quantity) -> FRF:
        """Return the lines from `low` to `high`, Hz or ``"4Hz"``, both included."""
        low, high = convert_to_si(low, "frequency"), convert_to_si(high, "frequency")
        keep = (self.frequency >= low) & (self.frequency <= high)
        if not keep.any():
            raise DataError(
                f"no line between {low:g} and {high:g} Hz; the FRF has "
                f"{self.frequency[0]:g} to {self.frequency[-1]:g} Hz"
            )
        return self.only(keep)

    def modes(
        self,
        *,
        method: str = "rational",
        band: Range | None = None,
        count: int | None = None,
    ) -> tuple[Mode, ...]:
        r"""Natural frequencies, damping ratios and residues, each with its uncertainty.

        The mode that carries most motion (largest residue of the receptance) comes first. All
        methods allow for an exponential window: the poles are those of the structure.

        Parameters
        ----------
        method : str
            ``"rational"`` fits poles and residues, by least squares weighted by `sd`, to what a
            record of finite length shows (:mod:`dashpot.vibration.modal.pole_fit`). The
            others look at the highest peak: ``"peak"`` (parabola), ``"half-power"`` (width at
            :math:`1/\sqrt2`), ``"circle"`` (Nyquist circle of the mobility) and ``"decrement"``
            (decay of the impulse response).
        band : (float, float) or str, optional
            Hz, ``"4:40Hz"``; by default two octaves to either side of the highest peak of the
            receptance.
        count : int, optional
            Exactly this many modes (``"rational"`` only); by default the significant ones.

        Returns
        -------
        tuple of Mode
            Empty if nothing oscillates in the band.

        Raises
        ------
        DataError
            If the method is unknown or the band holds too few lines.
        FitError
            If the lines cannot support the method: fewer than 5 in the half-power band.
        """
        accelerance = self.to(Kind.ACCELERANCE)  # what was recorded, and cut at its end
        find_modes = load_function("vibration.modal.modal_methods", "find_modes")
        hertz = si_range(band, "frequency")
        modes: tuple[Mode, ...] = find_modes(accelerance, method=method, band=hertz, count=count)
        if self.shift_sd == 0:
            return modes
        # a window that decays faster leaves less to the structure
        errors = [np.hypot(mode.damping_ratio_se, self.shift_sd / abs(mode.pole)) for mode in modes]
        return tuple(
            replace(mode, damping_ratio_se=float(error))
            for mode, error in zip(modes, errors, strict=True)
        )


def _as_kind(receptance: ComplexArray, s: ComplexArray, kind: Kind) -> ComplexArray:
    return receptance * s ** _POWERS_OF_S[kind] if kind in _POWERS_OF_S else 1 / receptance


@dataclass(frozen=True)
class Mode(Serialisable):
    r"""Mode: a pole pair :math:`p = \omega_n(-\zeta \pm j\sqrt{1-\zeta^2})` and its residue.

    Attributes
    ----------
    frequency : float
        Undamped natural frequency :math:`|p|/2\pi`, Hz.
    damping_ratio : float
        :math:`\zeta = -\mathrm{Re}\,p / |p|`.
    residue : complex
        Residue of the receptance, m/(N s): :math:`X/F = r/(s-p) + r^*/(s-p^*) + \dots`
    frequency_se, damping_ratio_se, residue_se : float
        Standard errors; 0 for a model's mode, nan where a method gives none.
    method : str
        How it was found.

    Examples
    --------
    >>> import dashpot as dp
    >>> round(dp.Mode(12.7, 0.0285, 0j).bandwidth, 3)
    0.724
    """

    _keys = (Key("frequency_hz", "frequency"), "damping_ratio")

    frequency: float
    damping_ratio: float
    residue: complex
    frequency_se: float = 0.0
    damping_ratio_se: float = 0.0
    residue_se: float = 0.0
    method: str = "model"

    @property
    def facts(self) -> tuple[ReportedValue, ReportedValue, ReportedValue]:
        """Frequency, damping ratio and size of the residue, as tables have them."""
        frequency, damping_ratio, residue = (
            # the uncertainty of a model's phase is unknown, and not held
            error or None
            for error in (self.frequency_se, self.damping_ratio_se, self.residue_se)
        )
        return (
            ReportedValue.from_error("frequency", self.frequency, frequency, unit="Hz"),
            ReportedValue.from_error(
                "damping ratio", self.damping_ratio, damping_ratio, unit="1", read="%"
            ),
            ReportedValue.from_error("residue", abs(self.residue), residue, unit="m/(N s)"),
        )

    @property
    def pole(self) -> complex:
        """The pole in the upper half plane, 1/s."""
        zeta = self.damping_ratio
        return complex(-zeta, np.sqrt(max(1 - zeta**2, 0.0))) * 2 * np.pi * self.frequency

    @property
    def decay(self) -> float:
        """Decay rate: sigma = -Re p, 1/s."""
        return -self.pole.real

    @property
    def bandwidth(self) -> float:
        """Width of its peak at half power, Hz."""
        return 2 * self.damping_ratio * self.frequency

    @property
    def modal_mass(self) -> float:
        r"""Mass, kg, of the single degree of freedom with this residue: Re 1/(2 j omega_d r)."""
        return float((1 / (2j * self.pole.imag * self.residue)).real)
