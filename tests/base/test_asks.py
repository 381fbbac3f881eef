"""Fields of the app's forms and the command-line options that they stand for."""

from __future__ import annotations

import pytest

from dashpot.base.errors import DataError
from dashpot.base.option_fields import FormField
from dashpot.extensions.app.kind_results import list_form_options, read_form
from dashpot.extensions.materials.options import require_quantity
from dashpot.extensions.materials.rod.app_form import get_density

MASS = FormField("mass", "Moving mass", "g", "--mass")
DENSITY = FormField("density", "Density", "kg/m^3", "--density", form="bare")
BETWEEN = FormField("between", "Asked between", "mm", "--compression-limits", form="range")
DISC = FormField("disc", "Diameter, length", "mm", "--shape", form="sizes", prefix="disc:")
SPEED = FormField("slam", "Speed or fall", "", "--drop", form="words")
MODE = FormField("test", "Kind of test", "", "--test", ("uniaxial", "biaxial"), per_file=True)


@pytest.mark.parametrize(
    ("ask", "typed", "words"),
    [
        (MASS, "114,8", ("114.8g",)),
        (MASS, "0.1 kg", ("0.1 kg",)),
        (DENSITY, "1100", ("1100",)),
        (BETWEEN, "4 to 8", ("4:8mm",)),
        (BETWEEN, "4-8", ("4:8mm",)),
        (DISC, "20, 12", ("disc:20mm,12mm",)),
        (SPEED, "0.3m/s 0.6m/s", ("0.3m/s", "0.6m/s")),
        (MASS, "", ()),
    ],
)
def test_a_field_is_an_option_of_the_shell(ask, typed, words):
    assert ask.words(ask.read(typed)) == words
    form_data = read_form((ask,), {ask.name: typed})
    options = list_form_options(form_data, 1)
    assert options == [word for item in words for word in (ask.flag, item)]


def test_per_file_form_field_has_a_choice_for_each_file():
    form_data = read_form((MODE,), {"test 1": "biaxial", "other": "1"})
    assert list_form_options(form_data, 2) == ["--test", "uniaxial", "--test", "biaxial"]


def test_form_data_converts_numbers_to_si_and_reports_missing_ones():
    form_data = read_form((MASS, BETWEEN, DENSITY), {"mass": "114,8", "between": "4 to 8"})
    assert form_data.number("mass", "mass") == pytest.approx(0.1148)
    assert form_data.range("between", "length") == pytest.approx((4e-3, 8e-3))
    assert get_density(form_data) is None
    assert get_density(read_form((DENSITY,), {"density": "1100"})) == 1100.0
    with pytest.raises(DataError, match="moving mass is not given: type it beside the files"):
        require_quantity(read_form((MASS,), {}), "mass", "mass")
    for typed in ("heavy", "1.1 g/cm3"):
        with pytest.raises(DataError, match=f"density is '{typed}'; expected a number of kg/m"):
            get_density(read_form((DENSITY,), {"density": typed}))
