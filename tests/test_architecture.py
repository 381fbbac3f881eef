"""Structure of the package: layers, light imports, one module for each public name."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import dashpot as dp
from dashpot.reading.write import write_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import PAPER

ROOT = Path(__file__).resolve().parents[1]
HEAVY = {
    "matplotlib", "jinja2", "pandas", "polars", "distributed", "pyarrow", "starlette", "uvicorn",
    "pint", "scipy.optimize", "scipy.signal", "scipy.stats", "msgspec", "nptdms", "pyuff", "h5py",
}  # fmt: skip


def modules_after(code: str) -> set[str]:
    """Return the names of all modules loaded by a fresh interpreter that runs `code`."""
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\nimport sys; print('\\n'.join(sys.modules))"],
        capture_output=True,
        text=True,
        check=True,
    )
    return set(done.stdout.split())


def test_layers():
    done = subprocess.run(
        [Path(sys.executable).with_name("lint-imports"), "--no-cache"],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_import_loads_nothing_heavy():
    assert not modules_after("import dashpot; dashpot.GeneralizedMaxwell") & HEAVY


def test_a_report_of_a_seal_loads_no_other_kind_and_no_door(tmp_path: Path) -> None:
    code = (
        "import dashpot as dp; study = dp.report(dp.simulate('relaxation', hold='20s'));"
        f"study.save({str(tmp_path / 'report.html')!r})"
    )
    loaded = modules_after(code)
    assert "dashpot.report.first_screen" in loaded
    others = ("cld", "csr", "drop", "indentation", "rod")
    rooms = tuple(f"dashpot.extensions.materials.{name}." for name in others)
    rooms += ("dashpot.extensions.systems.door.",)
    assert not [name for name in loaded if name.startswith(rooms) and not name.endswith(".rows")]
    assert "importlib.metadata" not in loaded


def test_a_fit_looks_for_no_mask() -> None:
    """NumPy's median and unique would, and load a package for it."""
    code = "import dashpot as dp; dp.fit(dp.simulate('relaxation', hold='20s'))"
    assert "numpy.ma" not in modules_after(code)


def test_no_lazy_name_is_that_of_its_module():
    """Where it is, whoever imports the module first puts it in the name's place."""
    for stub in (ROOT / "src").rglob("__init__.pyi"):
        matches = re.findall(r"^from \.(\S*) import (\w+)", stub.read_text("utf-8"), re.MULTILINE)
        rooms = {path.stem for path in stub.parent.iterdir()} - {"__init__"}
        hidden = {name for module, name in matches if module and name in rooms}
        assert hidden == (set(dp.VERBS) if stub.parent.name == "dashpot" else set()), stub


def test_api_function_survives_the_import_of_its_package():
    """`dp.report` is the verb, before and after `dashpot.report` has been imported."""
    for verb in dp.VERBS:
        folder = import_module(f"dashpot.{verb}")
        assert callable(getattr(dp, verb))
        assert getattr(dp, verb) is not folder


def test_names_passed_to_load_function_resolve():
    """A package that names one above it does so by `load_function`; such names are no imports."""
    choices = {}
    for file in (ROOT / "src").rglob("*.py"):
        for module, name in re.findall(
            r'load_function\("([\w.]+)", "(\w+)"\)', file.read_text("utf-8")
        ):
            choices[module, name] = file.relative_to(ROOT / "src" / "dashpot").as_posix()
            assert callable(getattr(import_module(f"dashpot.{module}"), name))
    records = {f"datamodel/{name}.py" for name in ("frf", "relaxation", "vibration_tests")}
    rooms = {"base/result_mixins.py", "plot/picture.py", "extensions/materials/csr/datamodel.py"}
    assert set(choices.values()) == rooms | records
    by_word = {
        file.relative_to(ROOT / "src" / "dashpot").as_posix()
        for file in (ROOT / "src").rglob("*.py")
        if 'import_module(f"dashpot.' in file.read_text("utf-8")
    }
    assert by_word == {"base/result_mixins.py"}


def test_help_loads_click_and_no_numbers():
    loaded = modules_after(
        "from click.testing import CliRunner; from dashpot.cli import main;"
        "result = CliRunner().invoke(main, ['--help']); assert result.exit_code == 0, result"
    )
    assert "click" in loaded
    assert not loaded & (HEAVY | {"numpy"})


@pytest.mark.parametrize(("message", "heard"), [(None, "1"), ("3", "3")])
def test_command_line_uses_one_blas_thread_by_default(message, heard):
    """More wait at full load for the one that works: named before NumPy is there."""
    names = [f"{library}_NUM_THREADS" for library in ("OMP", "OPENBLAS", "MKL")]
    values = {name: message for name in names if message}
    bare = {name: value for name, value in os.environ.items() if name not in names} | values
    code = (
        "import os, sys, dashpot.cli; assert 'numpy' not in sys.modules;"
        f"print([os.environ[name] for name in {names}])"
    )
    process = subprocess.run(
        [sys.executable, "-c", code], env=bare, check=True, capture_output=True, text=True
    )
    assert process.stdout.strip() == str([heard] * 3)


def test_fitting_a_text_file_loads_numpy_only(tmp_path):
    code = (
        "import dashpot as dp\n"
        f"p = {str(tmp_path / 'seal.csv')!r}\n"
        "from dashpot.simulation.relaxation import simulate_relaxation\n"
        "from dashpot.solids.demo_seals import PAPER\n"
        "from dashpot.reading.write import write_relaxation\n"
        "made = simulate_relaxation(PAPER, hold_time=5.0)\n"
        "open(p, 'w').write(write_relaxation(made.test))\n"
        "dp.fit(dp.read(p), arms=1).intervals()\n"
    )
    assert not modules_after(code) & (HEAVY - {"msgspec"})


def test_fitting_from_the_shell_loads_what_it_needs(tmp_path):
    file = tmp_path / "seal.csv"
    file.write_text(write_relaxation(simulate_relaxation(PAPER, hold_time=5.0).test))
    loaded = modules_after(
        "from click.testing import CliRunner; from dashpot.cli import main;"
        f"result = CliRunner().invoke(main, ['fit', {str(file)!r}]); assert not result.exit_code"
    )
    others = {
        "tomllib", "xml.etree.ElementTree", "numpy.ma", "numpy.polynomial", "numpy.random", "scipy",
        "dashpot.workflow.json_archive", "dashpot.reading.readers.inspect", "dashpot.extensions.formats.ati",
        "dashpot.vibration",
    }  # fmt: skip
    assert not loaded & (HEAVY | others)
