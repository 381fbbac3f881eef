"""A project folder: raw files untouched, every result traceable, the history append-only.

::

    project/
      dashpot.toml      what this folder is
      raw/              input files, byte for byte, never overwritten
      profiles/         what was said of how to read them, TOML
      records/          results, named by the first 16 digits of the hash of job and result, and
                        the fits among them, which every command reads
      reports/          HTML, one per result
      history.jsonl     one line per operation, each with the hash of the line before it

A file is written beside its place and moved there; the line of history comes last, in one write.
So dashpot may be killed at any point: what has no line of history has not happened.
"""

from __future__ import annotations

import contextlib
import getpass
import hashlib
import json
import os
import platform
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from dashpot.base.checks import Check
from dashpot.base.errors import DataError, ReadError
from dashpot.base.version import __version__
from dashpot.io.options import ReadOptions, dump_profile
from dashpot.workflow import checks
from dashpot.workflow.archive import document, from_json, to_json
from dashpot.workflow.job import Job
from dashpot.workflow.study import Study, run

SCHEMA = "dashpot/project@1"
_GENESIS = "0" * 64


@dataclass(frozen=True)
class Project:
    """A project folder that exists.

    Attributes
    ----------
    folder : Path
    """

    folder: Path

    @property
    def history_file(self) -> Path:
        """The append-only log."""
        return self.folder / "history.jsonl"


def create(folder: str | Path) -> Project:
    """Return the project in `folder`, made if there is none.

    Raises
    ------
    DataError
        If the folder holds files but is no project.
    """
    path = Path(folder)
    if (path / "dashpot.toml").exists():
        return open_project(path)
    if path.exists() and any(path.iterdir()):
        raise DataError(
            f"{path} holds files but no dashpot.toml; choose an empty folder for a new project"
        )
    for part in ("raw", "profiles", "records", "reports"):
        (path / part).mkdir(parents=True, exist_ok=True)
    _place(path / "dashpot.toml", f'schema = "{SCHEMA}"\nname = {json.dumps(path.name)}\n'.encode())
    return Project(path)


