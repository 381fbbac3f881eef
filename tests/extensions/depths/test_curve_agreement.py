"""Agreement of the relaxed force with a compression curve."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.extensions.depths.curve_agreement import compare_with_curve
from dashpot.solids.elastic import ElasticLaw


def test_the_paper_seal_agrees_with_its_compression_curve() -> None:
    law = ElasticLaw.linear(196.5, 8e-3)
    curve = np.linspace(0.0, 10e-3, 21)
    (agreement,) = compare_with_curve(law, [8e-3], displacement=curve, force=196.5 * curve)
    assert agreement.relaxed == pytest.approx(1.572)
    assert agreement.difference == pytest.approx(0.0, abs=1e-12)
    assert "1.572 N" in agreement.message


def test_a_curve_that_is_too_short_is_refused() -> None:
    with pytest.raises(DataError, match="does not reach the depth of 8 mm; measure it deeper"):
        compare_with_curve(
            ElasticLaw.linear(196.5, 8e-3), [8e-3], displacement=[0.0, 5e-3], force=[0.0, 1.0]
        )
