"""Nothing that dashpot reads, and nothing that is not its own, is ever written over."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from kit.fits import a_fit

import dashpot as dp
from dashpot.base.errors import ExportError
from dashpot.base.file_writing import write_atomic
from dashpot.base.version import is_ours
from dashpot.export import TARGETS
from dashpot.extensions.formats.write_uff import frf_uff
from dashpot.reading.read_options import ReadOptions, dump_profile
from dashpot.reading.write import write_frf
from dashpot.workflow.json_archive import to_json
from dashpot.workflow.outputs import Outputs

MODEL = dp.GeneralizedMaxwell(196.5, (117.5,), (0.5,))


@pytest.fixture
def mine(tmp_path):
    path = tmp_path / "mine.csv"
    path.write_text("# dashpot 2: front left\ntime [s],force [N]\n0,0\n")
    return path


def an_frf():
    return dp.systems.predict_frf(MODEL, mass=0.1, frequency=[1.0, 2.0, 3.0])


WRITTEN = {
    "FRF": lambda: write_frf(an_frf()).encode(),
    "UFF": lambda: frf_uff(an_frf()),
    "fit": lambda: to_json(a_fit(MODEL)).encode(),
    "compact": lambda: to_json(MODEL, indent=None).encode(),
    "profile": lambda: dump_profile(ReadOptions(force="F")).encode(),
    **{
        suffix: lambda suffix=suffix: dp.plot.render_figure(dp.plot.stiffness(a_fit(MODEL)), suffix)
        for suffix in (".png", ".svg", ".pdf")
    },
    **{
        target: lambda target=target: TARGETS[target](
            MODEL, units="SI", **({"modulus": 1e6} if target in {"radioss", "felupe"} else {})
        ).encode()
        for target in TARGETS
    },
}


@pytest.mark.parametrize("kind", WRITTEN)
def test_what_dashpot_wrote_it_replaces(tmp_path, kind):
    path = tmp_path / "out"
    for _ in range(2):
        Outputs().write(path, WRITTEN[kind]())
    assert path.read_bytes() == WRITTEN[kind]()


def test_what_others_wrote_stays(mine):
    before = mine.read_bytes()
    with pytest.raises(ExportError, match=r"not written by dashpot; .* --overwrite"):
        Outputs().check_writable([mine])
    assert mine.read_bytes() == before
    Outputs(replace=True).write(mine, "new")
    assert mine.read_text() == "new"


@given(st.binary(max_size=60))
def test_no_chance_bytes_are_taken_for_dashpots(content):
    assume(b"dashpot" not in content)  # hypothesis tries the constants of the source, too
    assert not is_ours(content)


@pytest.mark.parametrize("name", ["mine.csv", "sub/../mine.csv", "hard", "soft", "soft again"])
@pytest.mark.parametrize("read_as", ["mine.csv", "hard", "soft"])
def test_an_input_is_never_written_over_by_whatever_name(mine, monkeypatch, name, read_as):
    monkeypatch.chdir(mine.parent)
    Path("sub").mkdir()
    Path("hard").hardlink_to(mine)
    Path("soft").symlink_to(mine)
    Path("soft again").symlink_to("soft")
    with pytest.raises(ExportError, match="is never written over"):
        Outputs((read_as,), replace=True).check_writable([name])


def test_a_link_is_followed(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "real")
    for text in ("one", "two"):
        Outputs(replace=True).write(tmp_path / "link", text)
        assert (tmp_path / "real").read_text() == text
    assert (tmp_path / "link").is_symlink()


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["."], "is a folder"),
        (["mine.csv/out.json"], "Not a directory"),
        (["a", "./a"], "two outputs"),
        (["new/../a", "a"], "two outputs"),
    ],
)
def test_what_cannot_be_written_is_refused_before_the_work(mine, monkeypatch, names, message):
    monkeypatch.chdir(mine.parent)
    with pytest.raises(ExportError, match=message):
        Outputs(replace=True).check_writable(names)
    assert list(mine.parent.iterdir()) == [mine]


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_what_may_not_be_written_is_refused_before_the_work(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(ExportError, match="nothing can be written to"):
        Outputs().check_writable([tmp_path / "out"])


def test_the_files_of_a_project_are_not_replaced(tmp_path):
    (tmp_path / "dashpot.toml").write_text("")
    place = tmp_path / "records" / "a.json"
    Outputs().write(place, to_json(MODEL))
    with pytest.raises(ExportError, match="belongs to a project"):
        Outputs(replace=True).check_writable([place])


def test_a_folder_is_made_when_it_is_needed_and_not_before(tmp_path):
    place = tmp_path / "a" / "b" / "fit.json"
    Outputs().check_writable([place])
    assert not (tmp_path / "a").exists()
    Outputs().write(place, "x")
    assert place.read_text() == "x"


@pytest.mark.parametrize("fails", ["fsync", "replace"])
def test_a_write_that_fails_leaves_what_was_there(tmp_path, monkeypatch, fails):
    def full(*_):
        raise OSError(28, "No space left on device")

    path = tmp_path / "fit.json"
    path.write_text("old")
    monkeypatch.setattr(*((os, "fsync") if fails == "fsync" else (Path, "replace")), full)
    with pytest.raises(OSError, match="No space"):
        write_atomic(path, b"new")
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("fit.json", "old")]


def test_write_atomic_preserves_permissions_and_devices(tmp_path):
    path = tmp_path / "fit.json"
    path.write_text("old")
    path.chmod(0o640)
    write_atomic(path, b"new")
    assert path.stat().st_mode & 0o777 == 0o640
    write_atomic("/dev/null", b"new")
    assert not Path("/dev/null").is_file()
