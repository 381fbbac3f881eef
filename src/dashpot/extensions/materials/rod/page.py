"""Page of a rod under a mass."""

from __future__ import annotations

import numpy as np

from dashpot.base.number_format import format_with_error, round_to_error
from dashpot.base.reported_values import ReportedValue
from dashpot.extensions.materials.rod.fit_files import Rod
from dashpot.report.first_screen import NBSP
from dashpot.report.result_page import Group, KindPage, Topic, make_indicators, row
from dashpot.report.solid_and_frf_pages import LOSS_CHECKS, STIFFNESS_CHECKS, make_solid_groups


def page(rod: Rod) -> KindPage:
    """Return the page of a rod."""
    of = rod.modulus
    low, high = of.band
    usable = bool(of.usable.any())
    modulus = Topic(
        "Modulus", {"modulus_determined_near_resonance", "waves_plane", "mass_ratio_suitable",
        "sensors_agree"},
        f"{low:.3g} to {high:.3g}{NBSP}Hz" if usable else "",
    )  # fmt: skip
    model_checks = STIFFNESS_CHECKS | LOSS_CHECKS | {
        "single_solid_explains_lines", "residuals_white", "optimiser_converged", "storage_rises",
    }  # fmt: skip
    groups: list[Group] = []
    if usable:
        lines = np.flatnonzero(of.usable)
        for i in dict.fromkeys((lines[0], lines[len(lines) // 2], lines[-1])):
            hz = f"At {round_to_error(float(of.frequency[i]), digits=3)}{NBSP}Hz"
            groups.append(
                Group(
                    hz,
                    (
                        row(
                            ReportedValue.from_error(
                                "E′", float(of.storage[i]), float(of.storage_sd[i]), unit="Pa"
                            )
                        ),
                        row(
                            ReportedValue.from_error(
                                "Loss factor", float(of.loss_factor[i]), float(of.loss_factor_sd[i])
                            )
                        ),
                    ),
                )
            )
    if rod.fit is not None:
        groups += [
            group
            for group in make_solid_groups(rod.fit)
            if group.title.startswith(("Arms", "Modulus"))
        ]
    return KindPage(
        subject="rod under a mass",
        summary_line=(
            ("Mass", format_with_error(rod.mass, "g", digits=4)),
            ("Rod", format_with_error(rod.rod_mass, "g")),
            ("Ends", "bonded" if rod.bonded else "sliding"),
            ("Known to 10 %", f"{low:.3g} to {high:.3g} Hz" if usable else "nowhere"),
        ),
        indicators=make_indicators(
            rod.checks, Topic("Record"), modulus, Topic("Model", model_checks)
        ),
        figure_title="The modulus of the material",
        picture=rod.plot(),
        table_title="The material",
        groups=tuple(groups),
        note="From and to: 95 %, of all errors of the test together.",
        sources=tuple(dict.fromkeys(rod.frf.source)),
    )
