"""Specimen of a test: name, dimensions, temperature and history."""

from __future__ import annotations

import datetime as dt
from collections.abc import Sequence

from dashpot.base import dataclass, fields, replace
from dashpot.base.errors import DataError
from dashpot.base.option_fields import option
from dashpot.base.units import convert_to_unit, format_quantity, si_fields
from dashpot.base.value_ranges import SIZES, require_positive, select_fields

# Plausible test temperatures of elastomers, K.
_COLDEST, _HOTTEST = 100.0, 550.0


@dataclass(frozen=True)
class Specimen:
    """Specimen of a test; a length or temperature may be given with its unit, ``"100mm"``.

    Attributes
    ----------
    length : float or None
        Contact length of the seal under the plate, m.
    height : float or None
        Free height of the section, m.
    temperature : float or None
        Test temperature, K.
    notes : str
        Further notes: material, fixing, load history.
    name : str
        Name, such as "Door seal 4711-B".
    lot, operator : str
        Lot, and operator of the test.
    date : str
        Date of the test, ISO 8601: 2026-11-21.
    stated_temperature : float or None
        Temperature in the file, if `temperature` was given differently, K.
    warmed : float or None
        By how much the file's own column of temperature rises over the record, K.
    rested : float or None
        Rest time before the record as stated in the file, s.

    Examples
    --------
    >>> import dashpot as dp
    >>> dp.Specimen(length="50mm", temperature="23degC").temperature
    296.15
    """

    length: float | None = option(
        None, "Contact length of the seal, e.g. 50mm.", unit="length", size=SIZES["seal length"]
    )
    height: float | None = option(
        None, "Free height of the section.", unit="length", size=SIZES["seal height"]
    )
    temperature: float | None = option(None, "Test temperature, e.g. 23degC.", unit="temperature")
    notes: str = option("", "Material, fixing, load history.", keyed_flag="label")
    name: str = option("", "What the specimen is called.", keyed_flag="label")
    lot: str = option("", "Its lot.", keyed_flag="label")
    operator: str = option("", "Who tested it.", keyed_flag="label")
    date: str = option("", "Date of the test, e.g. 2026-11-21.", keyed_flag="label")
    stated_temperature: float | None = None
    warmed: float | None = None
    rested: float | None = None

    def with_defaults(self, other: Specimen) -> Specimen:
        """Return this specimen, completed by the fields of another."""
        given_fields = {field.name: getattr(self, field.name) for field in fields(self)}
        return replace(other, **{name: value for name, value in given_fields.items() if value})

    def __post_init__(self) -> None:
        si_fields(self)
        if self.date:
            try:
                dt.date.fromisoformat(self.date)
            except ValueError:
                raise DataError(
                    f"specimen date = {self.date!r}; expected year-month-day, such as 2026-11-21"
                ) from None
        if self.temperature is not None:
            tested_at("specimen temperature", self.temperature)
        sizes = select_fields(self, "length", "height")
        require_positive("specimen ", **sizes, expected="a number > 0 in SI units", optional=True)


def tested_at(name: str, *temperatures: float) -> None:
    """Refuse temperatures, K, at which rubber is not tested; `name` is their name in the message.

    Raises
    ------
    DataError
        If one is out of that range: most often one in K called degC, or the other way round.
    """
    for kelvin in temperatures:
        if not _COLDEST <= kelvin <= _HOTTEST:
            absolute_zero_note = ", below absolute zero" if kelvin < 0 else ""
            raise DataError(
                f"{name} = {kelvin:g} K, or "
                f"{format_quantity(kelvin, 'degC', 'g')}{absolute_zero_note}; expected one that "
                f"rubber is tested at, {_COLDEST:g} to {_HOTTEST:g} K, or "
                f"{convert_to_unit(_COLDEST, 'degC'):.0f} to "
                f"{format_quantity(_HOTTEST, 'degC', '.0f')}: is the unit degC or K, the sign "
                "right?"
            )


def make_file_specimens(
    specimen: Specimen | None, temperatures: Sequence[float], files: int
) -> tuple[Specimen | None, ...]:
    """Return the specimen of each file: one temperature, K, for all of them, or one for each.

    Raises
    ------
    DataError
        If there are more temperatures than one, and not as many as files.
    """
    if not temperatures:
        return (specimen,) * files
    if len(temperatures) not in (1, files):
        raise DataError(
            f"--temperature was given {len(temperatures)} times for {files} files; give it once "
            "for all of them, or once for each, in their order"
        )
    values = list(temperatures) * (files if len(temperatures) == 1 else 1)
    resolved_specimen = specimen or Specimen()
    return tuple(replace(resolved_specimen, temperature=kelvin) for kelvin in values)
