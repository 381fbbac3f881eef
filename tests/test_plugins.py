"""Packages of others by rows of theirs: listed as text, loaded when named, held to the contract."""

from __future__ import annotations

import json
import struct
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from kit.shell import ran, run_json

import dashpot as dp
from dashpot.reading import raw_file
from dashpot.registry import plugins
from dashpot.testing import check_format

EXAMPLE = Path(__file__).parents[1] / "examples" / "labkit"
GOOD = """
API = 1
def read(raw, *, name):
    return {"columns": [
        {"name": "time", "unit": "s", "values": [i / 10 for i in range(100)]},
        {"name": "force", "unit": "N", "values": [1.0 + i for i in range(100)]},
    ]}
"""
MISBEHAVING = {
    "raises": ('raise ZeroDivisionError("three blind mice")', "three blind mice"),
    "leaves": ("raise SystemExit(3)", "SystemExit"),
    "loops": ("while True: pass", "took more than 1 s"),
    "no dictionary": ("return [1, 2]", "returned a list; expected"),
    "a class": ("return type('Own', (), {})()", "returned a Own; expected"),
    "nothing": ("return {}", "returned no columns; expected"),
    "one value": ('return {"columns": [{"name": "t", "values": [1]}]}', "columns of 1 values"),
    "lengths": (
        'return {"columns": [{"name": "t", "values": [1, 2]}, {"name": "f", "values": [1]}]}',
        "columns of 1, 2 values",
    ),
    "words": ('return {"columns": [{"name": "t", "values": ["a", "b"]}]}', "are not numbers"),
    "two ways": ('return {"columns": [{"name": "t", "values": [[1, 2]]}]}', "of 2 dimensions"),
    "no name": ('return {"columns": [{"values": [1, 2]}]}', "'name' of type NoneType"),
    "memory": ('return {"columns": [{"name": "t", "values": [0.5] * 10**9}]}', "memory"),
    "a note": (
        'return {"columns": [{"name": "t", "values": [1, 2]}], "notes": 3}', "'notes' of type int"
    ),
}  # fmt: skip


_ONE = '{"numbers": [{"name": "a", "value": 3.0}], '


