"""Relaxation test of a material: strain and stress over time."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass, field
from dashpot.base.arrays import (
    EqualByValue,
    FloatArray,
    convert_arrays_to_si,
    make_units_field,
    validate_measured_fields,
)
from dashpot.base.provenance import Source, describe_record_source
from dashpot.base.result_mixins import HasSummary, Series, collect_arrays
from dashpot.base.serialisation import Serialisable
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.datamodel.specimen import Specimen

UNIT_LENGTH, UNIT_AREA = 1e-3, 1e-6
"""Length, m, and area, m^2, of the unit specimen that represents strain and stress in a fit."""


@dataclass(frozen=True, eq=False, repr=False)
class StressRelaxationTest(EqualByValue, HasSummary, Serialisable):
    """Relaxation test of a material as recorded: strain ramped and held, stress measured.

    Attributes
    ----------
    time : array, shape (n,)
        s, strictly increasing; any sampling.
    strain : array, shape (n,)
        Change of length over length, sign and zero as recorded.
    stress : array, shape (n,)
        Pa, sign and zero as recorded.
    specimen : Specimen
    source : Source or None
    units : str
        Units of the arrays, in their order: ``"s, %, MPa"``, or ``"SI"``. Stored in SI.

    Raises
    ------
    DataError
        If the arrays differ in length, hold fewer than 8 samples, are not finite, or time stalls.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> t = np.linspace(0, 10, 50)
    >>> test = StressRelaxationTest(t, 10 + 0 * t, 2 - t / 20, units="s, %, MPa")
    >>> float(test.strain[0]), float(test.stress[0])
    (0.1, 2000000.0)
    """

    schema = "dashpot/stress-relaxation-test@1"

    time: FloatArray
    strain: FloatArray
    stress: FloatArray
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None
    units: str = make_units_field()

    def __post_init__(self) -> None:
        convert_arrays_to_si(self, time="time", strain="strain", stress="stress")
        validate_measured_fields(self, "time", "strain", "stress", minimum=8)

    def make_unit_specimen_test(self) -> RelaxationTest:
        """Return the test of a specimen of 1 mm by 1 mm^2: 1 N/mm of it is 1 MPa."""
        return RelaxationTest(
            self.time, UNIT_LENGTH * self.strain, UNIT_AREA * self.stress, self.specimen,
            self.source, units="SI",
        )  # fmt: skip

    @property
    def _table_columns(self) -> Series:
        """Strain and stress over time."""
        return collect_arrays(self, time="s", strain="1", stress="Pa")

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the record and its range."""
        return (
            describe_record_source(self.source, len(self.time)),
            (
                f"{np.ptp(self.time):.5g} s; strain spans {100 * np.ptp(self.strain):.4g} %, "
                f"stress {np.ptp(self.stress) / 1e6:.4g} MPa"
            ),
        )
