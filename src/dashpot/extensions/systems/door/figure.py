"""Figure of a door: seal compression, modes, and FRFs with and without the seal."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.base.number_format import round_to_error
from dashpot.base.units import convert_to_unit
from dashpot.extensions.systems.door.assembly import AXES, DOOR
from dashpot.extensions.systems.door.mounts import SEAL
from dashpot.extensions.systems.door.result import DoorResult
from dashpot.extensions.systems.door.seal_line import SealLine
from dashpot.extensions.systems.multibody import Point
from dashpot.plot.picture import (
    FIT,
    REF,
    Dots,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Ring,
    Rule,
    Scale,
    Tag,
)
from dashpot.plot.plotted_data import (
    compute_padded_limits,
    compute_padded_log_limits,
    split_at_band,
)
from dashpot.plot.plotted_data import stamp as format_stamp
from dashpot.plot.style import sequential

MAX_MODES = 6
"""Modes that are drawn."""
_CLASSES = 4
"""Number of classes of compression."""
_SHAPE_POINTS = 240
"""Number of points along the line at which a shape is drawn."""
_BAND_WIDTH = 0.16
"""Width of the band of the largest motion, over the door's larger side."""
_IN_PLANE = 0.1
"""Largest motion across the plane, over that in it, of a mode in the plane."""
_BAND_RATIO = 1.2
"""Factor by which the shown frequencies extend below and above the modes that the seal holds."""
_SCALES = (1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)
"""Possible lengths of the scale bar, m."""
_DIRECTION_COLOURS = {"out": "warm", "in": "cold"}
"""Colours of outward and inward motion."""
_INSIDE = {"out": 0.5, "in": 1.5}
"""Distance of a label from the line, inwards, in widths of a band."""
_AVERAGED_STATIONS = 17
"""Number of points over which the direction of a band is averaged."""
_FEW_LINES = 12
"""Lines of an FRF below which all of it is shown."""
_MIN_ENERGY_SHARE = 0.01
"""Smallest share of the energy in the seal of a mode that the seal holds."""


def door(result: DoorResult, *, stamp: str = "") -> Picture:
    """Return the compression of the seal line, its motion in the first modes, and FRFs.

    Parameters
    ----------
    result : DoorResult
    stamp : str
        Origin of the data, printed below the figure; by default the files.
    """
    strips: list[tuple[Panel, ...]] = []
    view = View.from_result(result)
    if view is not None:
        strips.append((make_line_panel(result, view),))
        if result.stations is not None and result.stations.compression is not None:
            strips.append((make_compression_panel(result),))
    responses = [
        (make_frf_panel(result, i, height=264.0),) for i in range(min(len(result.frfs), 2))
    ]
    # one beside the line, so that rows of three are full
    strips += responses[:1]
    shapes = [] if view is None else [(panel,) for panel in make_shape_panels(result, view)]
    rows = (len(strips), len(shapes), len(responses[1:])) if shapes else ()
    strips += [*shapes, *responses[1:]]
    caption = (
        "A door on its seal, seen from outside: where and how far the seal is pressed, how its "
        "line moves in the first modes, and the accelerance with the seal and without."
    )
    stamp = stamp or format_stamp(result.sources)
    return Picture(
        "door", caption, tuple(strips), 3, stamp, width=960.0, rows=tuple(filter(None, rows))
    )


@dataclass(frozen=True, eq=False)
class View:
    """View of a door from outside.

    Attributes
    ----------
    axes : (int, int)
        The two coordinates along which the line is longest; the second points up in the figure.
    mirrored : bool
        Whether the first coordinate points to the left.
    outward : array, shape (3,)
        Mean outward normal, opposite to the direction in which the door presses its seal.
    """

    axes: tuple[int, int]
    mirrored: bool
    outward: FloatArray

    @classmethod
    def from_result(cls, result: DoorResult) -> View | None:
        """Return the view of the seal line of a door; None without one."""
        return None if result.door.line is None else cls.from_line(result.door.line)

    @classmethod
    def from_line(cls, line: SealLine) -> View:
        """Return the view of a seal line."""
        first, second = sorted(np.argsort(np.ptp(line.points, axis=0))[1:].tolist())
        inward_normal = line.normal_at(line.arc_length).mean(axis=0)
        magnitude = float(np.linalg.norm(inward_normal))
        axis_vector = np.eye(3)[next(k for k in range(3) if k not in (first, second))]
        outward_normal = -inward_normal / magnitude if magnitude > 0 else axis_vector
        right_part = np.cross(np.eye(3)[second], outward_normal)
        return cls((first, second), bool(right_part[first] < 0), outward_normal)

    def project_points(self, vectors: FloatArray) -> FloatArray:
        """Return points or motions, shape (n, 3), in the plane of the figure, shape (n, 2)."""
        projected = vectors[:, list(self.axes)].copy()
        projected[:, 0] *= -1 if self.mirrored else 1
        return np.asarray(projected)