@pytest.fixture
def install_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[[str, dict[str, str], dict[str, str]], None]:
    """Install a package with a row and modules, here and in the children of this process."""
    path = tmp_path / "site"
    path.mkdir()
    monkeypatch.syspath_prepend(str(path))
    monkeypatch.setenv("PYTHONPATH", f"{path}:{Path(dp.__file__).parents[1]}")

    def install(name: str, modules: dict[str, str], words: dict[str, str] | str) -> None:
        for module, text in modules.items():
            (path / f"{module}.py").write_text(text)
        write_row(path / name, words)
        expected = path / f"{name}-0.1.0.dist-info"
        expected.mkdir()
        (expected / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 0.1.0\n")
        (expected / "entry_points.txt").write_text(f"[dashpot.extensions]\n{name} = {name}\n")
        plugins.read_plugins.cache_clear()

    plugins.read_plugins.cache_clear()
    yield install
    plugins.read_plugins.cache_clear()


def write_row(folder: Path, words: dict[str, str] | str) -> None:
    """Write a package that cannot be imported, with the row of "name = word" of each group."""
    folder.mkdir()
    (folder / "__init__.py").write_text("raise SystemExit('imported')\n")
    if not isinstance(words, str):
        rows = [(group, *line.split(" = ")) for group, line in words.items()]
        words = "\n".join(
            f'[[{group}]]\nname = "{name}"\n{"fits" if group == "kinds" else "module"} = "{word}"'
            for group, name, word in rows
        )
    (folder / plugins.ROW).write_text(words)


@pytest.fixture
def labkit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The example package, as pip would install it."""
    project = tomllib.loads((EXAMPLE / "pyproject.toml").read_text())["project"]
    expected = tmp_path / "site" / "labkit-0.1.0.dist-info"
    expected.mkdir(parents=True)
    (expected / "METADATA").write_text("Metadata-Version: 2.1\nName: labkit\nVersion: 0.1.0\n")
    (expected / "entry_points.txt").write_text(
        "".join(
            f"[{group}]\n" + "".join(f"{name} = {value}\n" for name, value in points.items())
            for group, points in project["entry-points"].items()
        )
    )
    for path in (EXAMPLE, expected.parent):
        monkeypatch.syspath_prepend(str(path))
    monkeypatch.setenv("PYTHONPATH", f"{expected.parent}:{EXAMPLE}:{Path(dp.__file__).parents[1]}")
    plugins.read_plugins.cache_clear()
    yield
    plugins.read_plugins.cache_clear()


def sample(path: Path) -> Path:
    """A file of the example's format: 8 mm in 1 s, held for 9 s."""
    head = {"operator": "K", "channels": [["time", "s"], ["displacement", "mm"], ["force", "N"]]}
    rows = b"".join(
        struct.pack("<3f", i / 100, 8 * min(i / 100, 1), 1.6 * min(i / 100, 1) + 0.002 * (i % 3))
        for i in range(1001)
    )
    path.write_bytes(b"LABKIT1\n" + json.dumps(head).encode() + b"\n" + rows)
    return path


@pytest.mark.usefixtures("labkit")
def test_unknown_binary_file_names_the_formats_of_plugins(tmp_path: Path) -> None:
    """The advice was to export it as text, beside the plug-in that reads it."""
    path = sample(tmp_path / "seal.lab")
    with path.open("ab") as stream:
        stream.write(b"\0" * 12)
    with pytest.raises(dp.ReadError, match=r"plug-in: --file-part format=labkit .Python: .*part="):
        dp.read(path)


@pytest.mark.usefixtures("labkit")
def test_a_list_imports_nothing() -> None:
    for name in [name for name in sys.modules if name.startswith("labkit")]:
        del sys.modules[name]  # another test may have loaded it
    document = run_json("inspect", "--plugins")
    assert [(plugin["group"], plugin["name"]) for plugin in document["plugins"]] == [
        ("formats", "labkit"), ("kinds", "peel"), ("solver_inputs", "labsolver"),
    ]  # fmt: skip
    assert not [name for name in sys.modules if name.startswith("labkit")]
    assert "--file-part format=labkit" in ran("inspect", "--plugins").stdout


@pytest.mark.usefixtures("labkit")
def test_a_format_goes_through_every_command(tmp_path: Path) -> None:
    file, retained = sample(tmp_path / "seal.lab"), tmp_path / "fit.json"
    message = ("--file-part", "format=labkit")
    assert "labkit (labkit 0.1.0)" in ran("inspect", file, *message).stdout
    document = run_json("fit", file, *message, "--arms", 1, "-o", retained)
    (source,) = document["provenance"]["source"] if "provenance" in document else document["source"]
    assert source["reader"] == "labkit (labkit 0.1.0)"
    assert source["notes"][0] == "read by the plug-in 'labkit' of labkit 0.1.0"
    assert len(source["sha256"]) == 64
    page = tmp_path / "page.html"
    assert ran("report", file, *message, "-o", page).exit_code == 0
    assert "labkit 0.1.0" in page.read_text()
    profile = tmp_path / "lab.toml"
    assert ran("inspect", file, *message, "--save", profile).exit_code == 0
    assert run_json("fit", file, "--profile", profile, "--arms", 1)["model"] == document["model"]
    # without the name nobody asks the plug-in
    unnamed = ran("fit", file)
    assert unnamed.exit_code == 2
    assert "no format that dashpot knows by its content" in unnamed.stderr


@pytest.mark.usefixtures("labkit")
def test_plugin_kind_reports_numbers_under_its_name(tmp_path: Path) -> None:
    file = sample(tmp_path / "seal.lab")
    path = tmp_path / "peel.json"
    words = ("fit", file, "--file-part", "format=labkit", "--kind", "peel")
    document = run_json(*words, "-o", path)
    (force,) = document["values"]
    assert (force["name"], force["unit"]) == ("peel_force", "N")
    assert force["value"] == pytest.approx(1.602, abs=1e-3)
    assert "by 'peel' of labkit 0.1.0, not verified by dashpot" in document["verdict"]["message"]
    again = dp.read(path)
    assert (again.package, again.reported_values[0].value) == ("labkit 0.1.0", force["value"])
    test = dp.read(file, part={"format": "labkit"}, kind="peel")
    assert dp.fit(test)["peel_force"].value == force["value"]
    assert "fitted one by one" not in ran(*words).stderr
    assert "one file at a time" in ran(*words, file).stderr


@pytest.mark.usefixtures("labkit")
def test_a_deck_says_whose_it_is() -> None:
    fitted = dp.fit(dp.simulate("relaxation", hold="20s", noise_free=True), arms=1)
    how = {"to": "labsolver", "temperature": "23degC", "length": "100mm"}
    deck = dp.export(fitted, unit_system="SI", **how)
    assert deck.splitlines()[0].endswith("deck by the plug-in 'labsolver' of labkit 0.1.0")
    assert "not verified by dashpot" in deck
    cards = [line for line in deck.splitlines() if not line.startswith("#")]
    assert cards[0] == f"SPRING {float(fitted.model.k_inf)!r}"
    with pytest.raises(dp.DashpotError, match="reads SI alone"):
        dp.export(fitted, unit_system="mm-t-s", **how)
    with pytest.raises(dp.DashpotError, match="By plug-ins: labsolver"):
        dp.export(fitted, unit_system="SI", **{**how, "to": "labsolve"})


@pytest.mark.parametrize("body", MISBEHAVING)
def test_plugin_format_fault_is_reported_in_a_sentence(
    body: str,
    install_package: Callable[..., None],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    code, message = MISBEHAVING[body]
    monkeypatch.setattr(
        raw_file, "compute_time_allowed", lambda _: 1.0 if body == "loops" else 30.0
    )
    module = f"API = 1\nprint('read me')\ndef read(raw, *, name):\n    {code}\n"
    install_package("bad", {"badly": module}, {"formats": "odd = badly"})
    file = tmp_path / "seal.odd"
    file.write_bytes(b"anything")
    done = ran("inspect", file, "--file-part", "format=odd")
    assert done.exit_code == 2, done.output
    (line,) = done.stderr.strip().splitlines()
    assert message in line
    assert "bad 0.1.0" in line
    assert "Traceback" not in done.output


def test_plugin_format_units_and_blanks_are_checked(
    install_package: Callable[..., None], tmp_path: Path
) -> None:
    install_package(
        "odd",
        {"oddly": GOOD.replace('"unit": "N"', '"unit": "furlong"')},
        {"formats": "odd = oddly"},
    )
    file = tmp_path / "seal.odd"
    file.write_bytes(b"anything")
    done = ran("fit", file, "--file-part", "format=odd", "--kind", "relaxation")
    assert done.exit_code == 2
    assert "Traceback" not in done.output


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("3", "returned a int; expected"),
        ("{}", "returned no numbers; expected"),
        ('{"numbers": [{"name": "a b", "value": 1.0}]}', "an identifier"),
        ('{"numbers": [{"name": "a", "value": float("nan")}]}', "whose value is nan"),
        ('{"numbers": [{"name": "a", "value": True}]}', "whose value is True"),
        ('{"numbers": [{"name": "a", "value": 1.0, "unit": "mm"}]}', "in 'mm'"),
        ('{"numbers": [{"name": "a", "value": 1.0, "error": -1.0}]}', "the standard error -1"),
        ('{"numbers": [{"name": "a", "value": 3.0, "low": 1.0, "high": 2.0}]}', "outside 1 to 2"),
        ('{"numbers": [{"name": "a", "value": 3.0}], "best": 1}', "the key 'best'"),
        (
            '{"numbers": [{"name": "a", "value": 3.0, "err": 1.0}]}',
            "the key 'err' of the number 'a'; expected among name, value",
        ),
        (
            _ONE + '"checks": [{"name": "c", "message": "s", "passed": False, "garde": "stop"}]}',
            "the key 'garde' of the check 'c'; expected among name, message",
        ),
        (
            '{"numbers": [{"name": "a", "value": 3.0}], "checks": [{"name": "c"}]}',
            "'message' of type NoneType",
        ),
        (
            _ONE + '"checks": [{"name": "c", "message": "s", "passed": 1}]}',
            "'passed' is 1",
        ),
        (
            _ONE + '"checks": [{"name": "c", "message": "s", "passed": True, "grade": "x"}]}',
            "of grade 'x'",
        ),
    ],
)
def test_plugin_kind_fault_is_reported_in_a_sentence(
    text: str, message: str, install_package: Callable[..., None], tmp_path: Path
) -> None:
    module = f"def fit(columns, options):\n    return {text}\n"
    install_package("odd", {f"oddly_{abs(hash(text))}": module}, {
        "kinds": f"odd = oddly_{abs(hash(text))}:fit"
    })  # fmt: skip
    file = tmp_path / "seal.csv"
    file.write_text("time [s],force [N]\n" + "\n".join(f"{i},{i + 1}" for i in range(20)))
    done = ran("fit", file, "--kind", "odd")
    assert done.exit_code == 2, done.output
    assert message in done.stderr
    assert "odd 0.1.0" in done.stderr


