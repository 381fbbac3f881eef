"""A batch of tests to one table, which a second run completes."""

from __future__ import annotations

import datetime as dt
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.lock import alone
from dashpot.base.progress import doing
from dashpot.base.units import Quantity, si
from dashpot.base.version import byline
from dashpot.io.options import ReadOptions
from dashpot.io.write import neutral
from dashpot.lots.checks import files_fitted, fits_usable, hammers_compared
from dashpot.lots.choices import BatchChoices, several
from dashpot.lots.engines import engine
from dashpot.lots.entries import entries
from dashpot.lots.parts import (
    Task,
    claim,
    framed,
    keys_done,
    polars,
    table,
    tasks,
    write_part,
)
from dashpot.lots.processes import Engine, Rows
from dashpot.lots.row import row
from dashpot.lots.statistics.scatter import SHORT, Component, components, stands_out

if TYPE_CHECKING:
    from collections.abc import Iterator

    import polars as pl

CHUNK = 25
"""Files of a chunk: what a run that is cut short loses at most, for each process."""
LOG = "batch.log"
_LOCK = ".lock"
_TIMED = 3
"""Tests that a dry run times."""


@dataclass(frozen=True, eq=False)
class Lot:
    """Many tests, one row each.

    Attributes
    ----------
    table : polars.DataFrame
        Sorted by file; SI units, which the names of the columns end in.
    computed : int
        Rows that this run made; the others were there.
    """

    table: pl.DataFrame
    computed: int

    @property
    def outcomes(self) -> dict[str, int]:
        """How many files were ``fitted``, ``refused``, ``other`` tests, ``died`` or ``changed``."""
        return dict(Counter(self.table["outcome"]).most_common())

    @property
    def verdicts(self) -> dict[str, int]:
        """How many fits are for use, for use with care, and not for use."""
        return dict(Counter(one for one in self.table["verdict"] if one).most_common())

    @property
    def agreements(self) -> dict[str, int]:
        """What their hammers make of the predictions: for use, with care, or not for use."""
        return dict(Counter(one for one in self.table["agreement"] if one).most_common())

    @property
    def used(self) -> pl.DataFrame:
        """The rows that were fitted and whose verdict is not "do not use"."""
        column = polars().col
        return self.table.filter(
            (column("outcome") == "fitted") & (column("verdict") != "do not use")
        )

    def components(self, quantity: str = "k_inf_N_per_m") -> tuple[Component, ...]:
        """Where the scatter of a quantity comes from: lots, their seals, repeats, errors of fits.

        Of the rows in `used`. A level that has one member, or whose labels nobody gave, is left
        out; without repeats the scatter inside a lot is that of its seals and their tests. The
        errors of the fits are known of ``k_inf_N_per_m``, unless they were left out.

        Parameters
        ----------
        quantity : str
            A column of numbers.

        Raises
        ------
        DataError
            If there is no such column, or nothing that repeats.
        """
        if quantity not in self.table.columns or not self.table[quantity].dtype.is_float():
            raise DataError(f"'{quantity}' is no column of numbers of the table")
        rows = self.used.drop_nulls(quantity)
        lots, seals = rows["lot"].n_unique(), rows.select("lot", "seal").n_unique()
        levels = [("lot", rows["lot"].to_list())] if lots > 1 else []
        repeated = seals < rows.height
        if seals > lots and repeated:
            levels.append(("seal", rows["seal"].to_list()))
        if not levels:
            raise DataError(
                "the scatter has no sources to tell apart: say which lot, seal and repeat each "
                "test is, by --by or --manifest, of at least two lots or seals"
            )
        within = "repeat" if repeated else "seal"
        known = quantity == "k_inf_N_per_m" and not rows["k_inf_se_N_per_m"].has_nulls()
        errors = rows["k_inf_se_N_per_m"].to_numpy() if known else None
        return components(rows[quantity].to_numpy(), levels, within=within, errors=errors)

    def outliers(self, quantity: str = "k_end_N_per_m") -> tuple[tuple[str, float], ...]:
        """The tests that stand out of their lot: file, and distance in robust deviations.

        From the median of the lot, in 1.4826 times its median absolute deviation; the limit is
        :func:`~dashpot.lots.statistics.scatter.stands_out`'s, 3.5 in a large lot.
        """
        found = []
        for _, rows in self.used.drop_nulls(quantity).group_by("lot", maintain_order=True):
            away = stands_out(rows[quantity].to_numpy())
            found += [
                (str(file), float(one)) for file, one in zip(rows["file"], away, strict=True) if one
            ]
        return tuple(sorted(found, key=lambda one: -abs(one[1])))

    @property
    def short_holds(self) -> tuple[str, ...]:
        """Files of tests held for less than 95 % of the median hold of their kind in their lot."""
        column = polars().col
        least = SHORT * column("hold_s").median().over("lot", "kind")
        return tuple(self.table.filter(column("hold_s") < least)["file"])

    def csv(self) -> str:
        """The table as CSV, below a line that names dashpot; no text is a spreadsheet's formula."""
        pl = polars()
        texts = [
            pl.Series(one.name, [neutral(text) for text in one])
            for one in self.table.select(pl.col(pl.String)).iter_columns()
        ]
        return (
            f"# {byline('table of a batch of tests')}\n{self.table.with_columns(texts).write_csv()}"
        )

    @property
    def checks(self) -> tuple[Check, ...]:
        """Whether every file became a fit, and every fit may be used."""
        fitted = self.outcomes.get("fitted", 0)
        paired = self.table.filter(polars().col("hammer") != "").height
        return (
            files_fitted(self.table.height - fitted, self.table.height),
            fits_usable(self.verdicts.get("do not use", 0), fitted),
            hammers_compared(paired - sum(self.agreements.values()), paired),
        )


