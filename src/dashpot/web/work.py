"""What the workers do: from a page's request to a message, one function for each verb.

Every function takes the request and the folder of the files; what it computes it keeps for the
next question, by the job that asked for it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from dashpot import export, plot, report, workflow
from dashpot.base.errors import DashpotError, DataError
from dashpot.base.progress import doing
from dashpot.fitting.relaxation import fit
from dashpot.io.options import ReadOptions, dump_profile
from dashpot.io.readers.relaxation import read_relaxation, relaxation_in
from dashpot.preparation.prepare import prepare
from dashpot.records.fit import Fit
from dashpot.records.frf import FRF
from dashpot.records.relaxation import RampHold, RelaxationTest
from dashpot.records.specimen import Specimen
from dashpot.report.figures import stamp
from dashpot.report.pages import COLOURS
from dashpot.report.summary import simulated
from dashpot.vibration.systems.prediction import predict_frf
from dashpot.web import records, views, wire
from dashpot.web.requests import job_of, part, sizes_of
from dashpot.web.store import path_in
from dashpot.workflow.archive import to_json
from dashpot.workflow.command_lines import report_command
from dashpot.workflow.inspections import InspectedFile, inspect_files
from dashpot.workflow.job import Job
from dashpot.workflow.project import with_paths
from dashpot.workflow.shifting import each_specimen
from dashpot.workflow.study import Study, of_solid, run

Verb = Callable[[Mapping[str, Any], Path], bytes]

KEPT = 8
"""Results of each kind that a worker remembers."""
WHILE_HELD = 300_000
"""Samples that are prepared while a handle is held; all of them are once it is let go."""
HINT = (
    "Give the mass of the block and the number of seals: the hammer is then held against what the "
    "relaxation test predicts."
)
LIVE_LINES = np.geomspace(0.3, 3.0, 301)
"""Lines of a response that follows the mass, as multiples of its peak's frequency."""


# -- results by job -------------------------------------------------------------------------------


_test = lru_cache(KEPT)(records.relaxation)


def _tests(job: Job) -> tuple[RelaxationTest, ...]:
    """The tests of a job, each with its own temperature where that is said."""
    files = job.relaxation, *job.further
    each = each_specimen(job.specimen, job.temperatures, len(files))
    return tuple(_test(file, job.reading, one) for file, one in zip(files, each, strict=True))


@lru_cache(KEPT)
def _prepared(job: Job, most: int | None) -> tuple[RampHold, ...]:
    """The tests of a job, prepared; of each as many samples as there are, or `most`."""
    tests = _tests(job)
    if most is not None and all(len(test.time) <= most for test in tests):
        return _prepared(job, None)
    job.cuts.refuse_several(len(tests))
    return tuple(
        prepare(
            _thinned(test, most),
            filter=job.filter,
            machine=job.machine,
            cycle=job.reading.cycle,
            **asdict(job.cuts),
        )
        for test in tests
    )


