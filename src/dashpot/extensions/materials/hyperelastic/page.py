"""Page of a hyperelastic law."""

from __future__ import annotations

from dashpot.base.number_format import format_count, round_to_error
from dashpot.base.units import format_quantity
from dashpot.extensions.materials.hyperelastic.datamodel import HyperelasticFit
from dashpot.extensions.materials.law_ranking import make_law_ranking
from dashpot.report.page_frame import DeckTerms
from dashpot.report.result_page import CollapsibleSection, KindPage, Topic, group, make_indicators
from dashpot.report.tables import TextTable


def find_terms(hyperelastic_fit: HyperelasticFit) -> DeckTerms:
    """Return the options of the material cards on the page."""
    unstated = () if hyperelastic_fit.temperature is not None else ("temperature",)
    if hyperelastic_fit.law.bulk_modulus is not None:
        return DeckTerms(None, allowed_unknowns=unstated)
    untested_note = "the change of volume was not tested. Give a bulk modulus when you export it"
    return DeckTerms(None, allowed_unknowns=unstated, reason=untested_note)


def page(hyperelastic_fit: HyperelasticFit) -> KindPage:
    """Return the page of a hyperelastic law."""
    use = {"stable_in_use", "use_range_measured", "bulk_modulus_determined"}
    law = {"law_residual_small", "no_better_law", "compressible_law_no_better",
        "constants_determined", "modes_enough",
           "unmeasured_modes_determined", "lateral_swelling_agrees"}  # fmt: skip
    residual_text = f"residual {round_to_error(100 * max(hyperelastic_fit.residuals), digits=2)} %"
    curves = tuple(
        (curve.mode, "" if curve.source is None else curve.source.file,
         f"{curve.stretch.min():.4g} to {curve.stretch.max():.4g}", str(curve.rows),
         round_to_error(100 * residual, digits=3))
        for curve, residual in zip(hyperelastic_fit.curves, hyperelastic_fit.residuals, strict=True)
    )  # fmt: skip
    kelvin = hyperelastic_fit.temperature
    return KindPage(
        subject=f"stress over strain, {format_count(len(hyperelastic_fit.curves), 'curve')}",
        summary_line=(
            ("Law", hyperelastic_fit.law.kind),
            ("Curves", ", ".join(curve.mode for curve in hyperelastic_fit.curves)),
            (
                "Temperature",
                "not given" if kelvin is None else format_quantity(kelvin, "°C", ".1f"),
            ),
        ),
        indicators=make_indicators(
            hyperelastic_fit.checks,
            Topic("Curves"),
            Topic("Law", law, residual_text),
            Topic("Use", use, "stable where used"),
        ),
        figure_title="Stress over stretch",
        picture=hyperelastic_fit.plot(),
        table_title=f"The {hyperelastic_fit.law.kind} law",
        groups=(group("", hyperelastic_fit.reported_values),),
        sources=hyperelastic_fit.sources,
        collapsible_sections=(
            CollapsibleSection(
                "Each curve",
                "stretches, rows, residual",
                TextTable(("test", "file", "stretch", "rows", "residual, %"), curves),
            ),
            make_law_ranking(hyperelastic_fit.orders),
        ),
    )
