"""Public Python functions for many tests: files to a lot, arrays to their solids."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from inspect import signature
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, get_overloads, overload

from dashpot.api import F, call_with_options, merge_signatures
from dashpot.api.fit import Arms
from dashpot.api.read_save import Place
from dashpot.base.errors import DataError
from dashpot.base.option_fields import Method
from dashpot.base.units import Dimension, Quantity
from dashpot.registry import call_handler

if TYPE_CHECKING:
    import numpy.typing as npt

    from dashpot.datamodel.machine import Machine
    from dashpot.extensions.batch.arrays.fit_many import BatchFit
    from dashpot.extensions.batch.comparison import LotComparison
    from dashpot.extensions.batch.lot import Lot


def _show_overloads(function: F) -> F:
    """Give a function the signature of its overloads in the source, as a decorator."""
    cases = (signature(case) for case in get_overloads(function))
    function.__signature__ = merge_signatures(function, cases)  # type: ignore[attr-defined]
    return call_handler("add advice", "function", function, default=function)  # type: ignore[no-any-return]


@overload
def batch(
    paths: Place | Sequence[Place],
    /,
    *,
    to: Place | None = None,
    arms: Arms = "auto",
    method: Method = "full",
    quick: bool = False,
    mass: Quantity | None = None,
    seals: float = 1.0,
    frequency: Quantity | Sequence[Quantity] = (),
    compression: Quantity | Sequence[Quantity] = (),
    length: Quantity | None = None,
    radius: Quantity | None = None,
    machine: Machine | None = None,
    label_pattern: str | None = None,
    manifest: Place | None = None,
    pair: str | None = None,
    joint: bool = False,
    jobs: int | None = None,
    scheduler: str | None = None,
) -> Lot: ...
@overload
def batch(
    forces: npt.ArrayLike,
    /,
    *,
    time: npt.ArrayLike,
    displacement: npt.ArrayLike | None = None,
    ramp: tuple[float, float] | None = None,
    units: str,
    arms: int = 2,
    method: Method = "full",
    errors: bool = False,
) -> BatchFit: ...
@_show_overloads
def batch(what: Any, /, **options: Any) -> Any:
    """Fit every test in files and folders, one row each; or many records on one clock at once.

    Parameters
    ----------
    what : path or sequence of path; or array, shape (R, M)
        Files, folders and patterns; or forces, N, one record a row.
    to : path, optional
        Folder of the lot, with lot.csv, lot.xlsx, lot.json and its page lot.html as the command
        writes them; a second run makes only the rows that are missing.
    jobs : int, optional
        Number of parallel processes.
    arms, method, mass, seals, joint, pair, label_pattern, manifest, frequency, compression
        As ``dashpot batch --help`` has them.
    machine : Machine, optional
        On which the tests were made.
    time, displacement : array
        For arrays: their clock, and the displacement of all; or `ramp`, depth and ramp time.
    units : str
        For arrays: ``"SI"``, or those of time, displacement and force: ``"s, mm, N"``.

    Returns
    -------
    Lot, or BatchFit of arrays

    Raises
    ------
    ReadError, DataError
        If a path names nothing, or a choice makes no sense. No file's contents raise.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> test = dp.simulate("relaxation", hold="5s", noise_free=True)
    >>> many = dp.batch(
    ...     [test.force, 2 * test.force], time=test.time, displacement=test.displacement,
    ...     units="SI", arms=2,
    ... )
    >>> (many.k_inf[1] / many.k_inf[0]).round(6)
    np.float64(2.0)
    """
    if "time" in options:
        return call_with_options(_fit_arrays, what, options=options, subject="a batch of arrays")
    alone = isinstance(what, str) or not isinstance(what, Iterable)
    paths = [what] if alone else list(what)
    if not all(isinstance(path, str) or hasattr(path, "__fspath__") for path in paths):
        raise DataError(
            'a batch is of files, dp.batch("tests/", to="lot"), or of arrays on one clock: '
            'dp.batch(forces, time=t, displacement=x, units="s, mm, N")'
        )
    return call_with_options(_fit_files, paths, options=options, subject="a batch of files")


def _fit_files(
    paths: Sequence[Place],
    *,
    to: Place | None = None,
    arms: Arms = "auto",
    method: Method = "full",
    quick: bool = False,
    mass: Quantity | None = None,
    seals: float = 1.0,
    frequency: Quantity | Sequence[Quantity] = (),
    compression: Quantity | Sequence[Quantity] = (),
    length: Quantity | None = None,
    radius: Quantity | None = None,
    machine: Machine | None = None,
    label_pattern: str | None = None,
    manifest: Place | None = None,
    pair: str | None = None,
    joint: bool = False,
    jobs: int | None = None,
    scheduler: str | None = None,
) -> Lot:
    from dashpot.extensions.batch.batch_run import batch as run_batch

    lot = run_batch(
        paths, output=to, arms=arms, method=method, quick=quick, mass=mass, seals=seals,
        at=frequency, compression=compression, length=length, radius=radius,
        machine=machine, label_pattern=label_pattern, manifest=manifest, pair=pair, joint=joint,
        jobs=jobs, scheduler=scheduler,
    )  # fmt: skip
    if to is not None:
        from dashpot.extensions.batch.lot_output import write_lot  # figures and pages take time
        from dashpot.extensions.batch.summary import summary
        from dashpot.workflow.outputs import Outputs

        write_lot(Path(to), summary(lot, quantity=lot.main), write=Outputs().write)
    return lot


def _fit_arrays(
    forces: Any,
    *,
    time: Any,
    units: str = "",
    displacement: Any = None,
    ramp: tuple[float, float] | None = None,
    arms: int = 2,
    method: Method = "full",
    errors: bool = False,
) -> BatchFit:
    from dashpot.extensions.batch.arrays.fit_many import fit_many

    t, x, F = _convert_arrays_to_si(
        units, time=(time, "time"), displacement=(displacement, "length"), force=(forces, "force")
    )
    return fit_many(t, F, displacement=x, ramp=ramp, arms=arms, method=method, errors=errors)


def _convert_arrays_to_si(units: str, **arrays: tuple[Any, Dimension]) -> list[Any]:
    """Return arrays in SI, each given with its dimension; None is returned as None.

    Raises
    ------
    DataError
        As :func:`convert_arrays_to_si`.
    """
    from dashpot.base.arrays import SI, convert_arrays_to_si

    holder = SimpleNamespace(units=units, **{name: values for name, (values, _) in arrays.items()})
    if units != SI:
        convert_arrays_to_si(holder, **{name: dimension for name, (_, dimension) in arrays.items()})
    return [getattr(holder, name) for name in arrays]


def compare_lots(first: Lot, second: Lot, /, *, quantities: Sequence[str] = ()) -> LotComparison:
    """Compare the quantities of two lots."""
    from dashpot.extensions.batch.comparison import compare_two_lots

    return compare_two_lots(("the first lot", first), ("the second lot", second), tuple(quantities))


def read_lot(folder: Place) -> Lot:
    """Read the lot that a batch wrote into a folder."""
    from dashpot.extensions.batch.lot import Lot

    return Lot.read(folder)
