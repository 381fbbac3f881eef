"""Every reader on bytes that lead a fuzzer to code it had not seen: an hour, its corpus kept small.

``python -m kit.guided MINUTES FOLDER`` begins with the corpus that is kept beside this file and the
good files of the tests, and ends with a corpus that reaches as much with the fewest files. What
broke a reader lies in FOLDER/found, and is tried again by itself: only what breaks twice counts.
"""

from __future__ import annotations

import contextlib
import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path

from kit.fuzzing import TASKS, Fuzzer, _Parsers

CORPUS = Path(__file__).with_name("corpus.zip")
"""What earlier hours found, as few files as reach all of it."""
TRIED = ("read_all", "calibrate", "profile", "unpack")
"""What a file is given to, by its first byte."""
ITSELF = "DASHPOT_FUZZER"
"""Variable that names the program that the fuzzer is to the shell."""
LONGEST, SLOWEST, MEMORY = 20_000, 200, 2048
"""Bytes of a file, seconds and MB that it may cost; on a busy machine a second takes ten."""


def main() -> None:
    """Fuzz for so many minutes, keep the corpus small, and leave with 1 if a reader broke."""
    if find_spec("atheris") is None:
        sys.exit("the fuzzer is missing: pip install atheris (Linux, and no newer Python than it)")
    minutes, folder = float(sys.argv[1]), Path(sys.argv[2])
    corpus, result = folder / "corpus", folder / "found"
    for item in (corpus, result):
        item.mkdir(parents=True, exist_ok=True)
    seeds = plant_corpus(corpus)
    until = time.monotonic() + 60 * minutes
    while (residual := until - time.monotonic()) > 1:
        # a reader that breaks ends the fuzzer, which begins again from what it has found
        run_fuzzer(corpus, f"-max_total_time={residual:.0f}", f"-artifact_prefix={result}/")
    small = folder / "small"
    shutil.rmtree(small, ignore_errors=True)
    small.mkdir()
    for name in seeds:  # they are made anew each time: what reaches no more than they is let go
        shutil.copy(corpus / name, small)
    run_fuzzer(small, str(corpus), "-merge=1")
    shutil.rmtree(corpus)
    small.rename(corpus)
    save_corpus(corpus, seeds)
    sys.exit(broken(result))


def run_fuzzer(*words: str | Path) -> None:
    """One run of the fuzzer."""
    how = (f"-max_len={LONGEST}", f"-timeout={SLOWEST}", f"-rss_limit_mb={MEMORY}", "-verbosity=1")
    with tempfile.TemporaryDirectory() as place:
        # it starts itself again to merge, by its first word
        itself = Path(place) / "fuzzer"
        itself.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m kit.guided "$@"\n')
        itself.chmod(0o755)
        named = {**os.environ, ITSELF: str(itself)}
        subprocess.run([itself, *map(str, words), *how], check=False, env=named)


def plant_corpus(corpus: Path) -> set[str]:
    """Put what is kept and the good files of the tests into a corpus; return the names of those."""
    from dashpot.reading.read_options import ReadOptions, dump_profile
    from dashpot.workflow.json_archive import to_document
    from kit.crafted import TABLE
    from kit.handmade import two_arms
    from kit.instruments import write_format_examples

    with tempfile.TemporaryDirectory() as place:
        good = [*write_format_examples(Path(place)).values()]
    seeds = [(0, item) for item in (*good, *(item.content for item in TABLE))]
    seeds.append((1, b"<FTSensor><Calibration></Calibration></FTSensor>"))
    seeds.append((2, dump_profile(ReadOptions(time="t", units={"force": "N"}, rate=1e3)).encode()))
    seeds.append((3, json.dumps(to_document(two_arms())).encode()))
    inputs = {
        name_content(item): item for item in (bytes([which]) + value for which, value in seeds)
    }
    for name, element in {**inputs, **{name_content(item): item for item in read(CORPUS)}}.items():
        (corpus / name).write_bytes(element)
    return set(inputs)


def name_content(content: bytes) -> str:
    """What a file of a corpus is called."""
    return sha256(content).hexdigest()[:16]


def read(packed: Path) -> list[bytes]:
    """The files of a corpus that is kept; none where there is none."""
    if not packed.exists():
        return []
    with zipfile.ZipFile(packed) as file:
        return [file.read(name) for name in sorted(file.namelist())]


def save_corpus(corpus: Path, seeds: set[str]) -> None:
    """Keep a corpus but its seeds beside this file, without a date: the same files, same bytes."""
    with zipfile.ZipFile(CORPUS, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as file:
        for path in sorted(item for item in corpus.iterdir() if item.name not in seeds):
            file.writestr(zipfile.ZipInfo(path.name), path.read_bytes())


def broken(path: Path) -> int:
    """Try what broke a reader by itself; 1 if anything breaks again."""
    worst = 0
    for item in sorted(path.iterdir()):
        content = item.read_bytes()
        with contextlib.closing(Fuzzer()) as fuzzer:
            try:
                fuzzer.survives(task_of(content), content[1:])
                item.unlink()
            except AssertionError as error:
                print(f"{item}: {error}")
                worst = 1
    return worst


def task_of(content: bytes) -> str:
    """What a file is given to."""
    return TRIED[content[0] % len(TRIED)] if content else TRIED[0]


def fuzz() -> None:
    """Be the fuzzer: the words are libFuzzer's own."""
    import atheris

    with (
        Path(os.devnull).open("w") as quiet,
        contextlib.redirect_stderr(quiet),
        atheris.instrument_imports(include=["dashpot"]),
    ):
        from dashpot.extensions.formats import workbook
        from dashpot.reading.sandbox import parent_process
    parsers = parent_process.run_in_child = workbook.run_in_child = _Parsers(
        parent_process.run_in_child
    )
    path = Path(tempfile.mkdtemp()) / "fuzz"

    def fuzz_content(content: bytes) -> None:
        if not content:
            return
        path.write_bytes(content[1:])
        parsers.kept.clear()
        TASKS[task_of(content)](path)

    atheris.Setup([os.environ[ITSELF], *sys.argv[1:]], fuzz_content)
    atheris.Fuzz()


if __name__ == "__main__":
    if sys.argv[1:2] and not sys.argv[1].replace(".", "").isdigit():
        fuzz()
    main()
