"""The page of each kind of result: what its line of facts, lights, figure and table are."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import singledispatch
from typing import Any

import numpy as np

from dashpot import plot
from dashpot.base.facts import Fact
from dashpot.base.numbers import counted, duration, hertz, rounded, shown
from dashpot.base.offered import Judged
from dashpot.base.provenance import sources_of
from dashpot.base.units import celsius, in_unit, read_in, written
from dashpot.fitting.uncertainty.prediction_bounds import parameter_band, unseen_arm_band
from dashpot.kinds.cld.from_files import Pieces
from dashpot.kinds.csr.record import Aging
from dashpot.kinds.hyperelastic.record import HyperelasticFit
from dashpot.kinds.indentation.record import IndentationFit
from dashpot.kinds.level.record import AmplitudeFit
from dashpot.plot.picture import Span, unit_of
from dashpot.records.fit import Fit
from dashpot.records.relaxation import RampHold
from dashpot.report.answer import NBSP, Light, Row
from dashpot.report.figures import LEAD
from dashpot.report.kind_page import (
    Fold,
    Group,
    KindPage,
    group,
    lights,
    row,
    sources_behind,
    who,
)
from dashpot.report.level import beyond, numbers
from dashpot.report.tables import TextTable
from dashpot.workflow.impacts import Agreement, Identified
from dashpot.workflow.levels import Levels
from dashpot.workflow.modes import Modes
from dashpot.workflow.predictions import Prediction
from dashpot.workflow.rods import Rod
from dashpot.workflow.under_masses import ModesByMass

_LINES, _BEYOND, _BOUNDED = 41, 4.0, 3
"""Lines of a bound, how far beyond the band it is drawn, and of how many tests at most."""

_FEW_ARMS = 6
"""Of more the single arms stand in a fold: they mean little, and the screen is full."""

_REST = frozenset({
    "k_inf_known", "k_inf_positive", "k_inf_believable", "plateau_told", "end_level",
    "strain_small", "hold_long_enough", "tangent_told", "stiffness_of_one_seal", "flow_told",
    "creep_finished",
})  # fmt: skip
_LOSS = frozenset({
    "fast_arm_visible", "frequencies_informed", "loss_positive", "kramers_kronig", "arms_distinct",
    "arms_supported", "tau_inside_window", "arms_where_force_relaxes", "arms_identified",
    "dashpot_not_missed", "few_arms_suffice",
})  # fmt: skip
_SHIFTS = frozenset({
    "shifts_determined", "shift_monotone", "law_follows_shifts", "temperatures_in_line",
    "glass_below_tests", "shifts_told_apart",
})  # fmt: skip
_CURVE = frozenset({
    "overlap", "thermorheologically_simple", "vertical_shift_known", "vertical_rule_holds",
})  # fmt: skip
_PEAK = frozenset({"prediction_informed", "seal_mass_negligible", "mass_of_a_block"})
_HITS = frozenset({"hits_enough", "hits_agree", "rocking_cancelled", "hits_centred"})
_RESONANCE = frozenset({
    "resonance", "record_long_enough", "lines_in_half_power_band", "amplitude_linear",
})  # fmt: skip


@singledispatch
def kind_page(found: Any) -> KindPage:
    """Return what the page of a result holds; of one without a page of its own, its facts.

    Raises
    ------
    TypeError
        If it is no result that was judged, or tells no number.
    """
    facts = found.facts if isinstance(found, Judged) else ()
    if not facts:
        raise TypeError(f"a {type(found).__name__} has no page")
    picture = found.plot()
    return KindPage(
        about=picture.name.replace("-", " "),
        strip=(*who(getattr(found, "specimen", None)), ("Numbers", str(len(facts)))),
        lights=lights(found.checks, {"Checks": frozenset()}),
        answers="Measured and fitted",
        picture=picture,
        told="What was found",
        groups=(group("", facts),),
        sources=sources_behind(found),
        name=picture.name,
    )


# -- solids ---------------------------------------------------------------------------------------


@kind_page.register
def _(found: Fit) -> KindPage:
    return _solid(found, found)


@kind_page.register
def _(found: Identified) -> KindPage:
    page = _solid(found, found.fit)
    both = "relaxation" in found.fit.method or len(page.sources) > 1
    modes = Group(
        "Measured", tuple(r for one in found.vibration.modes for r in _mode_rows(one.mode))
    ) if found.vibration else None  # fmt: skip
    return replace(
        page,
        about="one solid of both tests" if both else "the solid under a hammer",
        groups=(*page.groups, *((modes,) if modes else ())),
        sources=tuple(dict.fromkeys((*page.sources, *found.direct.of.source)))
        if hasattr(found.direct.of, "source") else page.sources,
        name="joint" if both else "fit",
    )  # fmt: skip


def _solid(found: Fit | Identified, fit: Fit) -> KindPage:
    """A page of a solid: stiffness and loss over frequency, its arms one by one."""
    material, moved = fit.unit == "Pa", fit.temperatures
    name = "The material" if material else "One seal"
    high = rounded(fit.band[1], digits=2)
    at_end = fit.end_of_hold
    known = at_end.fact(fit.model, fit.unit) if at_end else next(iter(fit.facts), None)
    stiff = "" if known is None else f"{known.cells.value} {known.word}"
    if moved is None:
        asked = {"Test": frozenset[str](), "Stiffness": _REST, "Damping": _LOSS}
        says: tuple[str, ...] = ("", stiff, f"known to {high}{NBSP}Hz")
    else:
        asked = {"Test": frozenset[str](), "Superposition": _CURVE, "Shifts": _SHIFTS,
                 "Arms": _LOSS | _REST}  # fmt: skip
        says = ("", "one curve", _law_of(fit), counted(fit.model.arms, "arm"))
    strip = [*who(fit.specimen), *_pressed(fit), ("Valid band", hertz(fit.band)),
             ("Fit", fit.identity[:8])]  # fmt: skip
    return KindPage(
        about="master curve" if moved is not None and material else _tested(fit),
        strip=tuple(strip),
        lights=lights(found.checks, asked, says),
        answers=f"What {name.lower()} does at each frequency",
        picture=over_frequency(fit),
        told=f"{name}, {_called(fit)}",
        groups=tuple(_of_solid(fit)),
        note="From and to are the 95 % interval; at the end of the test and at rest they are the "
        "bound that it leaves." if at_end else KindPage.note,
        sources=tuple(dict.fromkeys(fit.source)),
        folds=tuple(_more_of_solid(fit)),
        name="fit",
    )  # fmt: skip


def over_frequency(fit: Fit, records: Sequence[Any] = ()) -> plot.Picture:
    """Storage and loss factor over frequency, one above the other, and what is known of them.

    Parameters
    ----------
    fit : Fit
    records : sequence
        Behind it: of ramps and holds the bound over unresolved arms is drawn too.
    """
    low, high = fit.band
    lines = np.geomspace(max(low, 1e-9) / _BEYOND, high * (_BEYOND * 10), _LINES)
    held = [one for one in records if isinstance(one, RampHold)]
    unseen = None
    if held and len(held) == len(records) <= _BOUNDED:
        unseen = unseen_arm_band(fit, held, lines)
    known = parameter_band(fit, lines) if fit.parameters else None
    drawn = plot.stiffness(fit, parameters=known, unseen=unseen)
    (storage,), _, (loss,) = drawn.strips
    low_end = (float(lines[0]), float(lines[-1]))
    stacked = tuple(
        replace(panel, x=replace(panel.x, limits=low_end), height=height,
                marks=(Span(low, high, "fit", "valid band", tint=0.06), *panel.marks))
        for panel, height in ((storage, 150.0), (loss, 170.0))
    )  # fmt: skip
    return replace(drawn, strips=(stacked,), columns=1, width=LEAD)


def _law_of(fit: Fit) -> str:
    law = "" if fit.temperatures is None else fit.temperatures.law.kind
    return {"wlf": "WLF holds", "arrhenius": "Arrhenius holds"}.get(law, "each its own")


def _tested(fit: Fit) -> str:
    made = {"dynamic": "dynamic sweep", "creep": "creep test"}.get(fit.method, "relaxation test")
    several = len(fit.source)
    return made if several < 2 else f"{several} files, {made}s"


def _called(fit: Fit) -> str:
    return "fractional solid" if fit.family == "fractional" else counted(fit.model.arms, "arm")


def _pressed(fit: Fit) -> Iterator[tuple[str, str]]:
    """Facts of a fit beside its specimen: the hold, the temperatures."""
    if fit.end_of_hold is not None and fit.method != "dynamic":
        yield "Held", duration(fit.end_of_hold.time)
    if fit.temperatures is not None:
        every = [one.temperature for one in fit.temperatures.shifts]
        ends = " to ".join(
            rounded(in_unit(one, "°C"), digits=3) for one in (min(every), max(every))
        )
        yield "Reference", written(fit.temperatures.reference, "°C", ".4g")
        yield "Temperatures", f"{len(every)}, {ends} °C"


def _of_solid(fit: Fit) -> Iterator[Group]:
    """Stiffness at the end and at rest, stiffness and loss within the band, arms, shifts."""
    known = {one.name: one for one in fit.known}
    first: list[Row] = []
    if fit.end_of_hold is not None:
        fact = fit.end_of_hold.fact(fit.model, fit.unit)
        seconds = duration(fit.end_of_hold.time).replace(".0 ", NBSP)
        first.append(row(fact, f"After {seconds}") if fit.residual.unit == "N" else row(fact))
        known.pop(fact.name, None)
    if "k_inf" in known:
        first.append(row(known.pop("k_inf"), "At rest, k∞"))
    yield Group("Stiffness" if fit.unit != "Pa" else "Modulus", tuple(first))
    yield Group("Inside the valid band", tuple(_in_band(fit)))
    others = [one for name, one in known.items() if not name.startswith("b_")]
    if fit.model.arms <= _FEW_ARMS or fit.family == "fractional":
        yield group("Arms: k, τ", others) if others else Group("", ())
    elif not fit.parameters:
        yield group("Spectrum", others)
    if fit.temperatures is not None:
        yield from _of_temperatures(fit)


def _in_band(fit: Fit) -> Iterator[Row]:
    """Storage and loss factor at the middle of the band, with what the parameters leave open."""
    low, high = fit.band
    if not (0 < low < high):
        return
    at = float(f"{math.sqrt(low * high):.1g}")
    band = parameter_band(fit, [at]) if fit.parameters else None
    letter = "E" if fit.unit == "Pa" else "K"
    for words, name, unit in (
        (f"{letter}′", "storage", fit.unit),
        ("Loss factor", "loss_factor", ""),
    ):
        value = float(getattr(fit.solid, name)(frequency=at))
        least, most = (math.nan,) * 2 if band is None else getattr(band, name)[:, 0].tolist()
        yield row(Fact(f"{words} at {at:g}{NBSP}Hz", value, least, most, unit))


def _of_temperatures(fit: Fit) -> Iterator[Group]:
    moved = fit.temperatures
    assert moved is not None  # noqa: S101
    if moved.constants:
        law = {"wlf": "WLF", "arrhenius": "Arrhenius"}.get(moved.law.kind, "law")
        yield group(f"{law} about {written(moved.reference, '°C', '.4g')}", moved.constants)
    every = moved.shifts
    ends = every if len(every) <= _FEW_ARMS // 2 else (every[0], every[len(every) // 2], every[-1])
    yield Group(
        "Shift, log₁₀ a_T",
        tuple(row(one.facts[0], f"At {celsius(one.temperature)}") for one in ends),
    )


def _more_of_solid(fit: Fit) -> Iterator[Fold]:
    if fit.parameters:
        yield Fold(
            "Every parameter",
            f"{_called(fit)}, each with its standard error; residual "
            f"{rounded(fit.residual.rms * (1e3 if fit.residual.unit == 'N' else 1), digits=3)} "
            f"{'mN' if fit.residual.unit == 'N' else fit.residual.unit}",
            _fact_table(fit.known),
        )
    else:
        arms = tuple(
            (str(j), rounded(in_unit(k, read_in(fit.unit))), f"{tau:.4g}")
            for j, (k, tau) in enumerate(zip(fit.model.k, fit.model.tau, strict=True), start=1)
        )
        head = ("arm", f"k, {read_in(fit.unit)}", "τ, s")
        yield Fold(
            "Every arm", "none has a meaning of its own: use the table", TextTable(head, arms)
        )
    if fit.temperatures is not None:
        shifts = tuple(
            (written(one.temperature, "°C", ".4g"), along.cells.value, along.cells.error,
             across.cells.value)
            for one in fit.temperatures.shifts for along, across in (one.facts,)
        )  # fmt: skip
        names = ("temperature", "log₁₀ a_T", fit.shift_error, "b_T")
        yield Fold("Every temperature", f"{len(shifts)} shifts", TextTable(names, shifts))


def _fact_table(facts: Sequence[Fact]) -> TextTable:
    rows = tuple((one.symbol, *one.cells[1:]) for one in facts)
    return TextTable(("", "value", "± SE", "95 % interval", "unit"), rows)


# -- vibration ------------------------------------------------------------------------------------


def _mode_rows(mode: Any) -> Iterator[Row]:
    frequency, ratio, _ = mode.facts
    yield row(frequency, "Natural frequency")
    yield row(ratio, "Damping ratio")


@kind_page.register
def _(found: Modes) -> KindPage:
    frf, first = found.frf, next(iter(found), None)
    used = f"{frf.averages} of {len(frf.hits)} used" if frf.hits else counted(1, "FRF")
    says = (
        used,
        "" if first is None else f"{rounded(first.frequency, digits=4)}{NBSP}Hz",
        f"to {rounded(float(frf.frequency[-1]), digits=3)}{NBSP}Hz",
    )
    reach = frozenset({"coherence", "hammer_excites", "mass_line", "scatter_known"})
    asked = {"Hits" if frf.hits else "FRF": _HITS, "Resonance": _RESONANCE, "Band": reach}
    # what neither names is of the hits
    hits = tuple(
        (one.name, f"{one.time:.3f}", rounded(one.peak, digits=3),
         rounded(in_unit(one.duration, "ms"), digits=3),
         "accepted" if one.accepted else f"rejected: {'; '.join(one.reasons)}")
        for one in frf.hits
    )  # fmt: skip
    marks = tuple("" if one.accepted else "bad" for one in frf.hits)
    head = ("hit", "time, s", "peak, N", "pulse, ms", "verdict")
    fold = Fold("Every hit", used, TextTable(head, hits, marks))
    return KindPage(
        about="hammer test" if frf.hits else "measured FRF",
        strip=(("Hits", used), ("Averages", str(frf.averages)),
               ("Lines", str(len(frf.frequency))),
               ("Resolution", f"{frf.frequency[1] - frf.frequency[0]:.3g} Hz"),
               ("Quantity", frf.quantity.value.replace("_", " "))),
        lights=lights(found.checks, asked, says),
        answers="Measured response",
        picture=found.plot(),
        told=counted(len(found), "mode").capitalize(),
        groups=tuple(Group(f"Mode {i}", tuple(_mode_rows(one)))
                     for i, one in enumerate(list(found)[:4], start=1)),
        sources=tuple(dict.fromkeys(frf.source)),
        folds=(fold,) if hits else (),
        name="modes",
    )  # fmt: skip


@kind_page.register
def _(found: Prediction) -> KindPage:
    hz, height = found.peak
    weight = (
        f"{shown(found.mass, 'g', digits=4)} on {counted(int(found.seals), 'seal')}"
        if found.seals == int(found.seals)
        else shown(found.mass, "g", digits=4)
    )
    asked = {"Test": frozenset[str](), "Peak": _PEAK, "Rest": frozenset({"compression_tested"})}
    says = ("", f"{rounded(hz, digits=4)}{NBSP}Hz", "within the depth tested")
    peak: list[Row] = []
    bounds = found.limits
    for name, value, ends, unit in (
        ("Largest at" if found.at_edge else "Peak frequency", hz,
         None if bounds is None else bounds.peak_frequency, "Hz"),
        ("Height", height, None if bounds is None else bounds.peak_height, ""),
    ):  # fmt: skip
        low, high = ends or (math.nan, math.nan)
        told = row(Fact(name, value, low, high, unit))
        unit_of_height = found.frf.unit.replace("(m/s^2)/N", "1/kg")
        peak.append(told._replace(unit=told.unit or unit_of_height, bound=ends is not None))
    return KindPage(
        about=f"prediction of {weight}",
        strip=(*who(found.fit.specimen), ("Mass", weight),
               ("Valid band", hertz(found.fit.band)), ("Fit", found.fit.identity[:8])),
        lights=lights(found.checks, asked, says),
        answers="Predicted response",
        picture=found.plot(),
        told=f"{weight[:1].upper()}{weight[1:]}",
        groups=(Group("Peak", tuple(peak)),
                *(Group(f"At {one.level:.4g} {one.unit}", tuple(row(fact) for fact in one.facts))
                  for one in found.preloaded),
                *(Group(f"Mode {i}", tuple(_mode_rows(one)))
                  for i, one in enumerate(found.modes[:3], start=1))),
        note=("Hatched: what the relaxation test does not exclude." if bounds is not None else
              "No bound is known without the record behind the fit.")
        if found.limits is not None or found.interval is None else KindPage.note,
        sources=tuple(dict.fromkeys(found.fit.source)),
        name="prediction",
    )  # fmt: skip


@kind_page.register
def _(found: Agreement) -> KindPage:
    c = found.comparison
    rows = tuple(Row(name, predicted, "", "", "", measured, bound=False)
                 for name, predicted, measured, _ in c.rows)  # fmt: skip
    differ = tuple((name, predicted, measured, off) for name, predicted, measured, off in c.rows)
    asked = {
        "FRF": frozenset[str](),
        "Stiffness": frozenset({"stiffness_agrees"}),
        "Damping": frozenset({"peak_agrees", "damping_agrees"}),
    }
    weight = f"{shown(found.mass, 'g', digits=4)} on {found.seals:g} seals"
    return KindPage(
        about=f"prediction against the hammer, {weight}",
        strip=(("Mass", weight), ("Lines", str(len(c.measured.frequency))),
               ("Mass was", "found from the FRF" if found.mass_inferred else "given")),
        lights=lights(found.checks, asked, ("", "agrees", "agrees")),
        answers="Measured against predicted",
        picture=found.plot(),
        told="Predicted",
        groups=(Group("", tuple(one._replace(unit=one.measured, measured="") for one in rows)),),
        note="The last column is what the hammer measured.",
        sources=tuple(dict.fromkeys(c.measured.source)),
        folds=(Fold("How far apart", c.lines,
                    TextTable(("", "predicted", "measured", "difference"), differ)),),
        name="comparison",
    )  # fmt: skip


@kind_page.register
def _(found: ModesByMass) -> KindPage:
    of = found.together
    facts = tuple(
        Group(shown(mass, "g", digits=4), tuple(_mode_rows(mode)))
        for mass, mode in zip(of.masses, of.modes, strict=True)
    )
    return KindPage(
        about=f"one solid under {counted(len(of.masses), 'mass').replace('masss', 'masses')}",
        strip=(("Masses", ", ".join(shown(one, "g", digits=4) for one in of.masses)),),
        lights=lights(found.checks, {"FRFs": frozenset(), "One solid": frozenset({"one_solid"})}),
        answers="The response under each mass",
        picture=found.plot(),
        told="Resonance under each mass",
        groups=facts,
        sources=tuple(dict.fromkeys(s for one in found.tests for s in one.frf.source)),
        name="masses",
    )


# -- the others -----------------------------------------------------------------------------------


@kind_page.register
def _(found: Levels) -> KindPage:
    fit = found.fit
    stiff = {"level_matters", "softening_seen", "law_followed", "levels_followed", "spring_unseen"}
    loss = frozenset({"loss_followed"})
    asked = {"Record": frozenset[str](), "Stiffness": frozenset(stiff), "Damping": loss}
    if not any(one.name in loss for one in found.checks):
        del asked["Damping"]
    low, high = fit.amplitudes
    word, scale = unit_of(np.array(fit.amplitudes), "m")
    if isinstance(fit, AmplitudeFit) and fit.of == "strain":
        word, scale = "%", 100.0
    every = ("Amplitudes", f"{rounded(scale * low)} to {rounded(scale * high)} {word}")
    frequencies: tuple[tuple[str, str], ...] = ()
    if isinstance(fit, AmplitudeFit):
        told = ", ".join(rounded(one) for one in fit.frequency[:4].tolist())
        frequencies = (("Frequency", f"{told} Hz"),)
    picture = plot.level(fit, found.records)
    return KindPage(
        about="levels of a hammer or shaker" if picture.name == "levels" else "amplitude sweep",
        strip=(*who(getattr(found.records[0], "specimen", None)), *frequencies, every),
        lights=lights(found.checks, asked),
        answers="Stiffness and loss with amplitude",
        picture=picture,
        told="What amplitude does",
        groups=(group("", numbers(found)),),
        note=beyond(found),
        sources=tuple(dict.fromkeys(found.source)),
        name="levels",
    )


@kind_page.register
def _(found: Pieces) -> KindPage:
    first, several = found.pieces[0], len(found.pieces)
    sources = sources_of(found.pieces)
    able = found.capability
    asked = {
        "Records": frozenset[str](),
        "Pieces": frozenset({"pieces_tested_alike"}),
        "Capability": frozenset({"pieces_capable"}),
    }
    said = "" if able is None else able.says
    shown_lights = lights(
        found.checks, asked, ("", f"{several} tested alike", said), ("", "", said)
    )
    if able is None:
        shown_lights = (*shown_lights[: 1 + (several > 1)],
                        Light("Capability", "note", "no limits given"))  # fmt: skip
    asked_for = [("Nominal", written(first.nominal.compression, "mm"))]
    if first.least is not None and first.most is not None:
        ends = " to ".join(
            f"{in_unit(one.compression, 'mm'):.4g}" for one in (first.least, first.most)
        )
        asked_for.append(("Tolerance", f"{ends} mm"))
    length = first.specimen.length
    asked_for.append(("Length", "not given" if length is None else written(length, "mm")))
    limits = None if able is None else (able.lower, able.upper)
    return KindPage(
        about=f"compression load deflection, {counted(several, 'piece')}",
        strip=(*who(first.specimen), *asked_for, ("Pieces", str(several))),
        lights=shown_lights,
        answers="Pressed and released",
        picture=plot.cld(found.pieces, limits=limits),
        told=f"Of {'100 mm' if length is not None else 'the piece'}"
        + (f", mean of {counted(several, 'piece')}" if several > 1 else ""),
        groups=(Group("", tuple(_of_pieces(found))),),
        note=f"From and to: 95 % interval of the mean of {counted(several, 'piece')}."
        if several > 1 else KindPage.note,
        sources=sources,
        folds=(Fold("Each piece and cycle", "force, slope, hysteresis, set; one row a cycle",
                    _cycles(found)),),
        name="cld",
    )  # fmt: skip


def _of_pieces(found: Pieces) -> Iterator[Row]:
    """Mean of each figure with its interval; of one piece its own."""
    if found.scatter:
        for each in found.scatter:
            fact = each.fact
            # what is of 100 mm stands in the heading
            unit = fact.word.partition(" per ")[0]
            yield row(fact, each.name.capitalize())._replace(unit=unit)
        return
    one = found.pieces[0]
    for at in one.marked:
        where = written(at.compression, "mm", ".4g").replace(" ", NBSP)
        force = Fact.normal("", one.per * at.loading, one.per * at.loading_se, "N")
        slope = Fact.normal("", one.per * at.slope, one.per * at.slope_se, "N/m")
        yield row(force, f"Force at {where}")
        yield row(slope, f"Slope at {where}")
    if one.cycle.hysteresis is not None:
        yield row(Fact("", one.cycle.hysteresis, unit="1", read="%"), "Hysteresis")
    if one.set is not None:
        yield row(Fact("", one.set, unit="m"), "Set")


def _cycles(found: Pieces) -> TextTable:
    rows = []
    for one in found.pieces:
        name = "" if one.source is None else one.source.file
        for each in one.cycles:
            lost, met = each.hysteresis, each.contact
            rows.append((
                name, str(each.number), rounded(in_unit(each.depth, "mm")), rounded(each.peak),
                rounded(in_unit(each.energy, "mJ")),
                "" if lost is None else rounded(100 * lost, digits=3),
                "" if met is None else rounded(in_unit(met, "mm"), digits=3),
            ))  # fmt: skip
    head = ("piece", "cycle", "depth, mm", "peak, N", "energy, mJ", "hysteresis, %", "met, mm")
    return TextTable(head, tuple(rows))


@kind_page.register
def _(found: HyperelasticFit) -> KindPage:
    use = frozenset({"stable_in_use", "use_measured", "volume_known"})
    law = frozenset({"law_followed", "no_law_closer", "constants_known", "modes_enough",
                     "modes_told"})  # fmt: skip
    asked = {"Curves": frozenset[str](), "Law": law, "Use": use}
    left = f"{rounded(100 * max(found.residuals), digits=2)} % left"
    curves = tuple(
        (one.mode, "" if one.source is None else one.source.file,
         f"{one.stretch.min():.4g} to {one.stretch.max():.4g}", str(one.rows),
         rounded(100 * residual, digits=3))
        for one, residual in zip(found.curves, found.residuals, strict=True)
    )  # fmt: skip
    warm = found.temperature
    return KindPage(
        about=f"stress over strain, {counted(len(found.curves), 'curve')}",
        strip=(("Law", found.law.kind), ("Curves", ", ".join(one.mode for one in found.curves)),
               ("Temperature", "not given" if warm is None else written(warm, "°C", ".1f"))),
        lights=lights(found.checks, asked, ("", left, "stable where used")),
        answers="Stress over stretch",
        picture=found.plot(),
        told=f"The {found.law.kind} law",
        groups=(group("", found.found),),
        sources=found.sources,
        folds=(Fold("Each curve", "stretches, rows, residual",
                    TextTable(("test", "file", "stretch", "rows", "residual, %"), curves)),
               _tried(found.orders)),
        name="hyperelastic",
    )  # fmt: skip


def _tried(orders: Sequence[tuple[str, float]]) -> Fold:
    least = min(score for _, score in orders)
    rows = tuple(
        (name, rounded(score - least)) for name, score in sorted(orders, key=lambda o: o[1])
    )
    return Fold(
        "Laws tried", "BIC above the least", TextTable(("law", "BIC above the least"), rows)
    )


@kind_page.register
def _(found: IndentationFit) -> KindPage:
    law = frozenset({"law_followed", "parameters_known", "laws_agree", "indentation_shallow"})
    asked = {"Record": frozenset[str](), "Law": law}
    left = f"{rounded(100 * found.residual, digits=2)} % left"
    return KindPage(
        about="contact of an indenter",
        strip=(
            ("Law", found.law),
            ("Recorded", found.of),
            ("Contact", duration(found.duration)),
            ("Indenter", "" if found.indenter.mass is None else shown(found.indenter.mass, "g")),
        ),
        lights=lights(found.checks, asked, ("", left)),
        answers="The contact, recorded and fitted",
        picture=found.plot(),
        told=f"The {found.law} law",
        groups=(group("", found.found),),
        sources=sources_behind(found),
        folds=(_tried(found.orders),),
        name="indentation",
    )


@kind_page.register
def _(found: Rod) -> KindPage:
    of = found.modulus
    low, high = of.band
    usable = bool(of.usable.any())
    asked = {
        "Record": frozenset[str](),
        "Modulus": frozenset({"rod_usable", "waves_plane", "mass_beside_rod", "sensors_agree"}),
        "Solid": _REST | _LOSS | {"lines_of_one_solid", "residuals_random", "optimum_found",
                                  "storage_rises"},
    }  # fmt: skip
    says = ("", f"{low:.3g} to {high:.3g}{NBSP}Hz" if usable else "", "")
    groups: list[Group] = []
    if usable:
        lines = np.flatnonzero(of.usable)
        for i in dict.fromkeys((lines[0], lines[len(lines) // 2], lines[-1])):
            hz = f"At {rounded(float(of.frequency[i]), digits=3)}{NBSP}Hz"
            groups.append(Group(hz, (
                row(Fact.normal("E′", float(of.storage[i]), float(of.storage_sd[i]), "Pa")),
                row(Fact.normal("Loss factor", float(of.loss_factor[i]),
                                float(of.loss_factor_sd[i]))),
            )))  # fmt: skip
    if found.fit is not None:
        groups += [one for one in _of_solid(found.fit) if one.title.startswith(("Arms", "Modulus"))]
    return KindPage(
        about="rod under a mass",
        strip=(("Mass", shown(found.mass, "g", digits=4)), ("Rod", shown(found.own_mass, "g")),
               ("Ends", "bonded" if found.bonded else "sliding"),
               ("Known to 10 %", f"{low:.3g} to {high:.3g} Hz" if usable else "nowhere")),
        lights=lights(found.checks, asked, says),
        answers="The modulus of the material",
        picture=found.plot(),
        told="The material",
        groups=tuple(groups),
        note="From and to: 95 %, of all errors of the test together.",
        sources=tuple(dict.fromkeys(found.frf.source)),
        name="rod",
    )  # fmt: skip


@kind_page.register
def _(found: Aging) -> KindPage:
    asked = {"Readings": frozenset[str](),
             "Ovens": frozenset({"ovens_enough", "ovens_on_a_line"}),
             "Chemistry": frozenset({"chemistry_seen", "aging_beside_drift"})}  # fmt: skip
    warm = [one.temperature for one in found.ovens]
    ends = " to ".join(f"{in_unit(one, '°C'):.4g}" for one in (warm[0], warm[-1]))
    return KindPage(
        about="compression stress relaxation",
        strip=(("Ovens", f"{len(warm)}, {ends} °C"),
               ("Longest", written(found.longest, "h", ".4g")),
               ("Scatter", f"{100 * found.scatter:.2g} % of F0")),
        lights=lights(found.checks, asked, ("", f"{len(warm)} on one line", "seen")),
        answers="What is left of the force",
        picture=found.plot(),
        told="The law of aging",
        groups=(group("", found.facts),),
        sources=found.sources,
        folds=(_tried(found.orders),),
        name="csr",
    )  # fmt: skip
