"""Text of the model of a solver card."""

from __future__ import annotations

from dashpot.base.number_format import format_band
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.extensions.solver_inputs.cards.imported_model import ImportedModel
from dashpot.text_output.layout import Text, table


def render_imported_model(result: ImportedModel) -> Text:
    """Return the model, and the expected errors of each arm in a test."""
    model, test = result.fit.model, result.test
    unit = "N/mm" if result.fit.unit == "N/m" else "MPa"
    end = f", b = {model.b:.5g} N s/m" if model.b else ""
    lines = [
        f"{result.fit.source[0].file}: {result.keyword} of {result.card}",
        f"  k_inf = {convert_to_unit(model.k_inf, unit):.6g} {unit}{end}",
    ]
    if result.arms:
        rows = [("arm", f"k, {unit}", "tau, s", "SD of k", "SD of tau", "")]
        for j, arm in enumerate(result.arms, start=1):
            word = "" if arm.is_determined else "not determined"
            k = f"{convert_to_unit(arm.k, unit):.5g}"
            rows.append(
                (
                    str(j),
                    k,
                    f"{arm.tau:.5g}",
                    _format_percent(arm.k_sd),
                    _format_percent(arm.tau_sd),
                    word,
                )
            )
        lines += table(rows)
        band_text = "nowhere" if result.testable_band is None else format_band(result.testable_band)
        motion = f"ramp {test.ramp_time:.4g} s, hold {test.hold_time:.4g} s, {test.rate:.4g} Hz"
        lines += [
            f"  test        {motion}, noise {_format_noise(result)}",
            f"  known       stiffness to 10 %, loss factor to 30 % {band_text}",
        ]
    return Text([*lines, *(f"  note        {note}" for note in result.notes)])


def _format_noise(result: ImportedModel) -> str:
    if result.fit.unit == "N/m":
        return format_quantity(result.test.noise, "mN", ".3g")
    test = result.test
    peak = result.fit.model.ramp_hold_force(
        [test.ramp_time], depth=test.depth, ramp_time=test.ramp_time
    )[0]
    return f"{100 * test.noise / float(peak):.3g} % of the largest force"


def _format_percent(part: float) -> str:
    return f"{100 * part:.3g} %" if part < 1e4 else "unknown"
