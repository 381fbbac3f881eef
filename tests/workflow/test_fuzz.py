"""Altered documents, profiles and projects: a result, a finding or a refusal."""

from __future__ import annotations

import io
import json
import zipfile
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given
from hypothesis import strategies as st
from kit import handmade
from kit.fuzzing import Fuzzer
from kit.mutants import Mutant, draw_damaged_bytes, draw_damaged_json, tries

from dashpot.extensions.projects import history, project
from dashpot.reading.read_options import ReadOptions, dump_profile
from dashpot.solids.networks import kelvin_voigt
from dashpot.workflow.job import Job
from dashpot.workflow.json_archive import to_document

pytestmark = [pytest.mark.fuzz, pytest.mark.usefixtures("mutants")]


def documents() -> list[dict[str, object]]:
    nouns = (
        handmade.two_arms(), handmade.joint(), handmade.two_arms().model, kelvin_voigt(100.0, 2.0),
        handmade.study().comparison, Job("a.csv", impact=("b.csv",), mass=0.104),
    )  # fmt: skip
    return [to_document(result) for result in nouns]


@tries(400)
@given(content=st.sampled_from(documents()).flatmap(draw_damaged_json))
def test_altered_documents(fuzzer: Fuzzer, content: bytes) -> None:
    fuzzer.survives("unpack", content)


@tries(100)
@given(
    content=st.sampled_from(documents()).flatmap(
        lambda item: draw_damaged_bytes(json.dumps(item).encode())
    )
)
def test_wounded_documents(fuzzer: Fuzzer, content: bytes) -> None:
    fuzzer.survives("unpack", content)


PROFILE = dump_profile(
    ReadOptions(
        time="Zeit", acceleration=("a", "b"), units={"force": "N"}, rate=1000.0, segment=2,
        decimal=",", skip_rows=3,
    )
)  # fmt: skip


@tries(200)
@given(content=draw_damaged_bytes(PROFILE.encode()))
def test_wounded_profiles(fuzzer: Fuzzer, content: bytes) -> None:
    fuzzer.survives("profile", content)


@cache
def project_files() -> dict[str, bytes]:
    """The files of a project, by name."""
    with TemporaryDirectory() as place, pytest.MonkeyPatch.context() as patch:
        folder = Path(place) / "seal"
        (Path(place) / "a.csv").write_text("time [s],displacement [mm],force [N]\n0,0,0\n")
        patch.setattr(project, "run", lambda _job: handmade.bench_only())
        job = Job(str(Path(place) / "a.csv"), reading=ReadOptions(units={"force": "N"}))
        for seals in (1.0, 2.0):
            made, many = project.create(folder), replace(job, seals=seals)
            project.record(made, many, page=lambda study: study.fit._identity)
        files = (path for path in folder.rglob("*") if path.is_file())
        return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


@st.composite
def projects(draw: st.DrawFn) -> bytes:
    """A project of which one file was altered, with the hashes of its history put right or not."""
    files = dict(project_files())
    name = draw(st.sampled_from(["history.jsonl", *files]))
    if name != "history.jsonl" or draw(st.booleans()):
        files[name] = draw(draw_damaged_bytes(files[name]))
    else:
        lines = [json.loads(line) for line in files[name].splitlines()]
        at = draw(st.integers(0, len(lines) - 1))
        lines[at] = json.loads(draw(draw_damaged_json(lines[at])))
        before, sealed = history.GENESIS, draw(st.booleans())
        texts = []
        for line in lines:
            text = json.dumps(line).encode()
            if sealed and isinstance(line, dict):
                line["previous"] = before
                text, before = history.format_hashed_line(line)
            texts.append(text + b"\n")
        files[name] = b"".join(texts)
        files["history.head"] = f"{len(lines)} {before}\n".encode()
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as packed:
        for path, content in files.items():
            packed.writestr(path, content)
    return Mutant(out.getvalue())


@tries(250)
@given(content=projects())
def test_altered_projects(fuzzer: Fuzzer, content: bytes) -> None:
    fuzzer.survives("hold", content)