def _thinned(test: RelaxationTest, most: int | None) -> RelaxationTest:
    """The test with every so manieth sample."""
    step = 1 if most is None else -(-len(test.time) // most)
    if step == 1:
        return test
    few = {name: getattr(test, name)[::step] for name in ("time", "displacement", "force")}
    return replace(test, **few)


@lru_cache(KEPT)
def _fitted(job: Job, intervals: bool, most: int | None) -> Fit:
    return fit(
        _prepared(_of_test(job), most),
        arms=job.arms,
        method=job.method,
        law=job.law,
        family=job.family,
        intervals=intervals,
    )


def _beside(job: Job, found: Fit, most: int | None = None) -> Fit | None:
    """The fit of eq. (5) with as many arms, of one test; None where it has nothing to say."""
    if found.family != "maxwell" or job.further:
        return None
    return _by_eq5(_of_test(job), found.model.arms, most)


@lru_cache(KEPT)
def _by_eq5(job: Job, arms: int, most: int | None) -> Fit | None:
    try:
        return fit(_prepared(job, most), arms=arms, method="hold", intervals=False)
    except DashpotError:
        return None


def _shown(job: Job, found: Fit, most: int | None = None) -> tuple[RelaxationTest, RampHold]:
    """The test that is drawn: that of the temperature of the solid."""
    prepared = _prepared(_of_test(job), most)
    first = of_solid(found, prepared)
    return _tests(job)[first], prepared[first]


@lru_cache(KEPT)
def _study(job: Job) -> Study:
    return run(job, read=_test)


def _of_test(job: Job) -> Job:
    """What of a job decides the prepared test."""
    return Job(
        job.relaxation,
        further=job.further,
        temperatures=job.temperatures,
        filter=job.filter,
        cuts=job.cuts,
        specimen=job.specimen,
        machine=job.machine,
        reading=job.reading,
    )


def _of_fit(job: Job) -> Job:
    """What of a job decides the fit of the relaxation test."""
    return replace(_of_test(job), arms=job.arms, method=job.method, law=job.law, family=job.family)


# -- verbs ----------------------------------------------------------------------------------------


def inspect(request: Mapping[str, Any], folder: Path) -> bytes:
    """What is in a file, and what it asks."""
    path = path_in(folder, request.get("file"))
    options = part(ReadOptions, request.get("options", {}), "options")
    job = Job(str(path), reading=options)
    # what is read and prepared here is what the fit asks for next
    (found,) = inspect_files(
        [path],
        options=options,
        read=lambda file: records.keep(str(path), options, relaxation_in(file, Specimen())),
        prepared=lambda *_: _prepared(_of_test(job), WHILE_HELD)[0],
    ).files
    head = views.file_row(found)
    head["long"] = found.rows > WHILE_HELD
    if head["mark"] != "good" or found.kind not in views.TAKEN:
        head["asked"] = views.asked(found, _consequences(path, found, options))
    return wire.packed({**head, "name": path.name})


def _consequences(
    path: Path, found: InspectedFile, options: ReadOptions
) -> list[views.Consequence]:
    """What the seal would be by each unit that a relaxation test could be in."""
    if found.kind not in ("relaxation", "unclear") or len(found.questions) != 1:
        return []
    option = found.questions[0].option
    told = []
    for role, words in (("force", ("N", "gf", "mN", "kgf")), ("displacement", ("mm", "um", "m"))):
        if f"{role}=" not in option:
            continue
        for word in words:
            given = replace(options, units={**dict(options.units), role: word})
            try:
                test = prepare(read_relaxation(path, options=given))
                solid = fit(test, arms=1, intervals=False).model
            except DashpotError:
                continue
            stiffness = 1e-3 * float(solid.relaxation(test.hold_time))
            told.append(
                views.Consequence(word, f"{float(test.force.max()):.3g}", f"{stiffness:.3g}")
            )
    return told


def live(request: Mapping[str, Any], folder: Path) -> bytes:
    """The point estimate while a handle is held: curves and numbers, no intervals."""
    job = job_of(request.get("job"), folder)
    found = _fitted(_of_fit(job), job.arms == "auto", WHILE_HELD)
    _, prepared = _shown(job, found, WHILE_HELD)
    shown = views.live_test(found, prepared, _beside(job, found, WHILE_HELD))
    return wire.packed({"beside": shown.words, "cuts": _cuts(prepared)}, shown.arrays)


def settle(request: Mapping[str, Any], folder: Path) -> bytes:
    """The fit with its intervals and checks, every panel of the test, and the command line.

    A `quick` one is of a part of the samples, to have something to look at meanwhile.
    """
    job = job_of(request.get("job"), folder)
    sizes = sizes_of(request)
    most = WHILE_HELD if request.get("quick") is True else None
    found = _fitted(_of_fit(job), True, most)
    test, prepared = _shown(job, found, most)
    by_eq5 = _beside(job, found, most)
    panels = views.test_panels(found, prepared, by_eq5, sizes)
    if job.mass is not None:
        panels["frf"] = views.response_panel(_predicted(found, job), sizes)
    return wire.packed(
        {
            "verdict": views.verdict(found.verdict),
            "colour": COLOURS[found.verdict.use],
            "solid": views.solid_table(found),
            "checks": views.check_list(found.checks),
            "beside": views.piece("beside", rows=views.beside(found, by_eq5)),
            "panels": panels,
            "cuts": _cuts(prepared),
            "clock": [float(test.time[0]), float(test.time[-1])],
            "step": float(np.median(np.diff(test.time))),
            "arms": found.model.arms if found.family == "maxwell" else "",
            "simulated": test.source is not None and test.source.simulated,
            "command": command(job),
        }
    )


def _cuts(prepared: RampHold) -> dict[str, float]:
    return {
        "onset": prepared.onset, "ramp_end": prepared.ramp_end, "hold_end": prepared.hold_end
    }  # fmt: skip


def _predicted(found: Fit, job: Job) -> FRF:
    assert job.mass is not None  # noqa: S101 -- every caller asked
    return predict_frf(found, mass=job.mass, seals=job.seals, compression=job.compression)


def predict(request: Mapping[str, Any], folder: Path) -> bytes:
    """The response of the mass while it moves: a bare curve."""
    job = job_of(request.get("job"), folder)
    if job.mass is None:
        raise DataError("no mass is given: say what rests on the seals, such as 104 g")
    found = _fitted(_of_fit(job), job.arms == "auto", None)
    top = np.sqrt(job.seals * found.solid.k_0 / job.mass) / (2 * np.pi)
    lines = top * LIVE_LINES
    shown = views.live_response(
        predict_frf(
            found, mass=job.mass, frequency=lines, seals=job.seals, compression=job.compression
        )
    )
    return wire.packed({"peak": shown.words, "command": command(job)}, shown.arrays)


def study(request: Mapping[str, Any], folder: Path) -> bytes:
    """The whole story: bound, comparison, joint fit where asked, answers and verdict."""
    job = job_of(request.get("job"), folder)
    sizes = sizes_of(request)
    found = _study(job)
    # what a hammer says of a mass that nobody gave, on one seal, is no verdict yet
    asks = found.mass_inferred
    judged, said = (found.fit.checks, found.fit.verdict) if asks else (found.weighed, found.verdict)
    weighed = [check for check in judged if check.failed]
    passed = [check for check in judged if not check.failed]
    head: dict[str, Any] = {
        "verdict": views.verdict(said),
        "colour": COLOURS[said.use],
        "hint": HINT if asks else "",
        "answers": views.answers(found),
        "checks": views.check_list([*weighed, *passed]),
        "frf": views.study_panel(found, sizes),
        "hits": "" if found.measured is None else views.hit_table(found.measured.hits),
        "hit_panels": views.hit_panels(found, sizes),
        "hammer": views.hammer_line(found),
        "joint": None if found.joint is None else views.solid_table(found.joint),
        "simulated": bool(simulated(found)),
        "command": command(job),
    }
    return wire.packed(head)


def command(job: Job) -> str:
    """The command that gives the page's numbers, with the names of its files."""
    return report_command(with_paths(job, lambda path: Path(path).name))


# -- what can be taken away -----------------------------------------------------------------------


def take(request: Mapping[str, Any], folder: Path) -> bytes:
    """A file to take away: a head with its name and kind, then its bytes."""
    job = job_of(request.get("job"), folder)
    what = request.get("what")
    makers: dict[object, Callable[[], tuple[str, str, str]]] = {
        "report": lambda: ("report.html", "text/html", report.html(_told(job))),
        "fit": lambda: ("fit.json", "application/json", to_json(_fitted(_of_fit(job), True, None))),
        "joint": lambda: ("joint.json", "application/json", to_json(_joint(job))),
        "deck": lambda: _deck(request, job),
        "picture": lambda: _picture(job),
        "frf": lambda: ("frf.csv", "text/csv", _lines(job)),
    }
    if what not in makers:
        raise DataError(
            f"'{what}' is nothing to take away; expected one of {', '.join(map(str, makers))}"
        )
    name, kind, text = makers[what]()
    return wire.packed({"name": name, "kind": kind, "text": text})


def profile(request: Mapping[str, Any], folder: Path) -> bytes:  # noqa: ARG001
    """Answers to a file's questions, as TOML that every command reads."""
    options = part(ReadOptions, request.get("options", {}), "options")
    return wire.packed(
        {"name": "profile.toml", "kind": "application/toml", "text": dump_profile(options)}
    )


def _told(job: Job) -> Study:
    found = _study(job)
    doing("drawing the report")
    return found


def _joint(job: Job) -> Fit:
    found = _study(job).joint
    if found is None:
        raise DataError("there is no solid of both tests: open a hammer test and fit both")
    return found


def _deck(request: Mapping[str, Any], job: Job) -> tuple[str, str, str]:
    target, units = request.get("target"), request.get("units", "mm-t-s")
    if target not in export.TARGETS:
        raise DataError(f"'{target}' is no solver; expected one of {', '.join(export.TARGETS)}")
    solid = _joint(job) if request.get("joint") is True else _fitted(_of_fit(job), True, None)
    allow = ("all",) if request.get("anyway") is True else ()
    text = export.TARGETS[str(target)](solid, units=units, allow=allow)
    suffix = {"nastran": "bdf", "abaqus": "inp", "calculix": "inp", "csv": "csv"}.get(
        str(target), "txt"
    )
    return f"{target}.{suffix}", "text/plain", str(text)


def _picture(job: Job) -> tuple[str, str, str]:
    found = _study(job)
    hero = replace(plot.hero(found), stamp=stamp(found))
    return "seal.svg", "image/svg+xml", plot.to_svg(hero)


def _lines(job: Job) -> str:
    found = _study(job)
    if found.prediction is None:
        raise DataError("no mass is given, so there is no response to take away")
    rows = ["frequency [Hz],real [(m/s^2)/N],imaginary [(m/s^2)/N]"]
    values = zip(found.prediction.frequency, found.prediction.value, strict=True)
    rows += [f"{f!r},{v.real!r},{v.imag!r}" for f, v in ((float(f), complex(v)) for f, v in values)]
    return "\n".join([*rows, ""])


def project(request: Mapping[str, Any], folder: Path) -> bytes:
    """Keep raw files, results and history in a project folder."""
    job = job_of(request.get("job"), folder)
    place = request.get("folder")
    if not isinstance(place, str) or not place.strip():
        raise DataError("no folder is named: type where the project is to be kept")
    home = workflow.create(Path(place).expanduser())
    _, page = workflow.record(home, job, page=report.html)
    return wire.packed({"folder": str(home.folder), "report": str(page), "head": home.head})


VERBS: Mapping[str, Verb] = {
    "inspect": inspect, "live": live, "settle": settle, "predict": predict, "study": study,
    "take": take, "profile": profile, "project": project,
}  # fmt: skip
"""Every question that a page may put to a worker."""
