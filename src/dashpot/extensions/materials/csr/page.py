"""Page of an aging law."""

from __future__ import annotations

from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.extensions.materials.csr.datamodel import Aging
from dashpot.extensions.materials.law_ranking import make_law_ranking
from dashpot.report.result_page import KindPage, Topic, group, lights


def page(aging: Aging) -> KindPage:
    """Return the page of an aging law."""
    warm = [oven.temperature for oven in aging.ovens]
    ends = " to ".join(f"{convert_to_unit(value, '°C'):.4g}" for value in (warm[0], warm[-1]))
    return KindPage(
        about="compression stress relaxation",
        strip=(("Ovens", f"{len(warm)}, {ends} °C"),
               ("Longest", format_quantity(aging.longest, "h", ".4g")),
               ("Scatter", f"{100 * aging.scatter:.2g} % of F0")),
        lights=lights(
            aging.checks, Topic("Readings"),
            Topic("Ovens", {"ovens_enough", "one_activation_energy_explains_ovens"},
                f"{len(warm)} on one line"),
            Topic("Chemistry", {"chemical_aging_resolved", "aging_exceeds_cell_drift",
                "load_cell_zero_stable"}, "seen"),
        ),
        answers="What is left of the force",
        picture=aging.plot(),
        told="The aging law",
        groups=(group("", aging.facts),),
        sources=aging.sources,
        folds=(make_law_ranking(aging.orders),),
    )  # fmt: skip
