"""Files of ``dashpot export --draws``: a solver input of each draw, and their index."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dashpot.base import dataclass
from dashpot.base.checks import Check, verdict
from dashpot.base.errors import ExportError
from dashpot.base.serialisation import Serialisable
from dashpot.cli._command_result import CommandResult, claim_outputs, write_output
from dashpot.cli._terminal import to_stderr
from dashpot.datamodel.fit import Fit
from dashpot.export import deck_for, uses_argument
from dashpot.export.unit_systems import UnitSystem, text, unit_system
from dashpot.extensions.solver_inputs.draws.checks import unresolved_arm_drawn
from dashpot.extensions.solver_inputs.draws.drawn_solids import (
    DrawnSolid,
    choose_unresolved_times,
    draw_solids,
    replace_solid,
)
from dashpot.fitting.input_tests import ramp_holds
from dashpot.text_output.layout import Text
from dashpot.vibration.mass_on_seals import model_modes
from dashpot.workflow.bench_tests import prepared_files, refuse_unfitted_tests

DRAW_OPTIONS = ("draws", "seed", "record")
"""The options of draws among those of ``dashpot export``."""
_FACTOR_LIMIT = 0.3
"""A larger standard deviation of a logarithm is printed as a factor."""


@dataclass(frozen=True)
class MassPeak:
    """Resonance of a mass on the seals, Hz, and its damping ratio."""

    frequency: float
    damping_ratio: float


@dataclass(frozen=True)
class Draws(Serialisable):
    """Solver inputs drawn from the uncertainty of a fit.

    Attributes
    ----------
    target : str
    file : str
        Deck of the fit itself.
    files : tuple of str
        One of each draw.
    index : str
        The table of the peak of each draw.
    seed : int
    peak, damping_ratio : float
        Peak and damping ratio of the fit itself, Hz and dimensionless.
    ln_peak_sd, ln_damping_sd : float
        Standard deviations of their logarithms over the draws.
    """

    schema = "dashpot/draws@1"
    _is_loadable = False

    target: str
    file: str
    files: tuple[str, ...]
    index: str
    seed: int
    peak: float
    damping_ratio: float
    ln_peak_sd: float
    ln_damping_sd: float


def export_draws(
    target: str,
    fit: object,
    output: str,
    choices: Mapping[str, Any],
) -> CommandResult:
    """Write the solver input of a fit, those of its draws, and their index in the same folder.

    Parameters
    ----------
    target, output : str
    fit : Fit
    choices : mapping
        The options of ``dashpot export``.

    Raises
    ------
    ExportError
        If there is no covariance, mass or file, or the mass does not resonate.
    """
    mass = choices["mass"]
    if not isinstance(fit, Fit) or fit.unit != "N/m":
        raise ExportError("--draws needs the fit of a part, with its covariance, in N/m")
    if output == "-":
        raise ExportError("--draws writes several files; name the first: -o FILE")
    if mass is None:
        raise ExportError("--draws needs the mass on the seals, whose peak the index lists: --mass")
    draw_options = {name: value for name, value in choices.items() if name not in DRAW_OPTIONS}
    if not uses_argument(target, "mass"):
        del draw_options["mass"]
    count, seed = choices["draws"], choices["seed"] or 0
    path = Path(output)
    files = [
        path.with_name(f"{path.stem}_draw_{number:0{len(str(count))}d}{path.suffix}")
        for number in range(1, count + 1)
    ]
    index = path.with_name(f"{path.stem}_draws.csv")
    claim_outputs([*files, index])
    fit_deck = deck_for(target, fit, **draw_options)
    peak_of = _PeakFinder(mass, choices["seals"], choices["compression"], choices["temperature"])
    peak = peak_of(fit)
    times = choose_unresolved_times(fit, peak.frequency)
    records = ramp_holds(prepared_files([choices["record"]])) if choices["record"] else ()
    if records:
        refuse_unfitted_tests(records, fit)
    solids_drawn = draw_solids(fit, count, seed=seed, records=records, times=times)
    fits = [replace_solid(fit, draw, count=count, seed=seed) for draw in solids_drawn]
    peaks = [peak_of(fit_drawn) for fit_drawn in fits]
    check = unresolved_arm_drawn(int(times is not None), peak.frequency, has_record=bool(records))
    write_output(output, fit_deck.file_content)
    for file, fit_drawn in zip(files, fits, strict=True):
        write_output(file, deck_for(target, fit_drawn, **draw_options).file_content)
    table = format_index(
        unit_system(choices["units"]),
        [
            (path.name, None, fit, peak),
            *zip([file.name for file in files], solids_drawn, fits, peaks, strict=True),
        ],
    )
    write_output(index, table)
    for override in fit_deck.overrides:
        to_stderr(f"OVERRIDE: {override}")
    log_values = np.log([(peak.frequency, peak.damping_ratio) for peak in peaks])
    frequency_sd, damping_sd = (float(sd) for sd in log_values.std(axis=0, ddof=1))
    result = Draws(
        target, output, tuple(map(str, files)), str(index), seed, peak.frequency,
        peak.damping_ratio, frequency_sd, damping_sd,
    )  # fmt: skip
    checks: tuple[Check, ...] = (*fit_deck.checks, check)
    low, high = (choose(peak.frequency for peak in peaks) for choose in (min, max))
    lowest, highest = (choose(peak.damping_ratio for peak in peaks) for choose in (min, max))
    frequencies = f"{peak.frequency:.5g} Hz, {low:.4g} to {high:.4g} Hz"
    damping = f"{peak.damping_ratio:.3g}, {lowest:.3g} to {highest:.3g}"
    lines = [
        f"{count} draws for {target}, seed {seed}: {files[0]} to {files[-1].name}",
        f"  peak           {frequencies}; {_format_spread(frequency_sd)}",
        f"  damping ratio  {damping}; {_format_spread(damping_sd)}",
        f"  index          {index}",
    ]
    return CommandResult(
        result, Text(lines), checks, verdict=verdict(checks, headline=fit._headline)
    )


def _format_spread(ln_sd: float) -> str:
    """Return the standard deviation of a logarithm as a percentage, or as a factor."""
    if ln_sd < _FACTOR_LIMIT:
        return f"standard deviation {100 * ln_sd:.2g} %"
    return f"standard deviation a factor of {np.exp(ln_sd):.3g}"


class _PeakFinder:
    """Resonance of a mass on seals, at a compression and a temperature."""

    def __init__(
        self, mass: float, seals: float, compression: float | None, temperature: float | None
    ) -> None:
        self.mass, self.seals = mass, seals
        self.compression, self.temperature = compression, temperature

    def __call__(self, fit: Fit) -> MassPeak:
        if self.compression is not None:
            fit = fit.at_compression(self.compression)
        if self.temperature is not None and fit.temperatures is not None:
            fit = fit.at_temperature(self.temperature)
        modes = model_modes(self.seals * fit.solid, self.mass)
        if not modes:
            raise ExportError(f"a mass of {self.mass:g} kg does not resonate on this model")
        # arms faster than the mass have poles of their own, which hardly move it
        mode = max(modes, key=lambda mode: abs(mode.residue))
        return MassPeak(mode.frequency, mode.damping_ratio)


def format_index(
    units: UnitSystem, rows: Sequence[tuple[str, DrawnSolid | None, Fit, MassPeak]]
) -> str:
    """Return the index of draws as CSV; its first row is the fit itself.

    Changes are over the values of the fit. `deviance` is by how much a draw leaves a larger sum of
    squares of the record than the fit, in units of the noise variance.
    """
    first = rows[0][3]
    arms = rows[0][2].model.arms
    has_arm = any(draw is not None and draw.arm is not None for _, draw, *_ in rows)
    stiffness, time = units.stiffness_word, units.words[2]
    header = [
        "draw", "file", f"peak [{units.frequency_word}]", "damping_ratio [1]", "peak_change [%]",
        "damping_change [%]", f"k_inf [{stiffness}]",
        *(f"{name}_{j} [{unit}]" for j in range(1, arms + 1)
          for name, unit in (("k", stiffness), ("tau", time))),
        f"b [{units.damping_word}]",
        *([f"unresolved_k [{stiffness}]", f"unresolved_tau [{time}]", "deviance [1]"] * has_arm),
    ]  # fmt: skip
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(header)
    for name, draw, fit, peak in rows:
        model, arm = fit.model, None if draw is None else draw.arm
        values: list[float | None] = [units.stiffness(model.k_inf)]
        for k, tau in zip(model.k, model.tau, strict=True):
            if arm is None or tau != arm.tau:
                values += [units.stiffness(k), tau / units.time]
        values.append(units.damping(model.b))
        if has_arm:
            values += (
                [None] * 3
                if draw is None or arm is None
                else [units.stiffness(arm.k), arm.tau / units.time, draw.deviance]
            )
        changes = (
            100 * (peak.frequency / first.frequency - 1),
            100 * (peak.damping_ratio / first.damping_ratio - 1),
        )
        numbers = (units.frequency(peak.frequency), peak.damping_ratio, *changes, *values)
        writer.writerow(
            [
                0 if draw is None else draw.number, name,
                *("" if value is None else text(value) for value in numbers),
            ]
        )  # fmt: skip
    return table.getvalue()
