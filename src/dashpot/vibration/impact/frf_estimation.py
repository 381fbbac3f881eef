"""FRF estimation from hammer hits: windowed, weighted, averaged."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import BoolArray, FloatArray, replace_notes
from dashpot.base.errors import DataError
from dashpot.base.option_fields import require_choice
from dashpot.base.provenance import Step
from dashpot.base.units import Quantity, Range, convert_to_si, format_quantity, si_range
from dashpot.base.value_ranges import require_positive
from dashpot.datamodel.checks import caution_checks
from dashpot.datamodel.frf import FRF, Hit
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.vibration.impact.amplitude_trend import add_resonances
from dashpot.vibration.impact.checks import agreement, run_frf_checks, window_decay_determined
from dashpot.vibration.impact.exponential_window import (
    NO_WINDOW,
    ExponentialWindow,
    find_window,
    without_offset,
)
from dashpot.vibration.impact.hit_faults import (
    HitQuality,
    compute_pre_hit_motion,
    compute_undecayed_fraction,
    judge_hit,
)
from dashpot.vibration.impact.hits import HitBlock, cut_hits, remove_ringing
from dashpot.vibration.impact.rocking import Combination, compute_rocking_weights
from dashpot.vibration.impact.spectral_estimators import (
    ChannelSpectra,
    Estimator,
    Spectra,
    coherence,
    estimate,
    random_error,
)
from dashpot.vibration.modal.peaks import find_mount_band
from dashpot.vibration.modal.pole_fit import FRFLines

# Average of hits: windows, signs and weights.


MIN_FORCE_RATIO = 0.1  # -20 dB: where the force has fallen this far, the FRF ends
ALIAS_FREE = 0.4  # of the sampling rate
POLARITY_SHARE = 0.5  # of all motion must go one way to show the polarity of an accelerometer
WINDOW_END = 0.01  # what an exponential window leaves of the response at the end of the record
WINDOW_FORMS = "none, force, exponential, exponential:0.01, force+exponential"


@dataclass(frozen=True)
class Window:
    """Window options: of the force, exponential of both channels, and its end value if given."""

    force: bool = False
    exponential: bool = False
    end: float | None = None

    @classmethod
    def parse(cls, window: str) -> Window:
        """Understand ``"force+exponential:0.01"``.

        Never a Hann window: it would erase the pulse, which stands at the edge of the record.
        """
        force, exponential, end = False, False, None
        for part in window.split("+"):
            name, _, value = part.strip().partition(":")
            if name == "force" and not value:
                force = True
            elif name == "exponential":
                exponential = True
                end = _find_end(value, window) if value else None
            elif name != "none" or value or window != "none":
                raise DataError(
                    f"window {window!r} does not suit a hammer test; expected one of {WINDOW_FORMS}"
                )
        return cls(force, exponential, end)

    def decay(self, hits: Sequence[HitBlock]) -> float:
        r"""Decay a of the exponential window :math:`e^{-at}`, 1/s; 0 without one.

        Without a wanted end value, the gentlest that leaves 1 % of the response at the end of
        the record, of which a part is left without a window.
        """
        if not self.exponential:
            return 0.0
        remainder = max(map(compute_undecayed_fraction, hits))
        end = min(1.0, WINDOW_END / max(remainder, WINDOW_END)) if self.end is None else self.end
        return float(-np.log(end) / hits[0].length)


def _find_end(value: str, window: str) -> float:
    try:
        end_value = float(value)
    except ValueError:
        end_value = float("nan")
    if not 0 < end_value < 1:
        raise DataError(
            f"window {window!r}: the number is what the window leaves at the end of the record; "
            "expected more than 0 and less than 1, such as exponential:0.01"
        )
    return end_value


def _make_force_window(hit: HitBlock) -> FloatArray:
    """One over the pulse, a half-cosine down over twice its length, then zero: shape (n,)."""
    pulse = hit.pulse(0.01)
    flat_stop = pulse.stop + max(pulse.stop - pulse.start, 4)
    taper_length = 2 * max(pulse.stop - pulse.start, 4)
    samples = np.arange(len(hit.force))
    return np.asarray(
        0.5 * (1 + np.cos(np.pi * np.clip((samples - flat_stop) / taper_length, 0, 1)))
    )


@dataclass(frozen=True)
class AveragingOptions:
    """Validated averaging options."""

    estimator: Estimator
    window: Window
    combine: str
    polarity: Sequence[int] | None
    band: tuple[float, float] | None
    accept: tuple[str, ...]
    channels: tuple[str, ...]
    reach: float | None
    recorded: ExponentialWindow = NO_WINDOW
    """The window that the record carries."""


@dataclass(frozen=True, eq=False)
class Average:
    """Average of hits: their qualities, and transforms, weights and FRF of those accepted."""

    hits: tuple[HitBlock, ...]
    qualities: tuple[HitQuality, ...]
    accepted: BoolArray
    transforms: ChannelSpectra
    weights: FloatArray
    rocking: Combination | None
    spectra: Spectra
    estimator: Estimator
    shift_sd: float = 0.0

    @cached_property
    def frf(self) -> FRF:
        """The numbers of the average: FRF, coherence and random error."""
        transforms, value = self.transforms, estimate(self.spectra, self.estimator)
        return FRF(
            frequency=transforms.frequency,
            value=value,
            coherence=coherence(self.spectra),
            sd=random_error(self.spectra, value),
            shift=transforms.shift,
            shift_sd=self.shift_sd,
            record=transforms.record,
            pulse=transforms.pulse,
            averages=self.spectra.averages,
            units="SI",
        )


def average_hits(
    hits: Sequence[HitBlock], accepted: BoolArray, choices: AveragingOptions
) -> Average:
    """Transform, turn, weight and average the hits taken, and judge them all."""
    windowed = choices.window.exponential or choices.recorded.rate > 0
    qualities = [judge_hit(hit, windowed=windowed) for hit in hits]
    accepted_hits = [hit for hit, t in zip(hits, accepted, strict=True) if t]
    transforms = _transform(hits, choices, choices.window.decay(accepted_hits)).band(
        *(choices.band or _find_excited_band(accepted_hits))
    )
    transforms = transforms.apply_signs(_find_signs(transforms.only(accepted), choices.polarity))
    weights, rocking = _combine(transforms.only(accepted), choices)
    qualities, accepted = agreement(
        transforms.combine_channels(weights), qualities, accepted, choices.accept
    )
    transforms = transforms.only(accepted)
    return Average(
        hits=tuple(hits),
        qualities=tuple(qualities),
        accepted=accepted,
        transforms=transforms,
        weights=weights,
        rocking=rocking,
        spectra=transforms.combine_channels(weights),
        estimator=choices.estimator,
        shift_sd=choices.recorded.sd,
    )


def _transform(hits: Sequence[HitBlock], choices: AveragingOptions, decay: float) -> ChannelSpectra:
    rate = hits[0].rate
    recorded, time = choices.recorded, np.arange(len(hits[0].force)) / rate
    decay_factor = np.exp(-decay * time)
    # of the response alone: the force is given the same
    faded = [decay_factor * recorded.compute_response_only_window(b) for b in hits]
    force = [f * b.force * (_make_force_window(b) if choices.window.force else 1.0)
             for f, b in zip(faded, hits, strict=True)]  # fmt: skip
    response = np.array([b.acceleration * decay_factor for b in hits]).swapaxes(0, 1)
    return ChannelSpectra(
        frequency=np.asarray(np.fft.rfftfreq(len(decay_factor), 1 / rate), dtype=np.float64),
        force=np.fft.rfft(force, axis=-1) / rate,
        response=np.fft.rfft(response, axis=-1) / rate,
        hits=tuple(hits),
        channels=choices.channels,
        signs=np.ones(len(choices.channels)),
        shift=decay + recorded.rate,
    )


def _find_excited_band(hits: Sequence[HitBlock]) -> tuple[float, float]:
    """Return lines above 0 Hz that the hammer excites: up to where its spectrum falls by 20 dB."""
    rate, n = hits[0].rate, len(hits[0].force)
    power = (np.abs(np.fft.rfft([b.force * _make_force_window(b) for b in hits])) ** 2).mean(axis=0)
    weak_lines = np.flatnonzero(power < MIN_FORCE_RATIO**2 * power[: max(n // 500, 2)].max())
    highest_line = float(weak_lines[0]) if weak_lines.size else np.inf
    return 0.5 * rate / n, min(max(highest_line - 0.5, 8.5), ALIAS_FREE * n) * rate / n


def _find_signs(transforms: ChannelSpectra, polarity: Sequence[int] | None) -> FloatArray:
    """Sign of each accelerometer: a hit sets a block moving in its own direction."""
    count = len(transforms.channels)
    if polarity is not None:
        values = np.array(polarity, dtype=float)
        if len(values) != count or (np.abs(values) != 1).any():
            raise DataError(
                f"polarity = {tuple(polarity)}; expected +1 or -1 for each of the {count} "
                f"accelerometers ({', '.join(transforms.channels)})"
            )
        return values
    band_transforms = transforms.band(*_find_mount_band(transforms))
    h = np.array([estimate(spectra) for spectra in band_transforms.split_channels()])
    # the real part of the mobility, summed, is the velocity just after the hit
    mobility = (h / band_transforms.s).real
    kick = mobility.sum(axis=1) / np.abs(mobility).sum(axis=1)
    if kick.min() < -POLARITY_SHARE and kick.max() > POLARITY_SHARE:
        same_sign_names, opposite_names = (
            ", ".join(np.array(transforms.channels)[is_of_side])
            for is_of_side in (kick > 0, kick <= 0)
        )
        raise DataError(
            f"accelerometers of opposite polarity: a hit moves {same_sign_names} along with it but "
            f"{opposite_names} against it; check the mounting and give the polarity, such as "
            f"{tuple(np.where(kick > 0, 1, -1).tolist())}"
        )
    return np.full(count, -1.0 if kick.min() < -POLARITY_SHARE else 1.0)


def _combine(
    transforms: ChannelSpectra, choices: AveragingOptions
) -> tuple[FloatArray, Combination | None]:
    """Return weights of the accelerometers, and the data on rocking."""
    count = len(transforms.channels)
    mean = np.full(count, 1 / count)
    if choices.combine in transforms.channels:
        return np.array([float(name == choices.combine) for name in transforms.channels]), None
    if count < 2:
        return mean, None
    band_transforms = transforms.band(*_find_mount_band(transforms))
    values = np.array([estimate(spectra) for spectra in band_transforms.split_channels()])
    errors = [
        random_error(spectra, value)
        for spectra, value in zip(band_transforms.split_channels(), values, strict=True)
    ]
    combination = compute_rocking_weights(
        FRFLines.from_measurement(
            band_transforms.s,
            values,
            None if band_transforms.averages < 2 else np.array(errors),
            record=band_transforms.record,
            pulse=band_transforms.pulse,
        ),
        band_transforms.response / band_transforms.force[None],
        choices.reach,
    )
    if choices.combine == "mean" or combination is None:
        return mean, combination
    return np.array(combination.weights), combination


def _find_mount_band(transforms: ChannelSpectra) -> tuple[float, float]:
    """The band in which the block moves on its mounts, from the accelerometer that moves most."""
    pairs = [(estimate(spectra), spectra) for spectra in transforms.split_channels()]
    value, spectra = max(pairs, key=lambda pair: float((np.abs(pair[0]) ** 2).sum()))
    return find_mount_band(transforms.frequency, value, random_error(spectra, value))


# Estimation of an FRF.


STILL_SHARE = 0.003  # of the response: less motion before a hit is left as it is


def estimate_frf(
    tests: ImpactTest | Sequence[ImpactTest],
    *,
    estimator: Estimator | str = Estimator.H1,
    window: str = "none",
    accept: Sequence[str] = (),
    reject: Sequence[str] = (),
    record: Quantity | None = None,
    pretrigger: Quantity | None = None,
    combine: str = "mean",
    mass: Quantity | None = None,
    polarity: Sequence[int] | None = None,
    band: Range | None = None,
    resonance_band: Range | None = None,
) -> FRF:
    r"""Estimate the accelerance a/F from hammer hits.

    Every hit is found, cut out with some quiet before it, judged, and averaged with the others:

    .. math:: H(s) = \frac{\mathcal{L}\{w a\}}{\mathcal{L}\{w F\}}, \qquad s = j\omega + a

    with w = 1 and a = 0, or :math:`w = e^{-at}` on force *and* response, so that the ratio is the
    true H on a shifted line for every linear solid; a is the result's `shift`. Offsets are taken
    from the pretrigger, before any window. There is no Hann window: it would erase the pulse.

    Parameters
    ----------
    tests : ImpactTest or sequence of ImpactTest
        With one or many hits in each continuous record.
    estimator : {"H1", "H2", "Hv", "Hs"}
        See :func:`dashpot.vibration.impact.spectral_estimators.estimate`.
    window : str
        ``"none"``, ``"force"``, ``"exponential"`` (as gentle as leaves 1 % at the end of the
        record), ``"exponential:0.01"`` (the window itself ends at 0.01), or
        ``"force+exponential"``.
    accept, reject : sequence of str
        Names of hits to take or leave whatever the verdict, as in the result's `hits`.
    record, pretrigger : float, optional
        Length of a block, and of the quiet in it before the hit, s.
    combine : str
        Accelerometers as one: ``"mean"`` as in the paper, ``"weighted"`` so that the rocking mode
        cancels, or the name of one channel.
    mass : float, optional
        Weighed mass of the block, kg, to check the calibration against the mass line.
    polarity : sequence of +1 and -1, optional
        Sign of each accelerometer; by default found from the direction in which a hit sets it
        moving.
    band : (float, float), optional
        Lines to keep, Hz; by default up to where the force spectrum has fallen by 20 dB.
    resonance_band : (float, float), optional
        Where the resonance lies that the checks are about, Hz; by default where the block moves
        most.

    Returns
    -------
    FRF
        Accelerance, 1/kg, with coherence, random error, hits, checks and steps.

    Raises
    ------
    DataError
        If there is no hit, none is accepted, names or channels are unknown, or accelerometers
        contradict each other in sign.

    References
    ----------
    ISO 7626-5:2019; D. J. Ewins, *Modal Testing*; paper, "Experimental setup".
    """
    record = convert_to_si(record, "time")
    pretrigger = convert_to_si(pretrigger, "time")
    mass = convert_to_si(mass, "mass")
    band, resonance_band = si_range(band, "frequency"), si_range(resonance_band, "frequency")
    tests = (tests,) if isinstance(tests, ImpactTest) else tuple(tests)
    require_positive(mass=mass, unit=" kg", optional=True)
    require_choice("estimator", estimator, Estimator)
    requested_window = Window.parse(window)
    hits = cut_hits(tests, record=record, pretrigger=pretrigger)
    accepted = _select_accepted_hits(hits, accept, reject)
    recorded = find_window(tests, [hit for hit, t in zip(hits, accepted, strict=True) if t])
    hits = tuple(without_offset(hit, recorded) for hit in hits)
    choices = AveragingOptions(
        estimator=Estimator(estimator),
        window=requested_window,
        combine=_validate_combination(combine, tests[0].channels),
        polarity=polarity,
        band=band,
        accept=tuple(accept),
        channels=tests[0].channels,
        reach=_get_reach(tests),
        recorded=recorded,
    )
    average = _average_without_ringing(
        average_hits(hits, accepted, choices), hits, accepted, choices
    )
    frf = replace(
        average.frf,
        hits=_make_hits(average),
        source=tuple(dict.fromkeys(source for test in tests for source in test.source)),
        steps=_make_steps(average, choices),
    )
    main_mode = next(iter(frf.modes(band=resonance_band)), None)
    if main_mode is not None:
        frf = replace_notes(frf, hits=add_resonances(frf, average.spectra, main_mode))
    checks = run_frf_checks(
        frf,
        average.spectra,
        choices.estimator,
        main_mode,
        combination=average.rocking,
        mass=mass,
        band=resonance_band,
    )
    if (
        recorded.rate > 0
        or not recorded.is_determined
        or recorded.evident
        or not recorded.has_noise
    ):
        checks = (*checks, window_decay_determined(recorded, main_mode))
    return replace_notes(frf, checks=(*checks, *caution_checks(frf.source)))


def _average_without_ringing(
    average: Average, hits: Sequence[HitBlock], accepted: BoolArray, choices: AveragingOptions
) -> Average:
    """Take off what still rings from hits before, where that is worth it."""
    if not any(
        compute_pre_hit_motion(b) > STILL_SHARE for b, t in zip(hits, accepted, strict=True) if t
    ):
        return average
    for _ in range(2):  # better poles take the earlier hit off better
        poles = _free_poles(average)
        hits_without_ringing = [remove_ringing(hit, poles) for hit in hits]
        if not any(hit.calmed for hit in hits_without_ringing):
            break
        average = average_hits(hits_without_ringing, accepted, choices)
    return average


def _free_poles(average: Average) -> list[complex]:
    """Poles of the block's free motions: of the FRF's modes, and of rocking that it cancels."""
    poles = [mode.pole for mode in average.frf.modes()]
    if average.rocking is not None:
        rocking = average.rocking.rocking
        if all(abs(p - rocking) > 0.02 * abs(p) for p in poles):
            poles.append(rocking)
    return poles


def _validate_combination(combine: str, channels: Sequence[str]) -> str:
    if combine not in ("mean", "weighted", *channels):
        raise DataError(
            f"combine = {combine!r}; expected 'mean', 'weighted' or a channel: "
            f"{', '.join(channels)}"
        )
    return combine


def _select_accepted_hits(
    hits: Sequence[HitBlock], accept: Sequence[str], reject: Sequence[str]
) -> BoolArray:
    faults = {hit.name: judge_hit(hit).faults for hit in hits}
    unknown = [name for name in (*accept, *reject) if name not in faults]
    if unknown:
        raise DataError(f"there is no hit {unknown[0]!r}; the hits are {', '.join(faults)}")
    accepted_names = {name for name, reasons in faults.items() if not reasons}
    accepted = (accepted_names - set(reject)) | set(accept)
    if not accepted:
        reasons_text = "; ".join(
            f"hit {name}: {'. Also: '.join(faults_of_hit) or 'rejected by name'}"
            for name, faults_of_hit in faults.items()
        )
        raise DataError(
            f"no hit is left to average. {reasons_text}. To use one anyway, accept it by name"
        )
    return np.isin([*faults], [*accepted])


def _get_reach(tests: Sequence[ImpactTest]) -> float | None:
    """Return how far the accelerometers are from the hammer's line, m, if that was given."""
    positions = tests[0].positions
    return None if positions is None else float(np.abs(positions).mean())


