"""The figure of a master curve: every sample by its temperature, and the shifts with their law."""

import numpy as np
import pytest
from kit.sweeps import moduli, sweeps

import dashpot as dp
from dashpot.extensions.curves.dynamic.fit import fit_dynamic
from dashpot.plot.picture import Area, Dots, Line, Tag
from dashpot.plot.style import COLOURS, SEQUENTIAL
from dashpot.workflow.dataframes import frame


@pytest.mark.parametrize(
    ("data", "panels"), [(sweeps(), 4), (moduli(), 3)], ids=["sweeps", "moduli"]
)
def test_every_sample_is_drawn_from_cold_to_warm(data, panels):
    master_curve = dp.solids.superpose(data)
    picture = master_curve.plot()
    assert len(picture.panels) == panels
    for panel in picture.panels[:-1]:
        dots = [mark for mark in panel.marks if isinstance(mark, Dots)]
        assert [mark.colour for mark in dots] == list(SEQUENTIAL)
        assert sum(len(mark.x) for mark in dots) == len(master_curve.temperature)
    # a temperature is named at its samples, once, and in no key
    tags = [mark for panel in picture.panels for mark in panel.marks if isinstance(mark, Tag)]
    assert [tag.text for tag in tags][:2] == ["−20 to −10 °C", "0 to 10 °C"]
    assert [tag.colour for tag in tags] == list(SEQUENTIAL)
    assert not {tag.text for tag in tags} & {item.label for item in picture.key}


def test_the_shifts_are_drawn_with_their_law_and_its_errors():
    master_curve = dp.solids.superpose(sweeps())
    marks = master_curve.plot().panels[-1].marks
    area, line, dots = (
        next(m for m in marks if isinstance(m, kind)) for kind in (Area, Line, Dots)
    )
    assert line.label == "WLF"
    assert dots.error == pytest.approx([2 * shift.se for shift in master_curve.temperatures.shifts])
    assert ((area.low <= line.y) & (line.y <= area.high)).all()
    free = dp.solids.superpose(sweeps(), law="free").plot().panels[-1]
    assert not any(isinstance(mark, Area) for mark in free.marks)


@pytest.mark.parametrize("data", [sweeps(), moduli()], ids=["sweeps", "moduli"])
def test_a_notebook_shows_it_and_a_table_holds_it(data):
    master_curve = dp.solids.superpose(data)
    assert "<svg" in master_curve._repr_html_()
    assert repr(master_curve).startswith(
        "Superposition: 9 temperatures, -20 degC to 60 degC, at 20 degC"
    )
    made = frame(master_curve)
    assert list(made.columns)[-1] == "temperature"
    assert {len(column) for column in made.columns.values()} == {len(master_curve.temperature)}


def test_master_curve_figure_spreads_colours_of_few_temperatures():
    master_curve = dp.solids.superpose(sweeps(temperatures=np.array([283.15, 293.15])))
    dots = [mark for mark in master_curve.plot().panels[0].marks if isinstance(mark, Dots)]
    assert [(mark.colour, mark.label) for mark in dots] == [
        ("coldest", "10 °C"),
        ("hottest", "20 °C"),
    ]


def test_a_fit_is_drawn_in_the_place_of_the_spectrum():
    data = sweeps()
    few = fit_dynamic(data, arms=3)
    lines = [
        next(mark for mark in picture.panels[0].marks if isinstance(mark, Line))
        for picture in (
            dp.solids.superpose(data).plot(),
            dp.plot.superposition(dp.solids.superpose(data), few),
        )
    ]
    assert [line.label for line in lines] == ["spectrum of all temperatures", "fit"]
    assert not np.allclose(lines[0].y, lines[1].y)


def light(colour: str) -> float:
    """Relative luminance, as WCAG has it."""
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [v / 12.92 if v <= 0.03928 else ((v + 0.055) / 1.055) ** 2.4 for v in parts]
    return float(np.dot((0.2126, 0.7152, 0.0722), linear))


@pytest.mark.parametrize("page", [0, 1], ids=["light", "dark"])
@pytest.mark.parametrize("name", SEQUENTIAL)
def test_temperature_colours_have_readable_contrast(name, page):
    low, high = sorted(light(COLOURS[item][page]) for item in (name, "panel"))
    assert (high + 0.05) / (low + 0.05) >= 4.5