@dataclass(frozen=True)
class BatchPlan:
    """What a batch would do.

    Attributes
    ----------
    files, done : int
        In all, and those whose rows are there already.
    chunks : int
        Still to be made.
    seconds : float
        That they would take, by the first few tests on this machine; 0 if nothing is to be done.
    jobs : int
        Processes side by side.
    """

    files: int
    done: int
    chunks: int
    seconds: float
    jobs: int


def batch(
    paths: Sequence[str | Path] | str | Path,
    *,
    output: str | Path | None = None,
    arms: int | Literal["auto"] = "auto",
    method: Literal["full", "hold"] = "full",
    quick: bool = False,
    mass: Quantity | None = None,
    seals: float = 1.0,
    at: Quantity | Sequence[Quantity] = (),
    compression: Quantity | Sequence[Quantity] = (),
    by: str | None = None,
    manifest: str | Path | None = None,
    pair: str | None = None,
    joint: bool = False,
    jobs: int | None = None,
    scheduler: str | None = None,
    options: ReadOptions | None = None,
    impact_options: ReadOptions | None = None,
) -> Lot:
    r"""Fit every test in files, folders and patterns, one row each.

    Each test is fitted alone, in the way that suits it, as ``dashpot fit`` does it: a ramp and
    hold, a creep test, a dynamic sweep, a master curve, a relaxation modulus. A hammer that is
    paired with it is held against what it predicts. A file that has no fit, or cannot be read, is a
    row that says why. Rows are kept in `output` as Parquet parts by
    the hash of what decides them: configuration, version, contents; a second run, whatever ended
    the first, makes only those that are missing, and ends with the same table.

    Parameters
    ----------
    paths : path or sequence of path
    output : path, optional
        Folder of the parts and of the log; without one nothing is kept.
    arms, method
        As in :func:`~dashpot.fitting.relaxation.fit`.
    quick : bool
        The optimum alone, without errors, checks and verdict; `arms` must then be a number.
    mass : float, optional
        Of a block, kg, on so many `seals`: the table then has its frequency and damping ratio. The
        manifest may give each test its own.
    at : float or sequence of float
        Frequencies, Hz: the table then has storage and loss stiffness and loss factor there.
    compression : float or sequence of float
        Of the seals, m, for these and for the stiffness at the end of the hold: of small vibration
        about it. By default each test's own depth.
    by : str, optional
        A regular expression for the path, whose groups are lot, seal, repeat and operator:
        ``r"lot(\w+)_seal(\d+)_rep(\d+)"``; named groups may stand in any order.
    manifest : path, optional
        CSV or TOML with the columns file, lot, seal, repeat, operator, temperature, mass,
        hammer.
    pair : str, optional
        The pattern of the hammer's files of a test, seen from its folder:
        ``"{stem}_hammer*.csv"``, with {lot}, {seal} and {repeat} too. They are no rows of their
        own.
    joint : bool
        Fit a ramp and hold and its hammer together.
    jobs : int, optional
        Processes side by side; by default as many as there are processors.
    scheduler : str, optional
        Of a cluster of dask.distributed, ``"tcp://host:8786"``, whose workers make the rows: the
        same dashpot is installed there, and the files have the same paths.
    options, impact_options : ReadOptions, optional
        What is known of the files of the tests, and of the hammer.

    Raises
    ------
    ReadError, DataError
        If a path names nothing, or a choice makes no sense. No file's contents raise.
    ExportError
        If `output` holds something else, or polars is missing.
    """
    polars()
    made = engine(jobs, scheduler)
    choices = BatchChoices(
        arms, method, quick, si(mass, "mass"), seals, options or ReadOptions(),
        impact_options or ReadOptions(), joint, several(at, "frequency"),
        several(compression, "length"),
    )  # fmt: skip
    with _folder(output) as folder:
        asked = _asked(paths, choices, manifest=manifest, by=by, pair=pair, folder=folder)
        claim(folder)
        with alone(folder / _LOCK, str(folder)):
            missing = _missing(asked, folder)
            if missing:
                with made as making:
                    _compute(missing, choices, folder, making)
            return Lot(table(folder, [one.key for one in asked]), len(missing))


