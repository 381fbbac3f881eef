"""What a path may be: a file, or a pipe that ends; everything else is a sentence."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import threading
from pathlib import Path

import h5py
import pytest
from kit.look_alikes import table, truth

from dashpot.base.errors import ReadError
from dashpot.reading import raw_file
from dashpot.reading.raw_file import open_raw
from dashpot.reading.read_options import load_profile
from dashpot.reading.readers.inspect import inspect_file

TEXT = "time [s],displacement [mm],force [N]\n" + table(",")
DASHPOT = [sys.executable, "-m", "dashpot", "inspect"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/null", "/dev/urandom"])
def test_devices_are_refused(path: str) -> None:
    with pytest.raises(ReadError, match=f"^{path} is a device; give the file to read$"):
        open_raw(path)
    with pytest.raises(ReadError, match="is a device"):
        load_profile(path)


def test_folders_and_sockets_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match="is a folder; give the file to read"):
        open_raw(tmp_path)
    with socket.socket(socket.AF_UNIX) as item:
        item.bind(str(tmp_path / "s"))
        with pytest.raises(ReadError, match="is a socket; give the file to read"):
            open_raw(tmp_path / "s")


def test_a_pipe_that_brings_nothing_is_not_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert raw_file.PIPE_TIMEOUT == 30
    monkeypatch.setattr(raw_file, "PIPE_TIMEOUT", 0)
    path = tmp_path / "pipe"
    os.mkfifo(path)
    with pytest.raises(ReadError, match="pipe is a pipe into which nothing was written for 0 s"):
        open_raw(path)
    writer = os.open(path, os.O_RDWR)  # one that holds its tongue
    with pytest.raises(ReadError, match="nothing was written"):
        open_raw(path)
    os.close(writer)


def test_a_pipe_is_read_to_its_end(tmp_path: Path) -> None:
    path = tmp_path / "pipe"
    os.mkfifo(path)
    writer = threading.Thread(target=path.write_text, args=(TEXT,))
    writer.start()
    for _ in range(2):  # a command may look at its file twice
        assert inspect_file(path).kind == "relaxation"
    writer.join()


def test_pipe_without_end_is_abandoned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert raw_file.MAX_PIPE_SIZE == 1 << 29
    for most in (len(TEXT), len(TEXT) - 1):
        monkeypatch.setattr(raw_file, "MAX_PIPE_SIZE", most)
        path = tmp_path / f"pipe {most}"
        os.mkfifo(path)
        writer = threading.Thread(target=path.write_text, args=(TEXT,))
        writer.start()
        if most == len(TEXT):
            assert open_raw(path).content == TEXT.encode()
        else:
            with pytest.raises(ReadError, match="brings more than 0 MiB through a pipe; save it"):
                open_raw(path)
        writer.join()


@pytest.mark.parametrize("inward", ["<", "cat {} |", "zsh"])
def test_stdin_and_process_substitution(tmp_path: Path, inward: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(TEXT)
    command = {
        "<": f"{' '.join(DASHPOT)} - < {path}",
        "cat {} |": f"cat {path} | {' '.join(DASHPOT)} -",
        "zsh": f"{' '.join(DASHPOT)} <(cat {path})",
    }[inward]
    done = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, check=False, env=ENVIRONMENT
    )
    assert done.returncode == 0, done.stderr
    assert "relaxation" in done.stdout


@pytest.mark.parametrize("name", ["a.csv", "a.h5"])
def test_no_stdin_and_no_stderr_are_needed(tmp_path: Path, name: str) -> None:
    (tmp_path / "a.csv").write_text(TEXT)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for column, values in zip(("time_s", "displacement_mm", "force_N"), truth(), strict=True):
            file[column] = values
    done = subprocess.run(
        ["bash", "-c", f"{' '.join(DASHPOT)} {tmp_path / name} 0<&- 2>&-"],
        stdout=subprocess.PIPE, text=True, check=True, env=ENVIRONMENT,
    )  # fmt: skip
    assert done.stdout.startswith(f"{name}: relaxation")


def test_stdin_without_end_is_abandoned() -> None:
    code = (
        "import resource, sys; from dashpot.reading.raw_file import open_raw\n"
        "try: open_raw('-')\n"
        "except Exception as error: print(error)\n"
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
    )
    with Path("/dev/zero").open("rb") as zeros:
        done = subprocess.run(
            [sys.executable, "-c", code], stdin=zeros, capture_output=True, text=True, check=True,
            env=ENVIRONMENT,
        )  # fmt: skip
    message, peak = done.stdout.splitlines()
    assert message.startswith("stdin brings more than 512 MiB through a pipe; save it as a file")
    assert int(peak) < 1 << 20