def make_line_panel(result: DoorResult, view: View) -> Panel:
    """Return the seal line by its compression, and the mounts of the door."""
    stations, line = result.stations, result.door.line
    marks: list[Mark] = []
    drawn_points = [np.zeros((0, 2))]
    if line is not None and stations is not None:
        outline, station_points = (
            view.project_points(line.points),
            view.project_points(stations.place),
        )
        drawn_points.append(outline)
        marks.append(Line(outline[:, 0], outline[:, 1], Pen("line", 1.2)))
        compressions = stations.compression
        if compressions is None:
            marks.append(Dots(station_points[:, 0], station_points[:, 1], "fit", "seal", size=4.0))
        else:
            marks += mark_classes(
                station_points, convert_to_unit(compressions, "mm"), compressions >= 0, unit="mm"
            )
    latch = () if result.door.latch is None else (result.door.latch,)
    for hinge in (*result.door.hinges, *latch, *result.door.bumpers):
        ((x, y),) = view.project_points(np.array([hinge.at]))
        drawn_points.append(np.array([[x, y]]))
        marks.append(Tag(x, y, hinge.name, "ink", "filled"))
    for point in result.door.points:
        if point.on == DOOR:
            ((x, y),) = view.project_points(np.array([point.at]))
            marks.append(Tag(x, y, point.name, "soft", "hollow"))
    low, high = (end(np.concatenate(drawn_points), axis=0) for end in (np.min, np.max))
    # a metre, or as much of one as is no wider than the door
    metre = next((scale for scale in _SCALES if scale <= high[0] - low[0]), _SCALES[-1])
    scale_height, middle = low[1] - 0.12 * (high[1] - low[1]), (low[0] + high[0]) / 2
    scale_ends = middle + metre * np.array([-0.5, 0.5])
    marks.append(Line(scale_ends, np.full(2, scale_height), Pen("edge", 1.4)))
    marks.append(Tag(float(scale_ends[1]), float(scale_height), f"{metre:g} m", "soft", end=True))
    return Panel(
        Scale("", compute_padded_limits(np.array([low[0], high[0]]), margin=0.16)),
        Scale("", compute_padded_limits(np.array([scale_height, high[1]]), margin=0.1)),
        tuple(marks),
        title="seal line pressed by, from outside",
        height=300,
        square=True,
        drawing=True,
    )


def mark_classes(
    points: FloatArray, values: FloatArray, has_contact: BoolArray, *, unit: str
) -> list[Mark]:
    """Return stations coloured by classes of their values, and those without contact."""
    x, y = points.T
    marks: list[Mark] = []
    if has_contact.any():
        low, high = float(values[has_contact].min()), float(values[has_contact].max())
        count = _CLASSES if high - low > 1e-6 else 1
        edges = np.linspace(low, high, count + 1)
        rank = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, count - 1)
        for k, colour in enumerate(sequential(count)):
            is_in_class = has_contact & (rank == k)
            label = f"{edges[k]:.3g} to {edges[k + 1]:.3g} {unit}"
            if is_in_class.any():
                marks.append(Dots(x[is_in_class], y[is_in_class], colour, label, size=5.0))
    if not has_contact.all():
        is_open = ~has_contact
        marks.append(Dots(x[is_open], y[is_open], "bad", "does not touch", size=5.0, hollow=True))
    return marks


def make_compression_panel(result: DoorResult) -> Panel:
    """Return the compression along the seal line, and the depth of the seal's test."""
    stations = result.stations
    arc_length = np.zeros(0) if stations is None else stations.along
    length = 0.0 if result.door.line is None else result.door.line.length
    mm = np.zeros(0)
    if stations is not None and stations.compression is not None:
        mm = convert_to_unit(stations.compression, "mm")
    law = None if result.fit is None else result.fit.elastic_law
    marks: list[Mark] = [
        Line(arc_length, mm, FIT, "compression"),
        Rule(0.0, REF, is_horizontal=True),
    ]
    limits = [mm, np.zeros(1)]
    if law is not None:
        tested = convert_to_unit(law.depth, "mm")
        marks.append(Rule(tested, Pen("ref", 1.2, (7, 4)), "depth tested", is_horizontal=True))
        limits.append(np.array([tested]))
    return Panel(
        Scale("along the line, m", (0.0, length)),
        Scale("compression, mm", compute_padded_limits(*limits)),
        tuple(marks),
        title="compression along the line",
        height=264,
    )