def _make_hits(average: Average) -> tuple[Hit, ...]:
    return tuple(
        Hit(
            name=hit.name,
            time=hit.time,
            accepted=bool(is_accepted),
            reasons=quality.reasons,
            peak=hit.peak,
            duration=hit.width(0.1),
        )
        for hit, quality, is_accepted in zip(
            average.hits, average.qualities, average.accepted, strict=True
        )
    )


def _make_steps(average: Average, choices: AveragingOptions) -> tuple[Step, ...]:
    name = choices.estimator.value
    return (
        _make_cut_step(average.hits),
        *_calm_steps(average.hits),
        *_recorded_steps(choices.recorded),
        *_window_steps(average.transforms.shift - choices.recorded.rate, choices.window),
        *_sign_steps(average),
        *_combine_steps(average, choices),
        Step(
            "estimate",
            (("estimator", name), *_build_acceptance_parameters(choices)),
            f"{name}, linear averages",
        ),
    )


def _build_acceptance_parameters(choices: AveragingOptions) -> tuple[tuple[str, str], ...]:
    """Return the hits that were to be used whatever is wrong with them, if any."""
    return (("accepted by name", ", ".join(choices.accept)),) if choices.accept else ()


def _make_cut_step(hits: Sequence[HitBlock]) -> Step:
    length, time_before = hits[0].length, hits[0].onset / hits[0].rate
    return Step(
        "cut",
        (
            ("hits", str(len(hits))),
            ("record", f"{length:.9g} s"),
            ("pretrigger", f"{time_before:.9g} s"),
        ),
        f"{len(hits)} hits in records of {length:.4g} s, "
        f"{format_quantity(time_before, 'ms', '.3g')} of "
        "each before the hit, from where the offsets were taken",
    )


