"""dashpot predict: the FRF of a mass on the fitted seal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from dashpot.cli._shell import Outcome, Quantity, Range, failed, reports, write

if TYPE_CHECKING:
    from dashpot.records.bounds import FRFBounds
    from dashpot.records.fit import Fit
    from dashpot.records.frf import FRF
    from dashpot.solids.maxwell import GeneralizedMaxwell


@click.command("predict", short_help="The FRF of a mass on the fitted seal.")
@click.argument("fit")
@click.option("--mass", type=Quantity("mass"), required=True, help="Block mass, e.g. 104g.")
@click.option("--seal-mass", type=Quantity("mass"), help="Of one seal; a third moves along.")
@click.option("--seals", type=float, default=1.0, show_default=True, help="Seals in parallel.")
@click.option(
    "--band", type=Range("frequency"), default="1:50Hz", show_default=True, help="Frequencies."
)
@click.option("--lines", type=click.IntRange(2), default=2001, show_default=True)
@click.option(
    "--kind",
    type=click.Choice(["accelerance", "mobility", "receptance", "dynamic_stiffness"]),
    default="accelerance",
    show_default=True,
)
@click.option("--with", "records", metavar="FILE", multiple=True, help="The relaxation record(s).")
@click.option("--plot", "picture", metavar="FILE", help="Save the figure (png, svg, pdf).")
@click.option("-o", "--output", metavar="FILE", help="Write the FRF as CSV; - is stdout.")
@reports
def command(
    *,
    fit: str,
    mass: float,
    seal_mass: float | None,
    seals: float,
    band: tuple[float, float],
    lines: int,
    kind: str,
    records: tuple[str, ...],
    picture: str | None,
    output: str | None,
) -> Outcome:
    """Predict the frequency response of a mass on the seal of FIT (a fit's JSON file).

    The standard errors of the fit become limits of the prediction; with the record that was
    fitted (--with) so does the room it leaves for arms that it cannot see.

    \b
    dashpot predict fit.json --mass 104g --seals 2
    dashpot predict fit.json --mass 104g --seals 2 --band 1:50Hz -o frf.csv
    dashpot predict fit.json --mass 104g --seals 2 --with seal_8mm.csv --plot frf.png
    """
    import numpy as np

    from dashpot.cli import _text as _words
    from dashpot.cli._inputs import read_fit
    from dashpot.io.writers.text import write_frf
    from dashpot.vibration.modal.modes import model_modes
    from dashpot.vibration.systems.prediction import moving_mass, predict_frf

    found = read_fit(fit)
    moving, noted = moving_mass(mass, seal=seal_mass or 0.0, seals=seals)
    solid = seals * found.model
    frf = predict_frf(solid, mass=moving, frequency=np.linspace(*band, lines), kind=kind)
    modes = model_modes(solid, moving)
    limits = _limits(found, records, mass=moving, seals=seals, frf=frf)
    if picture:
        from dashpot import plot

        plot.save(plot.frf(frf, band=limits if frf.kind == "accelerance" else None), picture)
    if output:
        write(output, write_frf(frf))
    peak = _peak(solid, moving, frf)
    extrapolated = [
        mode.frequency for mode in modes if not found.band[0] <= mode.frequency <= found.band[1]
    ]
    document = {
        "schema": "dashpot/prediction@1",
        "mass": mass,
        "moving_mass": moving,
        "seals": seals,
        "kind": str(frf.kind),
        "unit": frf.unit,
        "peak": {"frequency_hz": peak[0], "value": peak[1]},
        "modes": [
            {"frequency_hz": mode.frequency, "damping_ratio": mode.damping_ratio} for mode in modes
        ],
        "band_hz": list(found.band),
        "extrapolated": bool(extrapolated),
        "frequency_hz": frf.frequency.tolist(),
        "real": frf.value.real.tolist(),
        "imag": frf.value.imag.tolist(),
        "limits": _plain(found, limits, mass=moving, seals=seals, frf=frf),
    }
    text = _words.prediction(found, frf, modes, peak=peak, mass=mass, seals=seals)
    text = "\n".join([text, *failed([noted])])
    return Outcome(lambda: document, "" if output == "-" else text, (noted,))


def _limits(
    found: Fit, records: tuple[str, ...], *, mass: float, seals: float, frf: FRF
) -> FRFBounds | None:
    """Return both kinds of limits, about the lines predicted, if the record is at hand."""
    import numpy as np

    from dashpot.fitting.uncertainty.prediction_bounds import frf_band
    from dashpot.io.read import read_relaxation
    from dashpot.preparation.prepare import prepare

    if not records:
        return None
    tests = [prepare(read_relaxation(path)) for path in records]
    lines = np.linspace(max(frf.frequency[0], 1e-3), frf.frequency[-1], 401)
    return frf_band(found, tests, mass=mass, frequency=lines, seals=seals)


def _plain(
    found: Fit, limits: FRFBounds | None, *, mass: float, seals: float, frf: FRF
) -> dict[str, Any]:
    """Return the limits of the accelerance, 1/kg; null where nothing limits it."""
    import numpy as np

    from dashpot.fitting.uncertainty.prediction_bounds import formal_frf_band

    lines = frf.frequency[frf.frequency > 0]
    f = np.linspace(lines[0], lines[-1], 401) if limits is None else limits.frequency
    formal = formal_frf_band(found, mass=mass, frequency=f, seals=seals)
    document: dict[str, Any] = {"frequency_hz": f.tolist(), "parameter": formal.tolist()}
    if limits is not None:
        document["unseen"] = [
            [float(value) if np.isfinite(value) else None for value in row] for row in limits.unseen
        ]
    return document


def _peak(solid: GeneralizedMaxwell, mass: float, frf: FRF) -> tuple[float, float]:
    """Return frequency and height of the largest magnitude, between the lines of the grid too."""
    import numpy as np

    from dashpot.vibration.systems.prediction import predict_frf

    top = int(np.abs(frf.value).argmax())
    low, high = frf.frequency[max(top - 1, 0)], frf.frequency[min(top + 1, len(frf.value) - 1)]
    fine = predict_frf(solid, mass=mass, frequency=np.linspace(low, high, 2001), kind=frf.kind)
    height = np.abs(fine.value)
    return float(fine.frequency[height.argmax()]), float(height.max())
