"""Comparison of two lots, quantity by quantity."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from dashpot.base import dataclass
from dashpot.base.checks import Check, HasChecks
from dashpot.base.errors import DataError
from dashpot.base.number_format import ascii_only, format_count
from dashpot.base.plain_text import sentence
from dashpot.base.serialisation import Key, Serialisable
from dashpot.extensions.batch.checks import lots_tested_alike, records_distinct, seals_named
from dashpot.extensions.batch.lot import DEGREES, MAX_CONDITION_DIFFERENCE, Lot
from dashpot.extensions.batch.quantities import Quantity, make_natural_sort_key
from dashpot.extensions.batch.statistics.two_sample import Difference

_DEPENDENT_QUANTITIES = ("k_inf", "E_inf", "loss_at_")
_CONDITIONS = ("hold_s", "depth_m", "temperature_K", "ramp_s")


@dataclass(frozen=True)
class QuantityComparison(Serialisable):
    """Comparison of one quantity of two lots.

    Attributes
    ----------
    quantity : Quantity
    difference : Difference
        The second lot less the first, SI.
    shared : int
        Records in both lots; the test assumes independent lots.
    """

    _keys = (
        Key("quantity", "quantity.name"),
        "quantity.column",
        "different",
        Key("p_value_adjusted", "p_value"),
        Key("difference", flatten=True),
    )

    quantity: Quantity
    difference: Difference
    shared: int

    @property
    def p_value(self) -> float:
        """That of the test, adjusted for the number of quantities that are compared at once."""
        return self.difference.p_value

    @property
    def different(self) -> bool | None:
        """Whether chance gives such a difference in fewer than 5 % of trials.

        None if the lots share records.
        """
        return None if self.shared else self.difference.different

    def share(self, value: float) -> float:
        """Return a difference, SI, over the mean of the first lot."""
        mean = self.difference.means[0]
        return value / mean if mean else float("nan")


@dataclass(frozen=True)
class LotComparison(HasChecks, Serialisable):
    """Comparison of two lots.

    Attributes
    ----------
    lots : (str, str)
    differences : tuple of QuantityComparison
    checks : tuple of Check
    """

    schema = "dashpot/lot-comparison@2"
    _keys = ("lots", "verdict", "differences", "checks")

    lots: tuple[str, str]
    differences: tuple[QuantityComparison, ...]
    checks: tuple[Check, ...]

    @property
    def _headline(self) -> str:
        """Number of quantities that differ, and the difference that chance explains least."""
        comparisons = [comparison for comparison in self.differences if not comparison.shared]
        if not comparisons:
            return "0 quantities are compared: the lots share their records"
        smallest = min(comparisons, key=lambda comparison: comparison.p_value)
        differ = sum(bool(comparison.different) for comparison in comparisons)
        low, high = (100 * smallest.share(end) for end in smallest.difference.interval)
        percent = 100 * smallest.share(smallest.difference.value)
        return (
            f"{differ} of {len(comparisons)} compared quantities differ. "
            f"{sentence(smallest.quantity.words)[:-1]}: {percent:+.2g} %, 95 % from {low:+.2g} to "
            f"{high:+.2g} %"
        )

    def __str__(self) -> str:
        first, second = self.lots
        lines = [f"{second} against {first}; seals are what is compared, not their repeats"]
        for comparison in self.differences:
            lines += _format_comparison(comparison)
        return "\n".join(lines)


def _format_comparison(item: QuantityComparison) -> Iterator[str]:
    difference, format_value = item.difference, item.quantity.read

    def share(value: float) -> str:
        return f"{100 * item.share(value):+.2g} %"

    low, high = difference.interval
    result_text = (
        f"{'different' if item.different else 'no difference found'} (p = {item.p_value:.2g})"
    )
    if item.shared:
        result_text = f"not checked, the lots have {format_count(item.shared, 'record')} in common"
    yield f"{item.quantity.words}: {result_text}"
    means = " and ".join(
        f"{format_value(mean)} ({count} seals, SD {format_value(sd, digits=2)})"
        for mean, count, sd in zip(
            difference.means, difference.counts, difference.deviations, strict=True
        )
    )
    yield f"  means       {ascii_only(means)}"
    if item.shared:
        return
    yield f"  difference  {share(difference.value)}, 95 % from {share(low)} to {share(high)}"
    yield (
        f"  detectable  {abs(100 * item.share(difference.detectable)):.2g} % with a power of 80 %; "
        f"alike within {abs(100 * item.share(difference.equivalence_margin)):.2g} % "
        "(two one-sided tests)"
    )


def open_lot(folder_name: str) -> tuple[str, Lot]:
    """Return the lot that ``FOLDER`` or ``FOLDER:LOT`` names, and its name.

    Raises
    ------
    ReadError
        If there is no lot in the folder.
    DataError
        If there are several and none, or one that is not there, was named.
    """
    folder, _, lot_name = (
        (folder_name, "", "") if Path(folder_name).is_dir() else folder_name.rpartition(":")
    )
    lot = Lot.read(folder or folder_name)
    if lot_name:
        return lot_name, lot.only(lot_name)
    lots = sorted(set(lot.fitted_rows["lot"]), key=make_natural_sort_key)
    if len(lots) > 1:
        raise DataError(
            f"{folder_name} holds {len(lots)} lots: {', '.join(lots)}; say which one is meant, "
            f"such as {folder_name}:{lots[0]}"
        )
    return Path(folder_name).resolve().name, lot


def open_both_lots(names: Sequence[str]) -> list[tuple[str, Lot]]:
    """Return two lots, opened each; lots with the same name are called as they were given."""
    lots = [open_lot(name) for name in names]
    if len({name for name, _ in lots}) == 1:
        return [(name, lot) for name, (_, lot) in zip(names, lots, strict=True)]
    return lots


def compare_two_lots(
    first: tuple[str, Lot], second: tuple[str, Lot], names: Sequence[str] = ()
) -> LotComparison:
    """Return the difference of the second lot from the first, and the detectable difference.

    Parameters
    ----------
    first, second : (str, Lot)
        Name of a lot, and the lot.
    names : sequence of str
        Quantities; by default those that both lots have, without those that follow from others.

    Raises
    ------
    DataError
        If a lot has fewer than two seals, or lacks a quantity.
    """
    (first_name, first_lot), (second_name, second_lot) = first, second
    quantities = [
        _find_common_quantity(first, second, name)
        for name in tuple(names) or _select_common_quantities(first_lot, second_lot)
    ]
    if not quantities:
        raise DataError(f"{first_name} and {second_name} have no quantity in common")
    differences = [
        first_lot.compare(second_lot, quantity.name, questions=len(quantities))
        for quantity in quantities
    ]
    unnamed = sum(
        int((lot.rows_in_statistics["seal"] == "").sum()) for lot in (first_lot, second_lot)
    )
    shared_count = _count_shared_records(first_lot, second_lot)
    tests = first_lot.rows_in_statistics.height + second_lot.rows_in_statistics.height
    return LotComparison(
        (first_name, second_name),
        tuple(
            QuantityComparison(*item, shared_count)
            for item in zip(quantities, differences, strict=True)
        ),
        (
            lots_tested_alike(tuple(_find_other_conditions(first_lot, second_lot))),
            seals_named(unnamed, tests),
            records_distinct(shared_count, tests),
            *(
                check.with_location(f"in {name}")
                for name, lot in (first, second)
                for check in lot.checks
            ),
        ),
    )


def compare_folders(first: str, second: str, quantities: Sequence[str]) -> LotComparison:
    """Compare two lots; ``FOLDER:NAME`` is one lot of several."""
    pair, other = open_both_lots((first, second))
    return compare_two_lots(pair, other, tuple(quantities))


def _count_shared_records(first: Lot, second: Lot) -> int:
    """Records of the second lot that the first holds, too."""
    difference = set(first.rows_in_statistics["sha256"]) - {""}
    return sum(sha256 in difference for sha256 in second.rows_in_statistics["sha256"])


def _select_common_quantities(first: Lot, second: Lot) -> tuple[str, ...]:
    """Return the quantities of both lots, without derived ones."""
    second_names = {quantity.name for quantity in second.quantities}
    first_names = (quantity.name for quantity in first.quantities)
    return tuple(
        name
        for name in first_names
        if name in second_names and not name.startswith(_DEPENDENT_QUANTITIES)
    )


def _find_common_quantity(first: tuple[str, Lot], second: tuple[str, Lot], name: str) -> Quantity:
    """Return a quantity that both lots have."""
    for lot_label, lot in (second, first):
        try:
            quantity = lot.quantity(name)
        except DataError as error:
            raise DataError(f"{lot_label}: {error}") from None
    return quantity


def _find_other_conditions(single_lot: Lot, other: Lot) -> Iterator[str]:
    """Conditions of the tests that differ between the lots, by their medians."""
    for name in _CONDITIONS:
        medians = [lot.rows_in_statistics[name].median() for lot in (single_lot, other)]
        first, second = (value if isinstance(value, float) else None for value in medians)
        if first is None or second is None:
            continue
        if abs(second - first) > (
            DEGREES if name == "temperature_K" else MAX_CONDITION_DIFFERENCE * abs(first)
        ):
            suffix, _, unit = name.rpartition("_")
            yield f"{suffix} {first:.4g} and {second:.4g} {unit}"