def test_plugin_cannot_take_built_in_names(
    install_package: Callable[..., None], tmp_path: Path
) -> None:
    stolen = "def nastran(solid, *, units, name):\n    raise SystemExit('stolen')\n"
    kind = "def fit(columns, options):\n    raise SystemExit('stolen')\n"
    install_package(
        "thief",
        {"thief_deck": stolen, "thief_kind": kind},
        {"solver_inputs": "nastran = thief_deck", "kinds": "relaxation = thief_kind:fit"},
    )
    test = dp.simulate("relaxation", hold="20s", noise_free=True)
    deck = dp.export(
        dp.fit(test, arms=1), to="nastran", unit_system="SI", temperature="23degC", length="1m"
    )
    assert "PBUSHT" in deck
    path = tmp_path / "seal.csv"
    dp.save(test, path)
    assert ran("fit", path, "--kind", "relaxation", "--arms", 1).exit_code == 0


def test_plugin_name_of_two_packages_is_refused(
    install_package: Callable[..., None], tmp_path: Path
) -> None:
    for name in ("one", "two"):
        install_package(name, {f"of_{name}": GOOD}, {"formats": f"odd = of_{name}"})
    file = tmp_path / "seal.odd"
    file.write_bytes(b"anything")
    done = ran("inspect", file, "--file-part", "format=odd")
    assert done.exit_code == 2
    assert "by one 0.1.0 and by two 0.1.0" in done.stderr


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("[[formats]", "Expected ']]'"),
        ('[[commands]]\nname = "a"', "found 'commands'; expected formats, kinds, solver_inputs"),
        ('[formats]\nname = "a"', "expected [[formats]] before each"),
        ('[[formats]]\nname = "a"', "expected name"),
        ('[[formats]]\nname = "a"\nmodule = "b"\nmarks = "PK"', "'marks': 'PK'"),
        ('[[formats]]\nname = 3\nmodule = "b"', "'name': 3"),
        ('[[formats]]\nname = "a"\nmodule = "b:c"', 'module = "package.module" alone'),
        ('[[kinds]]\nname = "a"\nfits = "b"', 'fits = "package.module:function" alone'),
        ('[[kinds]]\nname = "a\\u001b"\nfits = "b:c"', "in 'kinds'"),
        (2 * '[[kinds]]\nname = "a"\nfits = "b:c"\n', "a name of 'kinds' twice"),
    ],
)
def test_invalid_plugin_row_is_reported_in_a_sentence(
    row: str, message: str, install_package: Callable[..., None], tmp_path: Path
) -> None:
    install_package("good", {"goodly": GOOD}, {"formats": "good = goodly"})
    install_package("bad", {}, row)
    document = run_json("inspect", "--plugins")
    assert [plugin["name"] for plugin in document["plugins"]] == ["good"]
    (sentence,) = document["refused"]
    assert sentence.startswith("bad 0.1.0 is not used: bad/dashpot_extension.toml: ")
    assert message in sentence
    assert "Ask who maintains bad." in ran("inspect", "--plugins").stdout
    # what stands in another package is used all the same
    file = tmp_path / "seal.good"
    file.write_bytes(b"anything")
    assert ran("inspect", file, "--file-part", "format=good").exit_code == 0
    done = ran("inspect", file, "--file-part", "format=a")
    assert done.exit_code == 2
    assert "By plug-ins: good. bad 0.1.0 is not used" in done.stderr


