"""Overview figure: relaxation test with its fit, measured and predicted FRF."""

from __future__ import annotations

from dataclasses import replace

from dashpot.base.number_format import seals
from dashpot.base.units import format_quantity
from dashpot.plot import frf_figure, relaxation
from dashpot.plot.picture import Picture
from dashpot.plot.plotted_data import select_plot_unit, stamp
from dashpot.workflow.study import Study


def hero(study: Study) -> Picture:
    """The relaxation test with its fits on the left, the FRF with its predictions on the right.

    Without a comparison, the fits alone.
    """
    test, c = study.prepared, study.comparison
    plotted_fits = relaxation.make_plotted_fits(study.fit, study.alternatives, test)
    unit_name, factor = select_plot_unit(test.displacement, "m")
    title = (
        f"Relaxation test: {factor * test.depth:.3g} {unit_name} in {test.ramp_time:.3g} s, "
        f"held {test.hold_time:.3g} s"
    )
    chosen_fit = next(plotted_fit for plotted_fit in plotted_fits if plotted_fit.fit is study.fit)
    strips = [
        (
            relaxation.force_panel(plotted_fits, test, title=title),
            relaxation.residual_panel(chosen_fit, test),
        )
    ]
    sources = list(study.fit.source)
    if c is not None:
        sources += c.measured.source
        failed = study.joint is not None and study.joint.verdict.use == "do not use"
        curves = frf_figure.curves_of(c, study.joint_comparison, failed=failed)
        view = (
            frf_figure.VIEW_FACTORS[0] * c.measured_hz,
            frf_figure.VIEW_FACTORS[1] * c.measured_hz,
        )
        bounds = frf_figure.make_prediction_bands(study.frf_band)[:1]
        upper = frf_figure.magnitude_panel(curves, bounds, view=view, height=210, tagged=True)
        mass = "" if study.mass is None else f"{format_quantity(study.mass, 'g')} on "
        titled = replace(upper, title=f"Hammer test: {mass}{seals(study.seals)}")
        strips.append((titled, frf_figure.phase_panel(curves, upper.x.limits)))
    text = stamp(sources, study.fit.specimen, mass=study.mass, seals=study.seals)
    caption = "The relaxation test and its fit, the FRF and its prediction."
    return Picture("hero", caption, tuple(strips), 2, text, width=900.0)