def make_shape_panels(result: DoorResult, view: View) -> list[Panel]:
    """Return the motion of the line in each of the first modes.

    Motion normal to the plane of the door is a band on the line, drawn outwards or inwards; motion
    in the plane is the line displaced.
    """
    line = result.door.line
    if line is None:
        return []
    arc_length = np.linspace(0.0, line.length, _SHAPE_POINTS)
    positions = np.stack(
        [np.interp(arc_length, line.arc_length, line.points[:, k]) for k in range(3)], axis=1
    )
    system = result.assembly.system()
    rows = np.array(
        [
            [system.participation(Point(DOOR, (x, y, z), axis)) for axis in AXES]
            for x, y, z in positions.tolist()
        ]
    )
    latch = () if result.door.latch is None else (result.door.latch,)
    hinge_points = view.project_points(
        np.array([hinge.at for hinge in (*result.door.hinges, *latch)]).reshape(-1, 3)
    )
    size = _BAND_WIDTH * float(np.ptp(positions[:, list(view.axes)], axis=0).max())
    projected = view.project_points(positions)
    low, high = projected.min(axis=0) - 1.3 * size, projected.max(axis=0) + 1.3 * size
    panels = []
    for number, mode in enumerate(result.modes[:MAX_MODES], start=1):
        motion = _extract_real_motion(rows @ mode.mode.shape)
        normal_motion = motion @ view.outward
        plane_motion = motion - np.outer(normal_motion, view.outward)
        is_in_plane = float(np.abs(normal_motion).max()) < _IN_PLANE * float(
            np.linalg.norm(plane_motion, axis=1).max()
        )
        motion_marks = (
            _draw_plane_motion(projected, view.project_points(plane_motion), size)
            if is_in_plane
            else _make_motion_bands(projected, normal_motion, size)
        )
        if len(hinge_points):
            motion_marks.append(
                Dots(hinge_points[:, 0], hinge_points[:, 1], "ink", "hinge, latch", size=6.0)
            )
        share = f"seal {100 * mode.share(SEAL):.1f} %"
        damping = round_to_error(100 * mode.mode.damping_ratio, digits=2)
        hz = round_to_error(mode.mode.frequency, digits=4)
        panels.append(
            Panel(
                Scale("", (low[0], high[0])),
                Scale("", (low[1], high[1])),
                tuple(motion_marks),
                height=180,
                square=True,
                drawing=True,
                below=f"{number}: {hz} Hz\n{damping} %, {share}",
            )
        )
    return panels


def _draw_plane_motion(rest_points: FloatArray, change: FloatArray, size: float) -> list[Mark]:
    """Return a motion in the plane: the line at rest, dashed, and moved."""
    moved_points = rest_points + size / float(np.linalg.norm(change, axis=1).max()) * change
    x, y = rest_points.mean(axis=0).tolist()
    return [
        Line(rest_points[:, 0], rest_points[:, 1], Pen("ref", 1.2, (4, 3)), "at rest"),
        Line(moved_points[:, 0], moved_points[:, 1], FIT, "moves in its plane"),
        Tag(x - 1.8 * size, y, "in plane", "soft", end=True),
    ]


def _make_motion_bands(
    rest_points: FloatArray, normal_motion: FloatArray, size: float
) -> list[Mark]:
    """Return a motion normal to the plane as bands on the line, with rings at its nodes."""
    normal = _compute_outward_normals(rest_points)
    scaled_motion = normal_motion / float(np.abs(normal_motion).max())
    edge = rest_points + size * scaled_motion[:, None] * normal
    marks: list[Mark] = []
    # each stretch of one sign, from node to node
    sign_changes = np.flatnonzero(np.diff(np.sign(scaled_motion)) != 0) + 1
    for stretch in np.split(np.arange(len(rest_points)), sign_changes):
        sense = "out" if scaled_motion[stretch].mean() > 0 else "in"
        ring = np.concatenate([rest_points[stretch], edge[stretch][::-1]])
        marks.append(
            Ring(ring[:, 0], ring[:, 1], _DIRECTION_COLOURS[sense], f"seal line goes {sense}")
        )
    marks.append(Line(rest_points[:, 0], rest_points[:, 1], Pen("edge", 1.2)))
    node_points = (rest_points[sign_changes - 1] + rest_points[sign_changes]) / 2
    if len(node_points):
        marks.append(
            Dots(node_points[:, 0], node_points[:, 1], "ink", "stands still", size=6.0, hollow=True)
        )
    for sense, index in (
        ("out", int(np.argmax(scaled_motion))),
        ("in", int(np.argmin(scaled_motion))),
    ):
        if (scaled_motion[index] > 0) == (sense == "out") and abs(scaled_motion[index]) > _IN_PLANE:
            offset = _INSIDE[sense] * size
            x, y = (rest_points[index] - offset * normal[index]).tolist()
            marks.append(Tag(x - 0.4 * size, y, sense, "ink", bold=True, end=True))
    return marks