def open_project(folder: str | Path) -> Project:
    """Return the project in `folder`.

    Raises
    ------
    ReadError
        If there is none, or one of a version that this dashpot cannot read.
    """
    path = Path(folder)
    try:
        about = tomllib.loads((path / "dashpot.toml").read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise ReadError(f"{path} is not a project: it has no dashpot.toml") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ReadError(f"{path / 'dashpot.toml'} is not TOML: {error}") from None
    if about.get("schema") != SCHEMA:
        raise ReadError(
            f"{path / 'dashpot.toml'} has schema {about.get('schema')!r}; expected {SCHEMA!r}"
        )
    return Project(path)


def record(project: Project, job: Job, *, page: Callable[[Study], str]) -> tuple[Study, Path]:
    """Run a job inside the project; return its study and where the report is.

    `page` makes the HTML report of a study.
    """
    with _alone(project):
        kept = replace(
            job,
            relaxation=_keep(project, job.relaxation),
            impact=tuple(_keep(project, path) for path in job.impact),
        )
        study = run(_inside(project, kept))
        result = json.dumps(results(study), indent=2, ensure_ascii=False).encode()
        # two questions may have one answer, but not one report
        name = _sha256(to_json(kept).encode() + result)[:16]
        outputs = {f"records/{name}.json": result, f"reports/{name}.html": page(study).encode()}
        fits = {"fit": study.fit, "joint": study.joint}
        outputs |= {
            f"records/{name}.{what}.json": to_json(fit).encode()
            for what, fit in fits.items()
            if fit is not None
        }
        outputs |= _profiles(kept)
        for place, content in outputs.items():
            _place(project.folder / place, content)
        _append(
            project,
            {
                "operation": "report",
                "job": document(kept),
                "inputs": [_listed(project, path) for path in (kept.relaxation, *kept.impact)],
                "outputs": [{"file": f, "sha256": _sha256(c)} for f, c in outputs.items()],
            },
        )
    return study, project.folder / f"reports/{name}.html"


def results(study: Study) -> dict[str, Any]:
    """Return the numbers of a study that verification recomputes and compares."""
    parts: dict[str, Any] = {"schema": "dashpot/result@1", "mass": study.mass}
    parts["fit"] = _numbers(study.fit)
    parts["alternatives"] = [_numbers(fit) for fit in study.alternatives]
    for name in ("joint", "comparison", "joint_comparison"):
        value = getattr(study, name)
        parts[name] = None if value is None else _numbers(value)
    return parts


def verify(project: Project) -> tuple[Check, ...]:
    """Check every hash and the chain of history, and recompute every result from its raw files."""
    found: list[Check] = []
    before = _GENESIS
    lines, torn = _lines(project)
    if torn:
        found.append(checks.history_complete())
    for number, line in enumerate(lines, start=1):
        entry = _entry(line, number)
        whole = entry.get("previous") == before and entry.get("hash") == _chained(entry)
        found.append(checks.history_unchanged(number, whole=whole))
        before = str(entry.get("hash"))
        for listed in (*entry.get("inputs", ()), *entry.get("outputs", ())):
            found.append(_file_check(project, listed, number))
        if all(not check.failed for check in found if check.name.startswith("file")):
            found.append(_recomputed(project, entry, number))
    return tuple(found)


# -- files ---------------------------------------------------------------------------------------


def _keep(project: Project, path: str) -> str:
    """Copy a file into ``raw/`` unless it is there; return its place inside the project."""
    source = Path(path)
    content = source.read_bytes()
    place = project.folder / "raw" / source.name
    if place.exists() and place.read_bytes() != content:
        place = place.with_name(f"{source.stem}-{_sha256(content)[:16]}{source.suffix}")
    if not place.exists():
        _place(place, content)
    return f"raw/{place.name}"


def _within(project: Project, path: str) -> Path:
    """Return a place named in the project's own files, which must be inside the project."""
    root = project.folder.resolve()
    place = (root / path).resolve()
    if not place.is_relative_to(root):
        raise ReadError(f"{path} leads out of the project; nothing outside it is read")
    return place


def _inside(project: Project, job: Job) -> Job:
    """Return the job with paths that can be opened."""
    return replace(
        job,
        relaxation=str(_within(project, job.relaxation)),
        impact=tuple(str(_within(project, path)) for path in job.impact),
    )


def _profiles(job: Job) -> dict[str, bytes]:
    """Return the reading profiles of a job, where the user said anything, by their place."""
    stated = {dump_profile(options) for options in (job.reading, job.reading_impact)}
    texts = [text.encode() for text in stated - {dump_profile(ReadOptions())}]
    return {f"profiles/{_sha256(text)[:16]}.toml": text for text in texts}


def _place(path: Path, content: bytes) -> None:
    """Write a file whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f".{path.name}.{os.getpid()}.part")
    with beside.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    beside.replace(path)


def _listed(project: Project, path: str) -> dict[str, str]:
    return {"file": path, "sha256": _sha256((project.folder / path).read_bytes())}


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


@contextlib.contextmanager
def _alone(project: Project) -> Iterator[None]:
    """Hold the project against a second dashpot; a lock left by a dead one is taken over."""
    lock = project.folder / ".lock"
    try:
        descriptor = os.open(lock, os.O_CREAT | os.O_EXCL | os.O_WRONLY)
    except FileExistsError:
        owner = lock.read_text(encoding="utf-8").strip()
        if owner.isdecimal() and _alive(int(owner)):
            raise DataError(
                f"{project.folder} is in use by process {owner}; try again when it is done (if no "
                f"dashpot runs, remove {lock})"
            ) from None
        lock.unlink(missing_ok=True)
        descriptor = os.open(lock, os.O_CREAT | os.O_EXCL | os.O_WRONLY)
    try:
        os.write(descriptor, str(os.getpid()).encode())
        os.close(descriptor)
        yield
    finally:
        lock.unlink(missing_ok=True)


def _alive(process: int) -> bool:
    if os.name == "nt":
        return True  # there is no harmless signal to ask with
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True


# -- history -------------------------------------------------------------------------------------


def _append(project: Project, content: dict[str, Any]) -> None:
    """Add one line, with the hash of the line before it, in one write."""
    lines, torn = _lines(project)
    if torn:  # an operation that was cut short never happened; its half line must not stay
        _place(project.history_file, b"".join(line + b"\n" for line in lines))
    entry = {
        "line": len(lines) + 1,
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
        "user": _user(),
        **content,
        "software": _software(),
        "previous": str(_entry(lines[-1], len(lines))["hash"]) if lines else _GENESIS,
    }
    entry["hash"] = _chained(entry)
    with project.history_file.open("ab") as file:
        file.write(json.dumps(entry, ensure_ascii=False).encode() + b"\n")
        file.flush()
        os.fsync(file.fileno())


def _lines(project: Project) -> tuple[list[bytes], bool]:
    """Return the whole lines of history, and whether a cut line follows them."""
    try:
        content = project.history_file.read_bytes()
    except FileNotFoundError:
        return [], False
    *whole, rest = content.split(b"\n")
    return whole, bool(rest)


def _entry(line: bytes, number: int) -> dict[str, Any]:
    try:
        entry = json.loads(line)
    except ValueError:
        entry = None
    if not isinstance(entry, dict):
        raise ReadError(f"line {number} of history.jsonl is not a JSON object: it was changed")
    return entry


def _chained(entry: dict[str, Any]) -> str:
    without = {key: value for key, value in entry.items() if key != "hash"}
    return _sha256(json.dumps(without, sort_keys=True, ensure_ascii=False).encode())


def _user() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return "unknown"


def _software() -> dict[str, str]:
    import numpy as np
    import scipy

    return {
        "dashpot": __version__,
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "python": platform.python_version(),
    }


# -- verification --------------------------------------------------------------------------------


def _file_check(project: Project, listed: dict[str, str], number: int) -> Check:
    path = _within(project, listed["file"])
    if not path.is_file():
        return checks.file_present(listed["file"], number)
    same = _sha256(path.read_bytes()) == listed["sha256"]
    return checks.file_unchanged(listed["file"], number, same=same)


def _recomputed(project: Project, entry: dict[str, Any], number: int) -> Check:
    job = from_json(json.dumps(entry["job"]))
    again = results(run(_inside(project, job)))
    place = next(item["file"] for item in entry["outputs"] if item["file"].startswith("records/"))
    kept = json.loads(_within(project, place).read_text(encoding="utf-8"))
    worst, where = _difference(kept, json.loads(json.dumps(again)))
    return checks.result_recomputed(worst, where, number)


def _numbers(noun: object) -> dict[str, Any]:
    """Return a noun's document without its sampled arrays and its words."""
    whole = json.loads(to_json(noun))
    dropped = {"predicted", "measured", "profiles", "checks", "source", "steps", "verdict", "says"}
    return {key: value for key, value in whole.items() if key not in dropped}


def _difference(kept: Any, again: Any, where: str = "") -> tuple[float, str]:
    """Return the largest relative difference between two documents, and its place."""
    if isinstance(kept, dict) and isinstance(again, dict):
        if kept.keys() != again.keys():
            return float("inf"), f"{where or 'the document'} has other keys"
        pairs = [(kept[key], again[key], f"{where}.{key}".lstrip(".")) for key in kept]
    elif isinstance(kept, list) and isinstance(again, list):
        if len(kept) != len(again):
            return float("inf"), f"{where} has another length"
        pairs = [(a, b, f"{where}[{i}]") for i, (a, b) in enumerate(zip(kept, again, strict=True))]
    elif _is_number(kept) and _is_number(again):
        scale = max(abs(kept), abs(again))
        relative = abs(kept - again) / scale if scale > 0 else 0.0
        return relative, f"{where} was {kept!r} and is {again!r}"
    else:
        return (0.0 if kept == again else float("inf")), f"{where} was {kept!r} and is {again!r}"
    return max((_difference(*pair) for pair in pairs), default=(0.0, ""), key=lambda item: item[0])


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
