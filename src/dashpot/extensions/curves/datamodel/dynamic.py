"""Dynamic (DMA) tests: storage and loss against frequency."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass, field, replace
from dashpot.base.arrays import (
    BoolArray,
    ComplexArray,
    Dimensions,
    EqualByValue,
    FloatArray,
    IndexArray,
    convert_arrays_to_si,
    make_units_field,
    resolve_unit,
    validate_measured_fields,
)
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source, describe_record_source
from dashpot.base.result_mixins import HasSummary, Series, collect_arrays
from dashpot.base.serialisation import Serialisable
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.specimen import Specimen, tested_at
from dashpot.extensions.curves.datamodel.sample_temperatures import (
    find_near_samples,
    format_temperature_range,
    has_several_temperatures,
)


@dataclass(frozen=True, eq=False, repr=False)
class DynamicTest(EqualByValue, HasSummary, Serialisable):
    r"""Storage and loss, measured under harmonic motion.

    :math:`K^*(\omega) = K'(\omega) + j K''(\omega)` with x(t) = Re X e^{+j omega t}: a positive
    loss is dissipation.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz, > 0; in the order of the file, a sweep repeated at each temperature.
    storage, loss : array, shape (n,)
        Pa for a material, N/m for a part (`unit`).
    temperature : array, shape (n,), or None
        K.
    unit : str
        ``"Pa"`` or ``"N/m"``.
    specimen : Specimen
    source : Source or None
    units : str
        Units of the arrays, in their order: ``"s, mm, N"``, or ``"SI"``. Stored in SI.

    Raises
    ------
    DataError
        If the arrays differ in length, are not finite, or a frequency is not above 0.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> t = np.linspace(0, 10, 50)
    >>> sweep = dp.DynamicTest(frequency=1 + t, storage=2 + t, loss=1 + t, units="Hz, MPa, MPa")
    >>> sweep.unit, float(sweep.storage[0])
    ('Pa', 2000000.0)
    """

    schema = "dashpot/dynamic-test@1"

    frequency: FloatArray
    storage: FloatArray
    loss: FloatArray
    temperature: FloatArray | None = None
    unit: str = "Pa"
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None
    units: str = make_units_field()

    def __post_init__(self) -> None:
        dimensions: Dimensions = ("stress", "stiffness")
        arrays = convert_arrays_to_si(
            self,
            frequency="frequency",
            storage=dimensions,
            loss=dimensions,
            temperature="temperature",
        )
        resolve_unit(self, arrays, "storage", "loss")
        validate_measured_fields(self, "frequency", "storage", "loss", "temperature")
        if self.temperature is not None:
            tested_at("temperature", self.temperature.min(), self.temperature.max())
        bad_indices = np.flatnonzero(self.frequency <= 0)
        if bad_indices.size:
            i = int(bad_indices[0])
            raise DataError(f"frequency[{i}] = {self.frequency[i]:g} Hz; expected > 0")
        if self.unit not in {"Pa", "N/m"}:
            raise DataError(f"unit '{self.unit}' of storage and loss; expected 'Pa' or 'N/m'")

    @property
    def _table_columns(self) -> Series:
        """Storage and loss over frequency."""
        return collect_arrays(
            self, frequency="Hz", storage=self.unit, loss=self.unit, temperature="K"
        )

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the sweep and its range."""
        return (
            describe_record_source(self.source, len(self.frequency)),
            (
                f"storage and loss in {self.unit}, {self.frequency.min():.4g} to "
                f"{self.frequency.max():.4g} Hz{format_temperature_range(self.temperature)}"
            ),
        )

    def only(self, chosen: BoolArray | IndexArray) -> DynamicTest:
        """Return the chosen samples, in the order given."""
        return replace(
            self,
            frequency=self.frequency[chosen],
            storage=self.storage[chosen],
            loss=self.loss[chosen],
            temperature=None if self.temperature is None else self.temperature[chosen],
        )

    def select_temperature(self, temperature: Quantity) -> DynamicTest:
        """Return the samples within a kelvin of a temperature, K.

        Raises
        ------
        DataError
            If there are none.
        """
        kelvin = convert_to_si(temperature, "temperature")
        selected_test = self.only(find_near_samples(self.temperature, kelvin))
        return replace(selected_test, specimen=replace(self.specimen, temperature=kelvin))

    @property
    def several_temperatures(self) -> bool:
        """Whether the sweeps differ too much in temperature for one solid."""
        return has_several_temperatures(self.temperature)

    @property
    def omega(self) -> FloatArray:
        """Angular frequency, rad/s."""
        return 2 * np.pi * self.frequency

    @property
    def value(self) -> ComplexArray:
        """Complex modulus or stiffness, in `unit`."""
        return np.asarray(self.storage + 1j * self.loss, dtype=complex)

    @property
    def loss_factor(self) -> FloatArray:
        """Loss over storage."""
        return self.loss / self.storage
