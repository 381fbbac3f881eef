"""Lot: a table of many tests, one row each, with its statistics."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dashpot.base import dataclass
from dashpot.base.checks import Check
from dashpot.base.errors import DataError, ReadError
from dashpot.base.plain_text import escape_formula
from dashpot.base.provenance import SIMULATED
from dashpot.base.units import format_quantity
from dashpot.base.version import byline
from dashpot.extensions.batch.checks import (
    few_fits_doubted,
    files_fitted,
    fits_usable,
    hammers_compared,
    records_distinct,
    tests_alike,
)
from dashpot.extensions.batch.columns import LEADING_COLUMNS, REQUIRED_COLUMNS, TRAILING_COLUMNS
from dashpot.extensions.batch.parquet_parts import import_polars, join_frames, read_parts
from dashpot.extensions.batch.quantities import Quantity, make_natural_sort_key, quantity
from dashpot.extensions.batch.seals import (
    Charts,
    LotCharts,
    Seal,
    average_seals,
    make_control_charts,
    split_seals_by_lot,
)
from dashpot.extensions.batch.statistics.control_chart import chart_means_and_deviations
from dashpot.extensions.batch.statistics.gauge_rr import Gauge, gauge
from dashpot.extensions.batch.statistics.process_capability import Capability, capability
from dashpot.extensions.batch.statistics.two_sample import Difference, difference
from dashpot.extensions.batch.statistics.variance_components import (
    SHORT_HOLD,
    Component,
    components,
    find_outlier_distances,
)
from dashpot.workflow.dataframes import library

if TYPE_CHECKING:
    import polars as pl

    from dashpot.plot.picture import Picture


_MAIN = ("k_end_", "E_end_")
_FORCE_COLUMNS = ("cld_per_100mm", "cld_force", "loop_storage", "indent_modulus", "restitution")
"""Columns of load deflection and indentation tests."""
MAX_CONDITION_DIFFERENCE = 0.05
"""Largest relative difference of hold and depth of a test from the median of its lot."""
DEGREES = 3.0
"""Largest difference of its temperature, K."""


def _list_levels(seals: Sequence[Seal]) -> list[tuple[str, list[str]]]:
    """Return lot and seal of every test, each level only if it repeats."""
    tests = [seal for seal in seals for _ in seal.files]
    lots = {seal.lot for seal in seals}
    levels = [("lot", [test.lot for test in tests])] if len(lots) > 1 else []
    if len(tests) > len(seals) > len(lots):
        levels.append(("seal", [test.name for test in tests]))
    return levels


@dataclass(frozen=True, eq=False)
class Lot:
    """Lot of many tests, one row each.

    A quantity is named as a column of the table, with its unit (``"k_end_N_per_m"``) or without
    (``"k_end"``). Statistics are of the rows in `rows_in_statistics`, and their replicates are
    seals: a seal is represented by the mean of its tests.

    Attributes
    ----------
    table : polars.DataFrame
        Sorted by file; SI units, which the names of the columns end in.
    computed : int
        Rows that this run made; the others were there.

    Examples
    --------
    >>> import dashpot as dp
    >>> lot = dp.batch("tests/", to="lot", jobs=2)  # doctest: +SKIP
    >>> lot.outcomes  # doctest: +SKIP
    {'fitted': 12}
    """

    table: pl.DataFrame
    computed: int

    @staticmethod
    def read(folder: str | Path) -> Lot:
        """Return the lot that a batch wrote into a folder, which may be named by its table.

        Raises
        ------
        ReadError
            If there is none.
        """
        path = Path(folder)
        if not path.exists():
            raise ReadError(f"{folder} does not exist; give the LOT of dashpot batch -o")
        path = path.parent if path.is_file() else path
        frame = join_frames((table for _, table in read_parts(path)), "diagonal")
        if frame.is_empty():
            raise ReadError(f"{folder} holds no rows of a batch; give the LOT of dashpot batch -o")
        return Lot(frame.sort("file"), 0)

    @property
    def outcomes(self) -> dict[str, int]:
        """Number of files ``fitted``, ``refused``, ``other`` tests, ``died`` or ``changed``.

        Texts and pictures of a folder were ``ignored``.
        """
        return dict(Counter(self.table["outcome"]).most_common())

    @property
    def ignored_files(self) -> tuple[str, ...]:
        """Files of the folder that are no tables of numbers."""
        return tuple(self.table.filter(self.table["outcome"] == "ignored")["file"])

    @property
    def record_count(self) -> int:
        """Number of files that may be tests."""
        return self.table.height - len(self.ignored_files)

    @property
    def verdicts(self) -> dict[str, int]:
        """Number of fits by verdict."""
        return dict(Counter(item for item in self.table["verdict"] if item).most_common())

    @property
    def agreements(self) -> dict[str, int]:
        """Number of predictions by the verdict of their comparison with a hammer test."""
        return dict(Counter(item for item in self.table["agreement"] if item).most_common())

    @property
    def simulated_count(self) -> int:
        """Number of rows of simulated files."""
        has_origin = "origin" in self.table.columns
        return int((self.table["origin"] == SIMULATED).sum()) if has_origin else 0

    @cached_property
    def fitted_rows(self) -> pl.DataFrame:
        """Rows with a fit whose verdict is not "do not use"."""
        column = import_polars().col
        return self.table.filter(
            (column("outcome") == "fitted") & (column("verdict") != "do not use")
        )

    @cached_property
    def dissimilar(self) -> dict[str, str]:
        """Tests under other conditions than those of their kind and lot: file and difference.

        Hold and depth within 5 % of the median, temperature within 3 K; of an even number the
        lower median, so that of two depths one is the lot's.
        """
        entries: dict[str, str] = {}
        for rows in self._groups(self.fitted_rows, "lot", "kind"):
            for name, condition, unit in (
                ("hold_s", "held for", "s"), ("depth_m", "pressed to", "mm"),
                ("temperature_K", "tested at", "K"),
            ):  # fmt: skip
                if name not in rows.columns or rows[name].is_null().all():
                    continue
                typical = float(rows[name].quantile(0.5, interpolation="lower") or 0.0)
                tolerance = DEGREES if unit == "K" else MAX_CONDITION_DIFFERENCE * typical
                for file, value in rows.drop_nulls(name).select("file", name).iter_rows():
                    if abs(value - typical) > tolerance * (1 + 1e-9):
                        text, typical_text = (
                            format_quantity(number, unit, ".3g") for number in (value, typical)
                        )
                        entries.setdefault(file, f"{condition} {text}, its lot {typical_text}")
        return entries

    @cached_property
    def rows_in_statistics(self) -> pl.DataFrame:
        """The `fitted_rows` without `dissimilar` ones and copies."""
        excluded_files = [*self.dissimilar, *self.copies]
        return self.fitted_rows.filter(~import_polars().col("file").is_in(excluded_files))

    @cached_property
    def copies(self) -> dict[str, str]:
        """Tests with the same record as another one: file, and the other file."""
        first: dict[tuple[str, str], str] = {}
        if "sha256" not in self.table.columns:
            return {}
        comparable_rows = self.fitted_rows.filter(
            ~import_polars().col("file").is_in(list(self.dissimilar))
        )
        parts = (
            "part" if "part" in comparable_rows.columns else import_polars().lit("").alias("part")
        )
        rows = comparable_rows.filter(import_polars().col("sha256") != "").select(
            "file", "sha256", parts
        )
        pairs = (
            (file, first.setdefault((sha256, part), file))
            for file, sha256, part in rows.iter_rows()
        )
        return {file: other for file, other in pairs if file != other}

    def quantity(self, name: str) -> Quantity:
        """Return the quantity of a column, by its name with or without the unit.

        Raises
        ------
        DataError
            If no numeric column has that name.
        """
        numbers = [text for text, kind in self.table.schema.items() if kind.is_float()]
        # the stiffness of a part and the modulus of a material share a name: of which there are any
        return quantity(name, sorted(numbers, key=lambda text: self.table[text].count() == 0))

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """Quantities that are results of the tests and have values."""
        pattern = (
            r"[kE]_(end|0|inf)_|(storage|loss|loss_factor|k_end)_at_|frequency_|damping_ratio|"
            r"cld_(per_100mm|force|slope|hysteresis|softening|set)|indent_modulus|restitution|"
            r"loop_(storage|loss|softening)"
        )
        names = self.table.select(import_polars().col(f"^({pattern}).*$")).columns
        column_names = [
            name for name in names if not any(end in name for end in ("_se_", "_low_", "_high_"))
        ]
        return tuple(self.quantity(name) for name in column_names if self.table[name].count())

    @property
    def main(self) -> str:
        """Default quantity of a page: k_end, or the equivalent for other tests."""
        if any(
            self.table[column].count() for column in self.table.columns if column.startswith(_MAIN)
        ):
            return "k_end"
        names = {quantity.name for quantity in self.quantities}
        return next((name for name in _FORCE_COLUMNS if name in names), "k_end")

    def seals(self, name: str = "k_end") -> tuple[Seal, ...]:
        """Return the seals with their values of a quantity, in the order of lot and seal."""
        column = self.quantity(name).column
        groups: dict[tuple[str, str], list[tuple[str, float]]] = defaultdict(list)
        rows = self.rows_in_statistics.drop_nulls(column).select("lot", "seal", "file", column)
        for lot, seal, file, value in rows.iter_rows():
            groups[lot, seal or file].append((file, value))
        ordered_seals = sorted(
            groups, key=lambda key: (make_natural_sort_key(key[0]), make_natural_sort_key(key[1]))
        )
        return tuple(
            Seal(*key, tuple(file for file, _ in groups[key]),
                 np.array([value for _, value in groups[key]]))
            for key in ordered_seals
        )  # fmt: skip

    def components(self, name: str = "k_inf") -> tuple[Component, ...]:
        """Return the variance components of a quantity: lots, seals, repeats, errors of fits.

        A level with one member or without labels is omitted; without repeats the scatter inside a
        lot is that of its seals and their tests. Only ``k_inf`` has errors of the fits, and only if
        they were computed.

        Raises
        ------
        DataError
            If there is no such column, or nothing that repeats.
        """
        seals = self.seals(name)
        levels = _list_levels(seals)
        if not levels:
            raise DataError(
                "the scatter has no sources to separate: say which lot, seal and repeat each "
                "test is, by --label-pattern or --manifest, of at least two lots or seals"
            )
        is_k_inf = self.quantity(name).name == "k_inf"
        errors = self._select_test_values("k_inf_se_N_per_m", seals) if is_k_inf else [None]
        return components(
            np.concatenate([seal.values for seal in seals]),
            levels,
            innermost_name="repeat" if any(len(seal.files) > 1 for seal in seals) else "seal",
            errors=None if None in errors else np.array(errors),
        )

    def _select_test_values(self, column: str, seals: Sequence[Seal]) -> list[Any]:
        """Return the values of a column of every test of these seals."""
        by_file = dict(self.rows_in_statistics.select("file", column).iter_rows())
        return [by_file[file] for seal in seals for file in seal.files]

    def gauge(self, name: str = "k_end") -> Gauge:
        """Return repeatability and reproducibility (gauge R&R), with the seals as parts.

        Raises
        ------
        DataError
            If no seal was tested twice, or not every operator tested two seals twice.
        """
        seals = self.seals(name)
        operators = self._select_test_values("operator", seals)
        parts = [f"{i}" for i, seal in enumerate(seals) for _ in seal.files]
        if not seals:
            raise DataError(f"no test that is used has a value of {name}")
        return gauge(np.concatenate([seal.values for seal in seals]), parts, operators)

    def charts(self, name: str = "k_end") -> dict[str, Charts]:
        """Return the control charts of each lot with at least two seals, by lot.

        Repeats of a seal do not say how seals differ, so the limits of the seals are those of
        individuals and moving ranges, and the repeats have a chart of their standard deviations
        (Wheeler, Advanced Topics in Statistical Process Control, 1995, chapter 9).
        """
        lots = split_seals_by_lot(self.seals(name))
        return {lot: make_control_charts(seals) for lot, seals in lots.items() if len(seals) > 1}

    def lot_chart(self, name: str = "k_end") -> LotCharts | None:
        """Return the X-bar and s charts of the lots, each lot a group of its seals.

        None with one lot, or if no lot has two seals.
        """
        lots = split_seals_by_lot(self.seals(name))
        if len(lots) < 2 or max(map(len, lots.values())) < 2:
            return None
        charts = chart_means_and_deviations([average_seals(seals) for seals in lots.values()])
        return LotCharts(tuple(lots), *charts)

    def capability(
        self, name: str, lower: float | None = None, upper: float | None = None
    ) -> dict[str, Capability]:
        """Return Cp and Cpk of the seals of each lot that has two, between limits in SI, by lot."""
        return {
            lot: capability(average_seals(seals), lower, upper)
            for lot, seals in split_seals_by_lot(self.seals(name)).items()
            if len(seals) > 1
        }

    def compare(self, other: Lot, name: str = "k_end", *, questions: int = 1) -> Difference:
        """Return the difference of the seals of another lot from those of this one.

        `questions` is the number of quantities that are compared at once.

        Raises
        ------
        DataError
            If there are fewer than two seals of either.
        """
        return difference(
            average_seals(self.seals(name)), average_seals(other.seals(name)), questions=questions
        )

    def only(self, name: str) -> Lot:
        """Return one lot of several.

        Raises
        ------
        DataError
            If there is no lot of that name.
        """
        lots = sorted(set(self.table["lot"]), key=make_natural_sort_key)
        if name not in lots:
            raise DataError(f"there is no lot '{name}'; there are {', '.join(filter(None, lots))}")
        return Lot(self.table.filter(import_polars().col("lot") == name), 0)

    def outliers(self, name: str = "k_end") -> tuple[tuple[str, float], ...]:
        """Return the outliers of each lot: file, and distance in robust deviations.

        From the median of the lot, in 1.4826 times its median absolute deviation; the limit is
        :func:`~dashpot.extensions.batch.statistics.variance_components.find_outlier_distances`'s,
        3.5 in a large lot.
        """
        column, pairs = self.quantity(name).column, []
        for rows in self._groups(self.rows_in_statistics.drop_nulls(column), "lot"):
            is_outlying = find_outlier_distances(rows[column].to_numpy())
            pairs += [
                (str(file), float(value))
                for file, value in zip(rows["file"], is_outlying, strict=True)
                if value
            ]
        return tuple(sorted(pairs, key=lambda pair: -abs(pair[1])))

    @property
    def short_holds(self) -> tuple[str, ...]:
        """Files with a hold below 95 % of the median of their kind and lot."""
        column = import_polars().col
        shortest_expected = SHORT_HOLD * column("hold_s").median().over("lot", "kind")
        return tuple(self.table.filter(column("hold_s") < shortest_expected)["file"])

    def csv(self) -> str:
        """Return the table as CSV below a line that names dashpot; formulas are escaped."""
        return f"# {byline('table of a batch of tests')}\n{self.written_table().write_csv()}"

    def written_table(self) -> pl.DataFrame:
        """Return the table as files hold it: verdicts first, hashes last, no column without value.

        Texts that a spreadsheet would take for formulas are escaped.
        """
        return _arrange_columns(self.escape_formulas())

    def escape_formulas(self) -> pl.DataFrame:
        """Return the table with texts escaped that a spreadsheet takes for formulas."""
        library = import_polars()
        texts = [
            library.Series(column.name, [escape_formula(text) for text in column])
            for column in self.table.select(library.col(library.String)).iter_columns()
        ]
        return self.table.with_columns(texts)

    def to_pandas(self) -> Any:
        """Return the table as a :class:`pandas.DataFrame`, its columns as in lot.csv.

        Verdicts first, hashes last, no column without a value; `table` has every column. It needs
        no pyarrow.

        Raises
        ------
        DataError
            If pandas is not installed.
        """
        return library("pandas").DataFrame(_arrange_columns(self.table).to_dict(as_series=False))

    def plot(self, name: str = "k_end") -> Picture:
        """Return the control charts of a quantity as a picture for :func:`dashpot.plot.save`."""
        from dashpot.extensions.batch.figures import control_picture

        return control_picture(self.quantity(name), self.charts(name), self.seals(name))

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks: every file fitted, every fit usable, tests of a lot under the same conditions."""
        fitted_count = self.outcomes.get("fitted", 0)
        pair_count = self.table.filter(import_polars().col("hammer") != "").height
        return (
            files_fitted(self.record_count - fitted_count, self.record_count),
            fits_usable(self.verdicts.get("do not use", 0), fitted_count),
            few_fits_doubted(self.verdicts.get("use with care", 0), fitted_count),
            hammers_compared(pair_count - sum(self.agreements.values()), pair_count),
            tests_alike(len(self.dissimilar), self.fitted_rows.height),
            records_distinct(len(self.copies), self.rows_in_statistics.height + len(self.copies)),
        )

    @staticmethod
    def _groups(rows: pl.DataFrame, *labels: str) -> Iterator[pl.DataFrame]:
        names = [name for name in labels if name in rows.columns]
        for _, group in rows.group_by(names, maintain_order=True):
            yield group


def _arrange_columns(rows: pl.DataFrame) -> pl.DataFrame:
    """Return a table with verdicts first and hashes last, and no column without a value."""
    filled_columns = [
        name
        for name in rows.columns
        if name in REQUIRED_COLUMNS
        or (rows[name].drop_nulls().cast(import_polars().String) != "").any()
    ]
    leading = [name for name in LEADING_COLUMNS if name in filled_columns]
    values = [name for name in filled_columns if name not in {*LEADING_COLUMNS, *TRAILING_COLUMNS}]
    end = [name for name in TRAILING_COLUMNS if name in filled_columns]
    return rows.select(*leading, *values, *end)
