"""The page of one solid under several masses."""

from __future__ import annotations

from dashpot.base.number_format import format_count, format_with_error
from dashpot.extensions.modes.mass_series_files import ModesByMass
from dashpot.report.page_content import Group, KindPage, Topic, lights
from dashpot.report.result_pages.frf_pages import mode_rows


def masses_page(modes: ModesByMass) -> KindPage:
    """What the page of one solid under several masses holds."""
    of = modes.together
    facts = tuple(
        Group(format_with_error(mass, "g", digits=4), tuple(mode_rows(mode)))
        for mass, mode in zip(of.masses, of.modes, strict=True)
    )
    return KindPage(
        about=f"one solid under {format_count(len(of.masses), 'mass').replace('masss', 'masses')}",
        strip=(
            ("Masses", ", ".join(format_with_error(mass, "g", digits=4) for mass in of.masses)),
        ),
        lights=lights(modes.checks, Topic("FRFs"), Topic("One solid", {"one_solid"})),
        answers="The response under each mass",
        picture=modes.plot(),
        told="Resonance under each mass",
        groups=facts,
        sources=tuple(dict.fromkeys(s for test in modes.tests for s in test.frf.source)),
        name="masses",
    )