def _compute_outward_normals(rest_points: FloatArray) -> FloatArray:
    """Return the unit outward normals of the line in its plane, shape (n, 2)."""
    tangent = np.gradient(rest_points, axis=0)
    if np.allclose(rest_points[0], rest_points[-1]):
        tangent[0] = tangent[-1] = rest_points[1] - rest_points[-2]
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    outward_sum = float(np.sum(normal * (rest_points - rest_points.mean(axis=0))))
    # smoothed around a corner, where a band on the inside would otherwise overlap itself
    kernel = np.ones(_AVERAGED_STATIONS) / _AVERAGED_STATIONS
    padded_values = np.concatenate(
        [normal[-_AVERAGED_STATIONS - 1 : -1], normal, normal[1 : _AVERAGED_STATIONS + 1]]
    )
    if not np.allclose(rest_points[0], rest_points[-1]):
        padded_values = np.pad(
            normal, ((_AVERAGED_STATIONS, _AVERAGED_STATIONS), (0, 0)), mode="edge"
        )
    smoothed_normals = np.column_stack(
        [np.convolve(item, kernel, mode="same") for item in padded_values.T]
    )
    smoothed_normals = smoothed_normals[_AVERAGED_STATIONS:-_AVERAGED_STATIONS]
    return np.asarray(smoothed_normals if outward_sum > 0 else -smoothed_normals)


def _extract_real_motion(change: ComplexArray) -> FloatArray:
    """Return the motion at the phase of its largest component."""
    top = change.ravel()[int(np.abs(change).argmax())]
    return np.asarray((change / top).real)


def make_frf_panel(result: DoorResult, index: int, *, height: float = 230.0) -> Panel:
    """Return the accelerance of a place with the seal and without, where the seal holds a mode."""
    name, sealed, bare_frf = result.frfs[index]
    seal_modes = [
        (number, mode.mode.frequency)
        for number, mode in enumerate(result.modes, start=1)
        if mode.share(SEAL) >= _MIN_ENERGY_SHARE
    ]
    f = sealed.frequency
    full_range = shown_range = float(f[0]), float(f[-1])
    if seal_modes:
        shown_range = (
            max(full_range[0], seal_modes[0][1] / _BAND_RATIO),
            min(full_range[1], seal_modes[-1][1] * _BAND_RATIO),
        )
    is_shown = (f >= shown_range[0]) & (f <= shown_range[1])
    if is_shown.sum() < _FEW_LINES:
        is_shown, shown_range, seal_modes = np.ones(len(f), dtype=bool), full_range, []
    f, curves = f[is_shown], [np.abs(frf.value)[is_shown] for frf in (sealed, bare_frf)]
    band = (0.0, np.inf) if result.fit is None else result.fit.band
    peak_tags = [
        Tag(
            hz,
            float(np.interp(hz, f, curves[0])),
            f"{number}: {round_to_error(hz)} Hz",
            "fit",
            bold=True,
        )
        for number, hz in seal_modes[:MAX_MODES]
    ]
    label = "with the seal"
    lines = [
        line
        for line in split_at_band(band, f, curves[0], label, text=f"{label}, extrapolated")
        if np.isfinite(line.y).any()
    ]
    return Panel(
        Scale("frequency, Hz", shown_range),
        Scale("accelerance, 1/kg", compute_padded_log_limits(*curves, margin=2.0), log=True),
        (Line(f, curves[1], Pen("ref", 1.6), "without the seal"), *lines, *peak_tags),
        title=name if name == result.driven.name else f"{name}, driven at {result.driven.name}",
        height=height,
        note=f"of {full_range[0]:g} to {full_range[1]:g} Hz" if seal_modes else "",
    )