def test_missing_plugin_row_is_reported_in_a_sentence(
    install_package: Callable[..., None], tmp_path: Path
) -> None:
    install_package("bad", {}, "")
    (tmp_path / "site" / "bad" / plugins.ROW).unlink()
    (sentence,) = run_json("inspect", "--plugins")["refused"]
    assert "its entry point says 'bad', where no dashpot_extension.toml is" in sentence


def test_none_is_used_where_they_are_off(
    install_package: Callable[..., None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_package("good", {"goodly": GOOD}, {"formats": "good = goodly"})
    file = tmp_path / "seal.good"
    file.write_bytes(b"anything")
    assert ran("inspect", file, "--file-part", "format=good").exit_code == 0
    monkeypatch.setenv(plugins.SWITCH, plugins.NO_PLUGINS)
    plugins.read_plugins.cache_clear()
    done = ran("inspect", file, "--file-part", "format=good")
    assert (done.exit_code, "Plug-ins are off" in done.stderr) == (2, True)
    assert run_json("inspect", "--plugins")["plugins"] == []


def test_a_plug_in_that_is_gone_is_named(tmp_path: Path) -> None:
    file = tmp_path / "seal.odd"
    file.write_bytes(b"anything")
    done = ran("inspect", file, "--file-part", "format=gone")
    assert done.exit_code == 2
    assert "no plug-in brings the format 'gone'" in done.stderr


def test_no_command_pays_for_what_it_does_not_name() -> None:
    code = (
        "import sys; sys.argv = ['dashpot', '--help']\n"
        "import dashpot.cli\n"
        "try: dashpot.cli.main()\n"
        "except SystemExit: pass\n"
        "print(sorted({'importlib.metadata', 'dashpot.registry.plugins'} & set(sys.modules)))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize(
    ("code", "message"),
    [
        (GOOD + "\n_read = read\ndef read(raw, *, name):\n    if not raw.startswith(b'G'):\n"
         "        raise ValueError\n    return _read(raw, name=name)\n", ""),
        (GOOD, "an empty file is read as if"),
        (GOOD.replace("API = 1", "API = 2"), "states API = 2"),
        (GOOD.replace("1.0 + i", "__import__('random').random()"), "read differently"),
        (GOOD.replace('"N"', '"furlong"').replace("    return", "    assert raw[:1] == b'G'\n"
         "    return"), "which dashpot does not know"),
    ],
)  # fmt: skip
def test_check_format_reports_a_fault_to_authors(code: str, message: str, tmp_path: Path) -> None:
    from types import ModuleType

    module = ModuleType("theirs")
    exec(code, module.__dict__)  # noqa: S102  an author's module
    file = tmp_path / "sample.g"
    file.write_bytes(b"G" + bytes(20))
    if not message:
        assert check_format(module, file) == ["time [s]", "force [N]"]
        return
    with pytest.raises(AssertionError, match=message):
        check_format(module, file)


def test_first_plugin_on_the_path_is_used(
    install_package: Callable[..., None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_package("twice", {}, {"formats": "rig = later_on_the_path"})
    first = tmp_path / "first" / "twice-0.1.0.dist-info"
    first.mkdir(parents=True)
    (first / "METADATA").write_text("Metadata-Version: 2.1\nName: twice\nVersion: 0.2.0\n")
    (first / "entry_points.txt").write_text("[dashpot.extensions]\ntwice = twice\n")
    write_row(first.parent / "twice", {"formats": "rig = first"})
    monkeypatch.syspath_prepend(str(first.parent))
    plugins.read_plugins.cache_clear()
    plugin = plugins.find_plugin("formats", "rig")
    assert plugin is not None
    assert (plugin.value, plugin.version) == ("first", "0.2.0")
