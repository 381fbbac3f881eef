"""Relaxation modulus over time: response to a unit step."""

from __future__ import annotations

from dashpot.base import dataclass, field
from dashpot.base.arrays import (
    Dimensions,
    EqualByValue,
    FloatArray,
    convert_arrays_to_si,
    make_units_field,
    resolve_unit,
)
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source
from dashpot.base.result_mixins import HasSummary, Series, collect_arrays
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.curves.datamodel.sample_temperatures import (
    describe_step_response,
    has_several_temperatures,
    select_temperature,
    validate_step_response,
)


@dataclass(frozen=True, eq=False, repr=False)
class RelaxationModulus(EqualByValue, HasSummary):
    r"""Relaxation modulus :math:`E(t)`, measured or superposed, after a step at t = 0.

    Attributes
    ----------
    time : array, shape (n,)
        s since the step, >= 0, strictly increasing; at several temperatures in any order.
    modulus : array, shape (n,)
        Pa for a material, N/m for a part (`unit`).
    temperature : array, shape (n,), or None
        K, where the curve was measured at several; to be shifted together.
    unit : str
        ``"Pa"`` or ``"N/m"``.
    specimen : Specimen
    source : Source or None
    units : str
        Units of the arrays, in their order: ``"s, mm, N"``, or ``"SI"``. Stored in SI.

    Raises
    ------
    DataError
        If the arrays differ in length, are not finite, or time falls or starts below 0.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> t = np.linspace(0, 10, 50)
    >>> dp.RelaxationModulus(time=t, modulus=2 - t / 20, units="s, MPa").unit
    'Pa'
    """

    time: FloatArray
    modulus: FloatArray
    unit: str = "Pa"
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None
    temperature: FloatArray | None = None
    units: str = make_units_field()

    def __post_init__(self) -> None:
        dimensions: Dimensions = ("stress", "stiffness")
        resolve_unit(
            self,
            convert_arrays_to_si(self, time="time", modulus=dimensions, temperature="temperature"),
            "modulus",
        )
        validate_step_response(self, "modulus")
        if self.unit not in {"Pa", "N/m"}:
            raise DataError(f"unit '{self.unit}' of the modulus; expected 'Pa' or 'N/m'")

    def select_temperature(self, temperature: Quantity) -> RelaxationModulus:
        """Return the samples within a kelvin of a temperature, K, in order of time.

        Raises
        ------
        DataError
            If there are none, or two at the same time.
        """
        return select_temperature(self, "modulus", convert_to_si(temperature, "temperature"))

    @property
    def several_temperatures(self) -> bool:
        """Whether the samples differ too much in temperature for one solid."""
        return has_several_temperatures(self.temperature)

    @property
    def _table_columns(self) -> Series:
        """Modulus over time."""
        return collect_arrays(self, time="s", modulus=self.unit, temperature="K")

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the curve and its range."""
        return describe_step_response(self, "modulus")
