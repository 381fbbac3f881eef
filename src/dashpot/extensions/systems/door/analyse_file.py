"""Analysis of a door file: modes, FRFs and response to random base motion."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import DataError, ReadError
from dashpot.datamodel.checks import temperature_tested
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.random_response import RandomResponse
from dashpot.datamodel.seal_line import SealSection, Shear
from dashpot.extensions.systems.door import checks
from dashpot.extensions.systems.door.assembly import BODY, DOOR, Assembly, estimate_mass
from dashpot.extensions.systems.door.door_model import Door, DoorPoint, SealChoice
from dashpot.extensions.systems.door.modes import (
    DoorMode,
    count_free_motions,
    count_lateral_free_motions,
    door_modes,
    estimate_basis_error,
    estimate_station_error,
    find_farthest_point,
    find_oscillations,
)
from dashpot.extensions.systems.door.mounts import SEAL
from dashpot.extensions.systems.door.read import read_door
from dashpot.extensions.systems.door.read_modes import read_modes
from dashpot.extensions.systems.door.result import BaseResponse, DoorResult
from dashpot.extensions.systems.door.seal_line import SealLine
from dashpot.extensions.systems.free_modes import FreeModes
from dashpot.extensions.systems.multibody import Point
from dashpot.reading.raw_file import add_name_to_errors
from dashpot.registry import require_handler
from dashpot.solids.elastic import require_plausible_compression
from dashpot.solids.maxwell import Solid
from dashpot.vibration.checks import compression_tested
from dashpot.workflow.json_archive import format_unexpected_kind, read_fit, read_json_document

__all__ = ["DoorResult", "door_file", "open_door"]

LINES = 2001
"""Number of lines of an FRF."""


def open_door(
    path: str | Path | Door, *, temperature: float | None = None
) -> tuple[Assembly, Fit | None]:
    """Return the door of a file with its seal, parts and modes, and the fit of its seal.

    Parameters
    ----------
    path : path or Door
        TOML, as :func:`~dashpot.extensions.systems.door.read.read_door` reads it, or what it reads.
    temperature : float, optional
        Temperature of the seal, K, in place of the value in the file.

    Raises
    ------
    ReadError
        If a file cannot be read, or holds an impossible value.
    """
    door = path if isinstance(path, Door) else read_door(path)
    modes = None
    if door.modes is not None:
        choice = door.modes
        modes = read_modes(
            choice.path, unit=choice.unit, modal_mass=choice.modal_mass, damping=choice.damping
        )
        mask = modes.frequency <= choice.most
        if not mask.any():
            raise ReadError(f"{choice.path}: no mode lies below {choice.most:g} Hz (most)")
        modes = modes.only(mask)
    with add_file_to_errors(path):
        fit = None
        if door.seal is not None and door.line is not None:
            choice_of_seal = door.seal
            fit = read_fit(choice_of_seal.fit)
            kelvin = choice_of_seal.temperature if temperature is None else temperature
            section = SealSection.from_fit(
                fit,
                length=choice_of_seal.length,
                temperature=kelvin,
                shear=get_shear(choice_of_seal, kelvin),
                friction=choice_of_seal.friction,
            )
            fit = fit if kelvin is None else fit.at_temperature(kelvin)
            if door.line.compression is not None:
                max_compression = float(door.line.compression.max())
                require_plausible_compression(max_compression, fit.elastic_law, fit.specimen.height)
            door = replace(door, line=replace(door.line, section=section))
        return Assembly(door, modes, dict(_list_fitted_parts(door))), fit


def get_shear(choice: SealChoice, temperature: float | None) -> Shear:
    """Return the sideways stiffness of the seal: ratios, or one metre of a tested seal.

    Raises
    ------
    ReadError
        If a fit cannot be read.
    DataError
        If it belongs to no part, has another temperature, or its length is not known.
    """
    shear_choice, band = choice.shear, None
    values: list[float | Solid] = []
    for path in (shear_choice.across, shear_choice.along):
        if not isinstance(path, str):
            values.append(path)
            continue
        fit = read_fit(path)
        try:
            section = SealSection.from_fit(fit, length=shear_choice.length, temperature=temperature)
        except DataError as error:
            raise DataError(f"{path}: {error}") from None
        values.append(section.solid)
        band = _intersect_bands(band, section.band)
    shear_across, shear_along = values
    return Shear(shear_across, shear_along, band)


def _intersect_bands(
    first: tuple[float, float] | None, second: tuple[float, float] | None
) -> tuple[float, float] | None:
    """Return the frequencies that both tests inform, Hz; (0, 0) where they have none in common."""
    if first is None or second is None:
        return first or second
    low, high = max(first[0], second[0]), min(first[1], second[1])
    return (low, high) if low <= high else (0.0, 0.0)


def add_file_to_errors(path: str | Path | Door) -> AbstractContextManager[None]:
    """Context manager that adds the name of the file to an error."""
    return nullcontext() if isinstance(path, Door) else add_name_to_errors(Path(path).name)


def _list_fitted_parts(door: Door) -> Iterator[tuple[str, Solid]]:
    """Hinges, latch and bumpers that a fit describes, at their compression."""
    for support in (*door.hinges, *((door.latch,) if door.latch else ()), *door.bumpers):
        if not support.fit:
            continue
        document = read_json_document(support.fit)
        if isinstance(document, Fit):
            fit_at_compression = (
                document.at_compression(support.compression) if support.compression else document
            )
            yield support.fit, fit_at_compression.solid
        elif isinstance(document, Solid):
            yield support.fit, document
        else:
            raise ReadError(f"{format_unexpected_kind(support.fit, document)}; expected a fit")


BAND = (1.0, 200.0)
"""Hz, where none is said."""


def door_file(
    path: str | Path | Door,
    *,
    band: tuple[float, float] | None = None,
    temperature: float | None = None,
) -> DoorResult:
    """Find the modes of a door on its seal, its FRFs, and how it follows a base that shakes.

    Parameters
    ----------
    path : path or Door
        TOML, as :func:`~dashpot.extensions.systems.door.read.read_door` reads it, or what it reads.
    band : (float, float), optional
        Band of the FRFs and modes, Hz; 1 to 200 Hz by default.
    temperature : float, optional
        Temperature of the seal, K, in place of the value in the file.

    Raises
    ------
    ReadError
        If a file cannot be read, or holds an impossible value.
    """
    assembly, fit = open_door(path, temperature=temperature)
    band = band or BAND
    with add_file_to_errors(path):
        system, system_without_seal = assembly.system(), assembly.system(sealed=False)
        modes = door_modes(assembly, band[1])
        points = _list_points(assembly)
        driven_point = next(point for point in points if point.on == DOOR)
        lines = np.linspace(*band, LINES)
        frfs = []
        for door_point in points:
            sealed, frf_without_seal = (
                item.frf(
                    response=_make_place(door_point),
                    force=_make_place(driven_point),
                    frequency=lines,
                )
                for item in (system, system_without_seal)
            )
            frfs.append((door_point.name, sealed, frf_without_seal))
        base_responses = (
            tuple(_list_shaken_responses(assembly, points)) if assembly.door.base else ()
        )
        return DoorResult(
            assembly,
            fit,
            band,
            modes,
            tuple(mode.frequency for mode in find_oscillations(system_without_seal, band[1])),
            driven_point,
            tuple(frfs),
            base_responses,
            (*(fit.checks if fit else ()), *check_door(assembly, fit, modes, band[1])),
        )


def _list_points(assembly: Assembly) -> tuple[DoorPoint, ...]:
    """Return the points of the file, or the farthest corner; the first on the door is driven."""
    door = assembly.door
    if any(point.on == BODY for point in door.points) and door.body is None:
        raise DataError(
            "a point is on the body, which stands still: give [body] a mass, inertia and centre"
        )
    if any(point.on == DOOR for point in door.points):
        return door.points
    return (_find_far_corner(assembly), *door.points)


def _find_far_corner(assembly: Assembly) -> DoorPoint:
    """Return the point of the door that is farthest from its hinges."""
    door, modes = assembly.door, assembly.modes
    support_points = np.array([hinge.at for hinge in door.hinges] or [assembly.body().at])
    candidate_points = door.line.points if door.line else modes.place if modes else support_points
    distances = np.linalg.norm(candidate_points[:, None] - support_points, axis=2).min(axis=1)
    x, y, z = candidate_points[int(distances.argmax())].tolist()
    a, b, c = (0.0, 0.0, 1.0)
    if door.line:
        a, b, c = door.line.normal_at(door.line.arc_length[int(distances.argmax())]).tolist()
    return DoorPoint("farthest from the hinges", (x, y, z), (a, b, c))


def _make_place(point: DoorPoint) -> Point:
    return Point(point.on, point.at, point.along)


def _list_shaken_responses(
    assembly: Assembly, points: tuple[DoorPoint, ...]
) -> Iterator[BaseResponse]:
    door = assembly.door
    if door.body is not None:
        raise DataError(
            "[base] shakes a body that [body] lets move by itself: leave one of both out"
        )
    respond = require_handler("random base", "system")(door.base, base=BODY, along=door.base_along)
    for point in points:
        responses: list[RandomResponse | None] = []
        for sealed in (True, False):
            try:
                response = respond(assembly.system(sealed=sealed), _make_place(point))
            except DataError:
                if sealed:
                    raise
                response = None
            responses.append(response)
        if responses[0] is not None:
            yield BaseResponse(point.name, responses[0], responses[1])


def check_door(
    assembly: Assembly, fit: Fit | None, modes: tuple[DoorMode, ...], max_hz: float
) -> Iterator[Check]:
    """Every check of a door."""
    door = assembly.door
    yield from _check_lateral_stiffness(assembly)
    yield checks.door_supported(count_free_motions(assembly.system()))
    if fit is not None and door.line is not None:
        response = [
            (mode.mode.frequency, max(mode.share(SEAL), mode.loss_share(SEAL))) for mode in modes
        ]
        section = door.line.section
        band = fit.band if section is None else _intersect_bands(fit.band, section.shear.band)
        yield checks.door_modes_in_valid_band(response, band)
        yield from _check_seal_line(door.line, assembly, fit, max_hz)
        if fit.temperatures is not None and fit.specimen.temperature is not None:
            yield temperature_tested(fit.temperatures, fit.specimen.temperature)
    if assembly.modes is not None:
        yield from _check_modes(assembly.modes, assembly, max_hz)


def _check_lateral_stiffness(assembly: Assembly) -> Iterator[Check]:
    """Yield the check of the lateral stiffness of the seal."""
    line = assembly.door.line
    section = None if line is None else line.section
    if line is None or section is None:
        return
    if not section.shear.holds:
        yield checks.lateral_restraint_present(*count_lateral_free_motions(assembly))
        return
    stations = line.stations(assembly.door.pitch)
    normal, *lateral_stiffnesses = (
        direction.solid.k_inf * direction.share.sum() for direction in section.ways(stations)
    )
    if normal > 0:
        yield checks.shear_stiffness_plausible(float(max(lateral_stiffnesses) / normal))


def _check_seal_line(
    line: SealLine, assembly: Assembly, fit: Fit, max_hz: float
) -> Iterator[Check]:
    """Whether the seal is all there, finely enough, and pressed as it was tested."""
    norm = float(np.linalg.norm(line.points[0] - line.points[-1]))
    segment_lengths = np.diff(line.arc_length).tolist()
    yield checks.line_closed(line.length, 0.0 if line.is_closed else norm, segment_lengths)
    yield checks.stations_suffice(estimate_station_error(assembly, max_hz), assembly.door.pitch)
    stations = line.stations(assembly.door.pitch)
    compressions = stations.compression
    if compressions is not None:
        yield check_contact(compressions, stations.along, line.length)
        law = fit.elastic_law
        yield compression_tested(float(compressions.max()), None if law is None else law.depth)


def check_contact(compressions: FloatArray, positions: FloatArray, length: float) -> Check:
    """Return whether the seal touches at all stations, by their compressions and places, m."""
    worst_index = int(compressions.argmin())
    return checks.seal_touches(
        float((compressions < 0).mean()),
        length=length,
        min_compression=float(compressions[worst_index]),
        position=float(positions[worst_index]),
        max_compression=float(compressions.max()),
    )


def _check_modes(modes: FreeModes, assembly: Assembly, max_hz: float) -> Iterator[Check]:
    """Whether the shapes are known where they are held, and enough of them."""
    yield checks.mode_shapes_cover_points(*find_farthest_point(assembly, modes))
    elastic = modes.frequency[~modes.rigid]
    highest = float(elastic.max(initial=0.0))
    yield checks.modes_suffice(estimate_basis_error(assembly, max_hz), len(elastic), highest)
    rigid = assembly.door.rigid
    implied = None if rigid is None else estimate_mass(modes, rigid)
    if rigid is not None and implied is not None:
        yield checks.masses_agree(rigid.mass, implied)