def plan_batch(
    paths: Sequence[str | Path] | str | Path,
    *,
    output: str | Path,
    by: str | None = None,
    manifest: str | Path | None = None,
    pair: str | None = None,
    jobs: int | None = None,
    scheduler: str | None = None,
    choices: BatchChoices,
) -> BatchPlan:
    """Say what :func:`batch` would do and how long it would take; nothing is written.

    Raises
    ------
    ReadError, DataError, ExportError
        As :func:`batch`.
    """
    folder, made = Path(output), engine(jobs, scheduler)
    asked = _asked(paths, choices, manifest=manifest, by=by, pair=pair, folder=folder)
    missing = _missing(asked, folder)
    with made as making:
        chunks = len(_chunks(missing, making.side))
    each = _seconds_each(missing[:_TIMED], choices)
    seconds = each * len(missing) / min(making.at_once, max(chunks, 1))
    return BatchPlan(len(asked), len(asked) - len(missing), chunks, seconds, making.side)


def _seconds_each(some: Sequence[Task], choices: BatchChoices) -> float:
    if not some:
        return 0.0
    row(some[0].entry, some[0].hashes, choices)  # what is imported once does not count
    began = time.perf_counter()
    for one in some:
        row(one.entry, one.hashes, choices)
    return (time.perf_counter() - began) / len(some)


@contextmanager
def _folder(output: str | Path | None) -> Iterator[Path]:
    if output is not None:
        yield Path(output)
        return
    with tempfile.TemporaryDirectory() as folder:
        yield Path(folder)


def _asked(
    paths: Sequence[str | Path] | str | Path,
    choices: BatchChoices,
    *,
    manifest: str | Path | None,
    by: str | None,
    pair: str | None,
    folder: Path,
) -> tuple[Task, ...]:
    several = [paths] if isinstance(paths, str | Path) else list(paths)
    doing("finding and hashing the files")
    return tasks(entries(several, manifest=manifest, by=by, pair=pair, without=folder), choices)


def _missing(asked: Sequence[Task], folder: Path) -> list[Task]:
    done = keys_done(folder) if folder.is_dir() else set()
    return [one for one in asked if one.key not in done]


def _chunks(missing: Sequence[Task], jobs: int) -> list[tuple[Task, ...]]:
    """No chunk is so large that a process would have none."""
    size = max(1, min(CHUNK, -(-len(missing) // jobs)))
    return [tuple(missing[i : i + size]) for i in range(0, len(missing), size)]


def _compute(missing: Sequence[Task], choices: BatchChoices, folder: Path, by: Engine) -> None:
    chunks, done, began = _chunks(missing, by.side), 0, time.monotonic()
    doing(f"{len(missing)} tests in {len(chunks)} chunks")
    with (folder / LOG).open("a", encoding="utf-8") as log:
        for chunk, rows in by.computed(chunks, choices):
            path = write_part(folder, framed(rows, choices))
            done += len(chunk)
            rate = done / (time.monotonic() - began)
            left = (len(missing) - done) / rate
            told = f"{done} of {len(missing)} tests, {rate:.1f} tests/s, {left:.0f} s left"
            doing(told)
            log.write(f"{_now()} {path.name} {_counted(rows)}; {told}\n")
            log.flush()


def _counted(rows: Rows) -> str:
    counts: Counter[Any] = Counter(one["outcome"] for one in rows)
    return ", ".join(f"{count} {outcome}" for outcome, count in counts.most_common())


def _now() -> str:
    return dt.datetime.now(dt.UTC).isoformat(timespec="seconds")