def _calm_steps(hits: Sequence[HitBlock]) -> Iterator[Step]:
    names = ", ".join(hit.name for hit in hits if hit.calmed)
    if names:
        message = f"what still rang from the hit before was taken off hits {names}"
        yield Step("ringing", (("hits", names),), message)


def _recorded_steps(recorded: ExponentialWindow) -> Iterator[Step]:
    if recorded.rate <= 0:
        return
    origin = "its file or user states" if recorded.stated else "the decay of its noise shows"
    message = (
        f"the record carries an exponential window of {1 / recorded.rate:.4g} s, as {origin}: the "
        f"FRF is H at s = j omega + {recorded.rate:.4g} 1/s"
    )
    if not recorded.on_force:
        message += "; the force, which lacks it, was multiplied by the same"
    yield Step("recorded_window", (("decay", f"{recorded.rate:.9g} 1/s"),), message)


def _window_steps(decay: float, window: Window) -> Iterator[Step]:
    if window.force:
        yield Step("force_window", (), "after the pulse the force was faded to zero")
    if decay > 0:
        message = (
            f"force and response were multiplied by exp(-{decay:.4g} t / s): the FRF is H at "
            f"s = j omega + {decay:.4g} 1/s"
        )
        yield Step("exponential_window", (("decay", f"{decay:.9g} 1/s"),), message)
    elif window.exponential:
        message = "not needed: the response decays within the record"
        yield Step("exponential_window", (), message)


def _sign_steps(average: Average) -> Iterator[Step]:
    transforms = average.transforms
    if any(hit.turned for hit in average.hits):
        message = "the hammer was recorded negative; now pushing is positive"
        yield Step("hammer_sign", (), message)
    signs = zip(transforms.channels, transforms.signs, strict=True)
    reversed_names = ", ".join(name for name, sign in signs if sign < 0)
    if reversed_names:
        yield Step("polarity", (("turned", reversed_names),), f"{reversed_names}: sign turned")


def _combine_steps(average: Average, choices: AveragingOptions) -> Iterator[Step]:
    weights = list(zip(choices.channels, average.weights, strict=True))
    if len(weights) < 2:
        return
    message = f"response = {' + '.join(f'{w:.4g} {name}' for name, w in weights if w)}"
    if choices.combine == "weighted" and average.rocking is None:
        message += ": the plain mean, since no rocking was found to cancel"
    yield Step("combine", tuple((name, f"{w:.9g}") for name, w in weights), message)
