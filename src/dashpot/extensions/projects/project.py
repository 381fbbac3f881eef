"""Project folder: raw files, traceable results, and an append-only history.

::

    project/
      dashpot.toml      what this folder is
      raw/              input files, byte for byte, never overwritten
      profiles/         what was said of how to read them, TOML
      records/          results, named by the first 16 digits of the hash of job and result, and
                        the fits among them, which every command reads
      reports/          HTML, one per result
      history.jsonl     one line per operation, each with the hash of the line before it
      history.head      how many lines that are, and the hash of the last
      .lock             held while dashpot writes here

A file is written beside its place and moved there; the line of history comes last, in one write. So
dashpot may be killed at any point: only runs with a line of history count.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from dashpot.base import dataclass
from dashpot.base.errors import DataError, ReadError
from dashpot.base.file_writing import PART, open_exclusive_lock, validate_path, write_atomic
from dashpot.base.serialisation import Key, Serialisable, to_plain_value
from dashpot.extensions.projects.document_versions import name_present_schema
from dashpot.extensions.projects.history import (
    FileEntry,
    append,
    get_log_path,
    read_history,
    sha256,
)
from dashpot.reading.raw_file import missing, open_raw
from dashpot.reading.read_options import ReadOptions, dump_profile
from dashpot.reading.toml import parsed_toml
from dashpot.workflow.job import Job, replace_paths
from dashpot.workflow.json_archive import from_json, to_document, to_json
from dashpot.workflow.study import Study, run

SCHEMA = "dashpot/project@2"
NAME = 16
"""Digits of a hash that name a result."""

UNLISTED_FILES = ("dashpot.toml", "history.jsonl", "history.head", ".lock")
"""Files of a project that no line of its history lists."""


@dataclass(frozen=True)
class Project:
    """Existing project folder.

    Attributes
    ----------
    folder : Path
    """

    folder: Path

    @property
    def history_file(self) -> Path:
        """The append-only log."""
        return get_log_path(self.folder)

    @property
    def head(self) -> str:
        """The hash of the last line of its history: whoever notes it can ask for it later."""
        return read_history(self.folder).last


def create(folder: str | Path) -> Project:
    """Return the project in `folder`, created if there is none.

    Raises
    ------
    DataError
        If the folder holds files but is no project.
    """
    path = validate_path(folder)
    if (path / "dashpot.toml").exists():
        return open_project(path)
    if path.exists() and any(not entry.name.endswith(PART) for entry in path.iterdir()):
        raise DataError(
            f"{path} holds files but no dashpot.toml; choose an empty folder for a new project"
        )
    path.mkdir(parents=True, exist_ok=True)
    _write_about(path, path.name)
    return Project(path)


def _write_about(folder: Path, name: str) -> None:
    header_text = f'schema = "{SCHEMA}"\nname = {json.dumps(name)}\n'
    write_atomic(folder / "dashpot.toml", header_text.encode())


def open_project(folder: str | Path) -> Project:
    """Return the project in `folder`.

    Raises
    ------
    ReadError
        If there is none, or one of a version that this dashpot cannot read.
    """
    path = validate_path(folder)
    try:
        project_table = parsed_toml((path / "dashpot.toml").read_bytes())
    except (FileNotFoundError, NotADirectoryError):
        if not path.exists():
            advice = "A project is the folder that dashpot report --project FOLDER made."
            raise ReadError(f"{missing(path)} {advice}") from None
        reason = "it is a file" if path.is_file() else "it has no dashpot.toml"
        raise ReadError(
            f"{path} is not a project: {reason}; expected the folder that dashpot report --project "
            "FOLDER made"
        ) from None
    except ReadError as error:
        raise ReadError(f"{path / 'dashpot.toml'}: {error}") from None
    if name_present_schema(str(project_table.get("schema"))) != SCHEMA:
        raise ReadError(
            f"{path / 'dashpot.toml'} has schema {project_table.get('schema')!r}; expected "
            f"{SCHEMA!r} or a former version. Update dashpot if a newer one made the project"
        )
    return Project(path)


def open_last_job(folder: str | Path) -> tuple[Job, Callable[[str], Path]]:
    """Return the job of the last line of a project's history, and a function that finds its files.

    Raises
    ------
    DataError
        If there is no line, or the history is not as it was written.
    """
    project = open_project(folder)
    history = read_history(project.folder)
    if not history.lines:
        raise DataError(f"{folder} is a project without a result: open its files by hand")
    if not all(history.is_intact):
        raise DataError(
            f"the history of {folder} is not as dashpot wrote it: 'dashpot verify' says where"
        )
    job: Job = from_json(json.dumps(history.lines[-1].job))
    return job, partial(resolve_project_path, project)


def record(project: Project, job: Job, *, page: Callable[[Study], str]) -> tuple[Study, Path]:
    """Run a job inside the project; return its study and where the report is.

    `page` makes the HTML report of a study.

    Raises
    ------
    DataError
        If another dashpot writes there, or a file of the project is not as it was recorded.
    """
    with open_exclusive_lock(project.folder / ".lock", str(project.folder)):
        for item in project.folder.rglob(f".*{PART}"):  # by a dashpot that was killed
            item.unlink(missing_ok=True)
        retained_job = replace_paths(job, lambda path: _keep(project, path))
        inputs = {
            path: sha256((project.folder / path).read_bytes()) for path in list_paths(retained_job)
        }
        study = run(resolve_job_paths(project, retained_job))
        new_contents = list_contents(study, page)
        name = get_result_name(to_document(retained_job), new_contents["records/.json"])
        outputs = {
            file_path.replace("/.", f"/{name}."): block for file_path, block in new_contents.items()
        }
        project_table = parsed_toml((project.folder / "dashpot.toml").read_bytes())
        if project_table.get("schema") != SCHEMA:  # what is added is of the present version
            _write_about(project.folder, str(project_table.get("name", project.folder.name)))
        profile_files = make_profiles(retained_job)
        for file_path, content in (profile_files | outputs).items():
            (project.folder / file_path).parent.mkdir(exist_ok=True)
            write_atomic(project.folder / file_path, content)
        inputs |= {file_path: sha256(content) for file_path, content in profile_files.items()}
        append(
            project.folder,
            to_plain_value(
                {
                    "operation": "report",
                    "job": retained_job,
                    "inputs": [FileEntry(*names) for names in inputs.items()],
                    "outputs": [FileEntry(f, sha256(c)) for f, c in outputs.items()],
                }
            ),
        )
    return study, project.folder / f"reports/{name}.html"


def get_result_name(job: Mapping[str, Any], result: bytes) -> str:
    """Return the name of a result: two questions may have one answer, but not one report."""
    text = json.dumps(job, indent=2, ensure_ascii=False)
    return sha256(text.encode() + result)[:NAME]


def list_contents(study: Study, page: Callable[[Study], str]) -> dict[str, bytes]:
    """Return the files that a project stores of a study, by path without the name of the result."""
    fits = {"fit": study.fit, "joint": study.joint}
    return {
        "records/.json": json.dumps(
            ResultNumbers(study).to_dict(), indent=2, ensure_ascii=False
        ).encode(),
        "reports/.html": page(study).encode(),
        **{
            f"records/.{fit_name}.json": to_json(fit).encode()
            for fit_name, fit in fits.items()
            if fit is not None
        },
    }


@dataclass(frozen=True)
class ResultNumbers(Serialisable):
    """Numbers of a study that verification recomputes and compares."""

    schema = "dashpot/result@2"
    _keys = ("study.mass", "fit", "alternatives", Key("hammer_results", flatten=True))

    study: Study

    @property
    def fit(self) -> dict[str, Any]:
        """Document of the chosen solid."""
        return select_numbers(self.study.fit.to_dict())

    @property
    def alternatives(self) -> list[dict[str, Any]]:
        """Documents of the solids with one and with two arms."""
        return [select_numbers(fit.to_dict()) for fit in self.study.alternatives]

    @property
    def hammer_results(self) -> dict[str, Any]:
        """Documents of the results with a hammer."""
        names = ("joint", "comparison", "joint_comparison")
        entries = {name: getattr(self.study, name) for name in names}
        return {
            name: None if entry is None else select_numbers(entry.to_dict())
            for name, entry in entries.items()
        }


def select_numbers(document: dict[str, Any]) -> dict[str, Any]:
    """Return a result's document without its sampled arrays and its texts."""
    dropped_keys = {
        "predicted", "measured", "profiles", "checks", "source", "steps", "verdict", "message",
    }  # fmt: skip
    return {key: value for key, value in document.items() if key not in dropped_keys}


