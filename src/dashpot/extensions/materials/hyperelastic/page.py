"""The page of a law of stress over stretch."""

from __future__ import annotations

from dashpot.base.number_format import format_count, round_to_error
from dashpot.base.units import format_quantity
from dashpot.extensions.materials.hyperelastic.datamodel import HyperelasticFit
from dashpot.report.attachments import DeckTerms
from dashpot.report.page_content import (
    CollapsibleSection,
    KindPage,
    Topic,
    group,
    lights,
    make_law_ranking,
)
from dashpot.report.tables import TextTable


def find_terms(found: HyperelasticFit) -> DeckTerms:
    """Return what the cards on its page are asked for."""
    unstated = () if found.temperature is not None else ("temperature",)
    if found.law.bulk_modulus is not None:
        return DeckTerms(None, unstated=unstated)
    untested = "the change of volume was not tested. Give a bulk modulus when you export it"
    return DeckTerms(None, unstated=unstated, reason=untested)


def page(found: HyperelasticFit) -> KindPage:
    """What the page of a hyperelastic law holds."""
    use = {"stable_in_use", "use_measured", "volume_known"}
    law = {"law_followed", "no_law_closer", "foam_no_closer", "constants_known", "modes_enough",
           "modes_told", "sideways_agrees"}  # fmt: skip
    left = f"{round_to_error(100 * max(found.residuals), digits=2)} % left"
    curves = tuple(
        (one.mode, "" if one.source is None else one.source.file,
         f"{one.stretch.min():.4g} to {one.stretch.max():.4g}", str(one.rows),
         round_to_error(100 * residual, digits=3))
        for one, residual in zip(found.curves, found.residuals, strict=True)
    )  # fmt: skip
    warm = found.temperature
    return KindPage(
        about=f"stress over strain, {format_count(len(found.curves), 'curve')}",
        strip=(
            ("Law", found.law.kind),
            ("Curves", ", ".join(one.mode for one in found.curves)),
            ("Temperature", "not given" if warm is None else format_quantity(warm, "°C", ".1f")),
        ),
        lights=lights(
            found.checks,
            Topic("Curves"),
            Topic("Law", law, left),
            Topic("Use", use, "stable where used"),
        ),
        answers="Stress over stretch",
        picture=found.plot(),
        told=f"The {found.law.kind} law",
        groups=(group("", found.found),),
        sources=found.sources,
        folds=(
            CollapsibleSection(
                "Each curve",
                "stretches, rows, residual",
                TextTable(("test", "file", "stretch", "rows", "residual, %"), curves),
            ),
            make_law_ranking(found.orders),
        ),
    )
