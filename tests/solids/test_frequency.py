"""A frequency is named: 12.71 Hz and 12.71 rad/s are two loss factors."""

import numpy as np
import pytest

from dashpot.solids.demo_seals import PAPER
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell

SOLIDS = (PAPER, FractionalZener(1.0, 2.0, 0.1, 0.5), PAPER + GeneralizedMaxwell(1.0, b=2.0))
NAMES = ("complex_stiffness", "storage", "loss", "loss_factor")


@pytest.mark.parametrize("solid", SOLIDS)
@pytest.mark.parametrize("name", NAMES)
def test_hertz_and_radians_are_named(solid, name):
    of = getattr(solid, name)
    at = of(omega=2 * np.pi * 12.71)
    assert of(frequency=12.71) == at
    assert of(frequency="12.71Hz") == at
    assert of(frequency="0.01271kHz") == pytest.approx(at, rel=1e-12)
    assert of(frequency=[1.0, 12.71])[1] == pytest.approx(at, rel=1e-12)
    assert of(omega=12.71) != at


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("bare", "named"),
    [((12.71,), {}), ((), {}), ((), {"frequency": 1.0, "omega": 1.0}), ((1.0,), {"omega": 1.0})],
)
def test_a_bare_number_is_refused(name, bare, named):
    with pytest.raises(TypeError, match="say frequency= in Hz or omega= in rad/s"):
        getattr(PAPER, name)(*bare, **named)


def test_another_unit_is_refused():
    with pytest.raises(ValueError, match="unit of length"):
        PAPER.loss_factor(frequency="12mm")
