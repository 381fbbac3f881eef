"""Contract test of a plug-in's file format, for its authors.

::

    import labkit.format
    from dashpot.testing import check_format

    def test_our_file():
        names = check_format(labkit.format, "tests/seal.lab")
        assert names == ["time [s]", "displacement [mm]", "force [N]"]
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from types import ModuleType

from dashpot.base.units import find_unit
from dashpot.registry import FORMATS
from dashpot.registry.plugins import Plugin


def check_format(module: ModuleType, sample: str | Path) -> list[str]:
    """Read a sample by a plug-in's module as dashpot would, and return its columns.

    Parameters
    ----------
    module : module
        With ``API = 1`` and ``read(raw: bytes, *, name: str) -> dict``.
    sample : path

    Returns
    -------
    list of str
        Name and unit of each column, ``"force [N]"``.

    Raises
    ------
    AssertionError
        If it fails on the sample, violates the contract, reads the same bytes differently a second
        time, accepts a file of another kind, or names a unit that dashpot does not know.
    """
    path = Path(sample)
    content = path.read_bytes()
    plugin = Plugin("formats", module.__name__, module.__name__, module.__name__, "(under test)")
    first, second = (_read(plugin, module, content, path.name) for _ in range(2))
    assert first == second, "the same bytes are read differently a second time"
    for kind, other in (("an empty file", b""), ("a file of another kind", b"\x00\xff" * 64)):
        try:
            module.read(other, name=path.name)
        except Exception:  # noqa: BLE001, S112  to refuse is what is wanted, by whatever error
            continue
        raise AssertionError(f"{kind} is read as if it were one of yours: raise a ValueError")
    names = []
    for name, unit, _ in first:
        assert unit is None or find_unit(unit), (
            f"'{name}' is in '{unit}', which dashpot does not know"
        )
        names.append(f"{name} [{unit or '?'}]")
    return names


def _read(
    plugin: Plugin, module: ModuleType, content: bytes, name: str
) -> list[tuple[str, str | None, bytes]]:
    from dashpot.base.errors import DashpotError

    try:
        table = import_module(FORMATS["plugin_format"].module).make_table(
            plugin, module, content, name
        )
    except DashpotError as error:
        raise AssertionError(str(error)) from error
    values = table.load(range(len(table.columns))).values
    return [
        (column.name, column.unit, values[:, i].tobytes()) for i, column in enumerate(table.columns)
    ]