def make_profiles(job: Job) -> dict[str, bytes]:
    """Return the reading profiles of a job with stated options, by their path."""
    profile_names = {dump_profile(options) for options in (job.reading, job.reading_impact)}
    texts = [text.encode() for text in sorted(profile_names - {dump_profile(ReadOptions())})]
    return {f"profiles/{sha256(text)[:NAME]}.toml": text for text in texts}


# -- Files of a job -------------------------------------------------------------------------------


def list_paths(job: Job) -> tuple[str, ...]:
    """Return every path that a job names, each once."""
    paths: dict[str, str] = {}
    replace_paths(job, lambda path: paths.setdefault(path, path))
    return tuple(paths)


def resolve_job_paths(project: Project, job: Job) -> Job:
    """Return the job with paths that can be opened, all of them inside the project."""
    return replace_paths(job, lambda path: str(resolve_project_path(project, path)))


def resolve_project_path(project: Project, path: str) -> Path:
    """Return a place named in the project's own files, which must be inside the project.

    Raises
    ------
    ReadError
        If it is not, by whatever link.
    """
    root = project.folder.resolve()
    resolved_path = (root / path).resolve()
    if not resolved_path.is_relative_to(root):
        raise ReadError(f"{path} leads out of the project; nothing outside it is read")
    return resolved_path


def _keep(project: Project, path: str) -> str:
    """Copy a file into ``raw/`` unless it is there; return its place inside the project."""
    source = open_raw(path)
    content = b"".join(source.blocks())
    file_name = Path(source.name)
    raw_folder = project.folder / "raw"
    raw_folder.mkdir(exist_ok=True)
    target = raw_folder / file_name
    if target.exists() and target.read_bytes() != content:
        target = raw_folder / f"{file_name.stem}-{sha256(content)[:NAME]}{file_name.suffix}"
    if not target.exists():
        write_atomic(target, content)
    elif target.read_bytes() != content:
        raise DataError(
            f"{target} is no longer the copy of {path} that it was: put it back, or remove it "
            "and run 'dashpot verify'"
        )
    return f"raw/{target.name}"


def keep_report(
    folder: str | Path, job: Job, *, page: Callable[[Study], str]
) -> tuple[Study, Path, Project]:
    """Run a job in the project of a folder; return its study, its report and the project."""
    project = create(folder)
    study, page_path = record(project, job, page=page)
    return study, page_path, project
