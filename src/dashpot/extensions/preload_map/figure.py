"""Figure of a preload map: stiffness over frequency, compression and amplitude."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.units import convert_to_unit
from dashpot.extensions.preload_map.preload_map import MapValues, PreloadMap
from dashpot.plot.picture import FIT, Area, Dots, Line, Mark, Panel, Picture, Scale, Tag
from dashpot.plot.plotted_data import FREQUENCY, compute_padded_limits
from dashpot.plot.plotted_data import stamp as format_stamp

_POINTS = 41
_EDGE_FACTOR = 1.05
_LABEL_MARGIN = 1.8
"""Room for the names of the curves at their ends, a factor in frequency."""


def draw_preload_map(preload_map: PreloadMap, *, stamp: str = "") -> Picture:
    """Return the map over frequency at each compression and amplitude, and over these two.

    Parameters
    ----------
    preload_map : PreloadMap
    stamp : str
        Origin of the data, printed below the figure; by default the files.
    """
    strips: list[tuple[Panel, ...]] = [
        (_make_storage_panel(preload_map),),
        (_make_loss_panel(preload_map),),
    ]
    across = [_make_compression_panel(preload_map)]
    if len(preload_map.amplitudes) > 1:
        across.append(_make_amplitude_panel(preload_map))
    strips += [(panel,) for panel in across]
    caption = (
        "Preload map: storage stiffness at each compression and loss factor at two amplitudes over "
        "frequency, and the storage stiffness over compression and amplitude at one frequency, "
        "with 95 % limits. Dots are measured; circles are the map at the measured levels."
    )
    origin = format_stamp(preload_map.source) if preload_map.source else ""
    return Picture("preload-map", caption, tuple(strips), 2, stamp or origin)


def _scale(preload_map: PreloadMap) -> Scale:
    low, high = preload_map.band
    return Scale(FREQUENCY, (low, high * _LABEL_MARGIN), log=True)


def _select_lines(
    preload_map: PreloadMap, compression: float, amplitude: float | None
) -> BoolArray:
    """Return which measured lines are of a setting."""
    is_selected = np.isclose(preload_map.line_compression, compression)
    return np.asarray(
        is_selected
        if amplitude is None
        else is_selected & np.isclose(preload_map.line_amplitude, amplitude)
    )


def _make_storage_panel(preload_map: PreloadMap) -> Panel:
    marks: list[Mark] = []
    drawn_values: list[FloatArray] = []
    for i, c in enumerate(preload_map.compressions.tolist()):
        evaluated = preload_map.evaluate(preload_map.grid, compression=c)
        value, error = (convert_to_unit(entry, "N/mm") for entry in
                        (evaluated.value.real, evaluated.storage_error))  # fmt: skip
        is_chosen = _select_lines(preload_map, c, preload_map.reference_amplitude)
        marks += [
            Area(evaluated.frequency, value - error, value + error, "fit",
            "" if i else "95 % limits"),
            Line(evaluated.frequency, value, FIT, "" if i else "map"),
            Dots(preload_map.frequency[is_chosen],
            convert_to_unit(preload_map.value.real[is_chosen], "N/mm"),
                 "measured", "" if i else "measured", 3.0),
            Tag(float(evaluated.frequency[-1]), float(value[-1]),
                f"{convert_to_unit(c, 'mm'):.3g} mm", "fit", end=True),
        ]  # fmt: skip
        drawn_values += [value - error, value + error]
    amplitude = preload_map.reference_amplitude
    note = (
        "" if amplitude is None else f"at an amplitude of {convert_to_unit(amplitude, 'mm'):.3g} mm"
    )
    limits = compute_padded_limits(*drawn_values)
    return Panel(
        _scale(preload_map), Scale("storage stiffness K′, N/mm", limits), tuple(marks),
        title="stiffness at each compression", note=note,
    )  # fmt: skip


def _make_loss_panel(preload_map: PreloadMap) -> Panel:
    marks: list[Mark] = []
    drawn_values: list[FloatArray] = [np.zeros(1)]
    c = preload_map.reference_compression
    levels: list[float | None] = preload_map.amplitudes.tolist() or [None]
    shown_levels = [levels[0], levels[-1]] if len(levels) > 1 else levels
    for i, X in enumerate(shown_levels):
        evaluated = preload_map.evaluate(preload_map.grid, compression=c, amplitude=X)
        eta, error = evaluated.value.imag / evaluated.value.real, evaluated.loss_factor_error
        is_chosen = _select_lines(preload_map, c, X)
        measured = preload_map.value[is_chosen].imag / preload_map.value[is_chosen].real
        if not i:
            marks.append(Area(evaluated.frequency, eta - error, eta + error, "fit", "95 % limits"))
            drawn_values += [eta - error, eta + error]
        marks += [
            Line(evaluated.frequency, eta, FIT, "" if i else "map"),
            Dots(
                preload_map.frequency[is_chosen], measured, "measured", "" if i else "measured", 3.0
            ),
        ]
        if X is not None:
            name = f"{convert_to_unit(X, 'mm'):.3g} mm"
            marks.append(Tag(float(evaluated.frequency[-1]), float(eta[-1]), name, "fit", end=True))
        drawn_values += [eta, measured]
    limits = compute_padded_limits(*drawn_values)
    return Panel(
        _scale(preload_map), Scale("loss factor K″/K′, 1", limits), tuple(marks),
        title="loss factor at two amplitudes" if len(shown_levels) > 1 else "loss factor",
        note=f"at a compression of {convert_to_unit(c, 'mm'):.3g} mm",
    )  # fmt: skip


def _make_compression_panel(preload_map: PreloadMap) -> Panel:
    levels = preload_map.compressions
    compressions = np.linspace(float(levels[0]), float(levels[-1]), _POINTS)
    f = np.array([preload_map.middle_frequency])
    curve = [preload_map.evaluate(f, compression=float(c)) for c in compressions]
    dots = [preload_map.evaluate(f, compression=float(c)) for c in levels]
    return _compute_storage_across(
        preload_map, (compressions, curve), (levels, dots), "compression, mm"
    )


def _make_amplitude_panel(preload_map: PreloadMap) -> Panel:
    levels, c = preload_map.amplitudes, preload_map.reference_compression
    amplitudes = np.geomspace(float(levels[0]), float(levels[-1]), _POINTS)
    f = np.array([preload_map.middle_frequency])
    curve = [preload_map.evaluate(f, compression=c, amplitude=float(X)) for X in amplitudes]
    dots = [preload_map.evaluate(f, compression=c, amplitude=float(X)) for X in levels]
    return _compute_storage_across(
        preload_map, (amplitudes, curve), (levels, dots), "amplitude, mm"
    )


def _compute_storage_across(
    preload_map: PreloadMap,
    line: tuple[FloatArray, list[MapValues]],
    levels: tuple[FloatArray, list[MapValues]],
    label: str,
) -> Panel:
    """Return the storage stiffness over one variable: places, m, and the map there."""
    abscissae, curve = convert_to_unit(line[0], "mm"), line[1]
    name = label.split(",", maxsplit=1)[0]
    low, high, log = float(abscissae[0]), float(abscissae[-1]), name == "amplitude"
    margin = (_EDGE_FACTOR - 1) * (high - low)
    value = convert_to_unit(np.array([evaluated.value.real[0] for evaluated in curve]), "N/mm")
    error = convert_to_unit(np.array([evaluated.storage_error[0] for evaluated in curve]), "N/mm")
    storage_values = convert_to_unit(
        np.array([evaluated.value.real[0] for evaluated in levels[1]]), "N/mm"
    )
    marks: tuple[Mark, ...] = (
        Area(abscissae, value - error, value + error, "fit", "95 % limits"),
        Line(abscissae, value, FIT, "map"),
        Dots(
            convert_to_unit(levels[0], "mm"),
            storage_values,
            "measured",
            "map at a measured level",
            5.0,
            hollow=True,
        ),
    )
    limits = compute_padded_limits(value - error, value + error)
    return Panel(
        Scale(
            label,
            (low - margin, high + margin) if not log else (low / _EDGE_FACTOR, high * _EDGE_FACTOR),
            log,
        ),
        Scale("K′, N/mm", limits),
        marks,
        title=f"stiffness over {label.split(',', maxsplit=1)[0]}",
        note=f"at {preload_map.middle_frequency:g} Hz",
    )
