"""From DOOR.toml to a door: what it says, and what it must not say."""

from __future__ import annotations

from pathlib import Path

import pytest

from dashpot.base.errors import ReadError
from dashpot.extensions.systems.door.closing_setup import ClosingSetup
from dashpot.extensions.systems.door.door_model import (
    DoorPoint,
    ModesChoice,
    RigidPart,
    SealChoice,
    Support,
)
from dashpot.extensions.systems.door.read import read_door
from dashpot.extensions.systems.door.seal_line import Joint

WHOLE = """
[door]
mass = "25kg"
width = "1.1m"
height = "1200mm"
centre = "0.55, 0.6, 0 m"
motions = ["z", "rx", "ry"]

[[hinge]]
at = "0, 300, 0 mm"
stiffness = "5kN/mm"

[[hinge]]
name = "upper"
at = ["0mm", "0.9m", "0mm"]
stiffness = "5, 6, 7 kN/mm"
damping = "10N*s/m"

[latch]
at = "1.1, 0.6, 0 m"
along = [0, 0, 1]
stiffness = "1kN/mm"

[[bumper]]
at = "1.1, 1.2, 0 m"
along = [0, 0, 1]
fit = "bumper.json"
compression = "2mm"

[seal]
fit = "fit.json"
length = "100mm"
temperature = "23degC"
points = ["0, 0, 0 mm", "1100, 0, 0 mm", "1100, 1200, 0 mm", "0, 1200, 0 mm"]
closed = true
height = "20mm"
gap = "14, 14, 15, 21 mm"
pitch = "25mm"

[[seal.joint]]
name = "corner"
at = "1.1m"
length = "60mm"
factor = 1.4

[modes]
file = "door.unv"
damping = 0.01
most = "200Hz"

[[point]]
name = "mirror"
at = "0.2, 1.1, 0 m"

[[point]]
at = "0, 0, 0 m"
along = [0, 1, 0]
on = "body"

[body]
mass = "1200kg"
inertia = "500, 2000, 2000 kg*m^2"
centre = "1, 0, 0 m"

[base]
psd = "0.01g^2/Hz"

[closing]
edge = "1m"
friction = "1.5N*m"
"""


def door_of(folder: Path, text: str):
    path = folder / "door.toml"
    path.write_text(text)
    return read_door(path)


def test_every_table_is_read(tmp_path):
    door = door_of(tmp_path, WHOLE)
    plate = (25 * 1.2**2 / 12, 25 * 1.1**2 / 12, 25 * (1.1**2 + 1.2**2) / 12)
    assert door.rigid == RigidPart(25.0, pytest.approx(plate), (0.55, 0.6, 0.0), ("z", "rx", "ry"))
    assert (door.width, door.height) == (1.1, 1.2)
    lower, upper = door.hinges
    assert lower == Support("hinge 1", (0.0, 0.3, 0.0), (5e6,) * 3)
    assert upper == Support("upper", (0.0, 0.9, 0.0), (5e6, 6e6, 7e6), (10.0,) * 3)
    assert door.latch == Support("latch", (1.1, 0.6, 0.0), (1e6,), along=(0.0, 0.0, 1.0))
    (bumper,) = door.bumpers
    assert (bumper.fit, bumper.compression) == (str(tmp_path / "bumper.json"), 0.002)
    assert door.seal == SealChoice(str(tmp_path / "fit.json"), 0.1, 296.15, 0.025)
    assert door.line.is_closed
    assert door.line.length == pytest.approx(4.6)
    assert door.line.compression == pytest.approx([6e-3, 6e-3, 5e-3, -1e-3, 6e-3])
    assert door.line.joints == (Joint(1.1, 0.06, 1.4, "corner"),)
    assert door.modes == ModesChoice(str(tmp_path / "door.unv"), damping=0.01, most=200.0)
    assert door.points == (
        DoorPoint("mirror", (0.2, 1.1, 0.0), (0.0, 0.0, 1.0)),
        DoorPoint("point 2", (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), "body"),
    )
    assert door.body.inertia == (500.0, 2000.0, 2000.0)
    assert door.base == "0.01g^2/Hz"
    assert door.closing == ClosingSetup(edge=1.0, friction=1.5)
    assert door.source.file == "door.toml"


LEAST = """
[door]
[seal]
fit = "fit.json"
points = "line.csv"
"""


@pytest.mark.parametrize(
    ("head", "unit"), [("x [mm],y [mm],z [mm],gap [mm],nx,ny,nz", ""), ("x,y,z,gap,nx,ny,nz", "mm")]
)
def test_the_line_may_stand_in_a_file(tmp_path, head, unit):
    """With a gap and a normal at each point, in the unit of its head or in the one stated."""
    rows = ["0,0,0,14,0,0,1", "1100,0,0,15,0,0,1", "1100,1200,0,16,0,0.6,0.8"]
    (tmp_path / "line.csv").write_text("\n".join([head, *rows, ""]))
    more = 'height = "20mm"\n' + (f'unit = "{unit}"\n' if unit else "")
    line = door_of(tmp_path, LEAST + more).line
    assert line.points.tolist() == [[0, 0, 0], [1.1, 0, 0], [1.1, 1.2, 0]]
    assert line.compression == pytest.approx([6e-3, 5e-3, 4e-3])
    assert line.normal[2] == pytest.approx([0, 0.6, 0.8])
    assert not line.is_closed


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("[closing]", "[closure]", r"\[closure\] is unknown; known are \[door\], \[hinge\]"),
        ("[door]", "[latch.x]\n[d]", "is unknown"),
        (
            "damping = 0.01",
            "loss = 0.01",
            "'loss' is unknown; known are file, unit, modal_mass, damping",
        ),
        ('mass = "25kg"', "mass = 25", r"\[door\]: mass = '25' has no unit"),
        ('mass = "25kg"', 'mass = "25m"', "'m' is a unit of length"),
        ('mass = "25kg"\n', "", None),
        ('height = "1200mm"\n', "", "inertia is missing: three moments"),
        ('"1200mm"', '"1200m"', r"height reaches 1200 m; .*is the unit mm"),
        ('"0, 300, 0 mm"', '"0, 300, 0 m"', r"\[hinge\] 1: at reaches 300 m"),
        ('"0, 300, 0 mm"', '"0, 300 mm"', "at has 2 numbers; expected three"),
        ('"0, 300, 0 mm"', '"0, 300, 0"', "has no unit"),
        ('stiffness = "5kN/mm"\n', "", "give its stiffness, or the fit"),
        ('"5, 6, 7 kN/mm"', '"5, 6 kN/mm"', r"\[hinge\] 2: 2 stiffnesses and 3 dampings"),
        ('fit = "bumper.json"', 'fit = "b.json"\nstiffness = "1N/m"', "one of both"),
        ('at = "0, 300, 0 mm"', "", "at is missing"),
        ("along = [0, 0, 1]\nfit", "fit", "along is missing"),
        ("along = [0, 0, 1]\nfit", "along = [0, 0]\nfit", "three numbers such as"),
        ('height = "20mm"\n', "", r"\[seal\]: height is missing: what the free seal stands tall"),
        ('gap = "14, 14, 15, 21 mm"', 'gap = "14, 15 mm"', "2 of gap for 4 points"),
        ('gap = "14, 14, 15, 21 mm"', 'gap = "14m"', "makes a compression of 13.98 m"),
        ("pitch", 'compression = "6mm"\npitch', "compression and gap say the same; keep one"),
        ('"1100, 0, 0 mm", "1100, 1200', '"1100, 1200', "4 of gap for 3 points"),
        ('"1100, 0, 0 mm"', '"-1100, 1200, 0 mm"', "the seal line crosses itself"),
        ('0, 0 mm", "1100, 0, 0 mm"', '0, 0 mm", "11, 0, 0 m"', None),
        ('"1100, 0, 0 mm"', '"1100, 0, 0 m"', "seal line is 2201 m long"),
        ("closed = true", "closed = 1", "expected true or false"),
        ('at = "1.1m"', 'at = "11m"', "corner, 0.06 m long at 11 m, is not on the seal line"),
        ("factor = 1.4", 'factor = "1.4"', "expected a number"),
        ("factor = 1.4", "", "factor is missing"),
        ('on = "body"', 'on = "roof"', "on = 'roof'; expected door or body"),
        ('name = "mirror"', 'name = "point 2"', "two points are called 'point 2'"),
        ('inertia = "500, 2000, 2000 kg*m^2"', "", "inertia is missing"),
        ('"500, 2000, 2000 kg*m^2"', '"500, 2000, 2000 kg"', "unit of moment of inertia"),
    ],
)
def test_what_a_door_must_not_say(tmp_path, old, new, sentence):
    assert old in WHOLE
    text = WHOLE.replace(old, new, 1)
    if sentence is None:
        door_of(tmp_path, text)
        return
    with pytest.raises(ReadError, match=sentence) as caught:
        door_of(tmp_path, text)
    assert str(caught.value).startswith("door.toml")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("[seal", "not TOML"),
        ("[body]\n", r"no \[door\] is in it"),
        ("door = 3\n", "is 3; expected a table"),
        ("[door]\nhinge = 3\n", "'hinge' is unknown"),
        ("hinge = 3\n[door]\n", "expected tables"),
        ("hinge = [3]\n[door]\n", "is 3; expected a table"),
    ],
)
def test_what_is_no_door(tmp_path, text, sentence):
    with pytest.raises(ReadError, match=sentence):
        door_of(tmp_path, text)


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("x [mm],y [mm]\n0,0\n1,1\n", "no column is named z"),
        ("x,y,z\n0,0,0\n1,1,1\n", r"column \w has no unit; write \w \[mm\]"),
        ("x [mm],y [mm],z [N]\n0,0,0\n1,1,1\n", "'N' is a unit of force"),
        ("x [mm],y [mm],z [mm],gap [mm],compression [mm]\n0,0,0,1,1\n1,1,1,1,1\n", "twice"),
    ],
)
def test_what_a_line_file_must_not_say(tmp_path, line, sentence):
    (tmp_path / "line.csv").write_text(line)
    with pytest.raises(ReadError, match=sentence):
        door_of(tmp_path, LEAST)


def test_a_line_file_that_is_missing_is_named(tmp_path):
    with pytest.raises(ReadError, match=r"line\.csv: there is no such file"):
        door_of(tmp_path, LEAST)


@pytest.mark.parametrize("word", ["/etc/passwd", "../fit.json", "a/../../fit.json"])
def test_a_door_opens_no_file_outside_its_folder(tmp_path, word):
    place = tmp_path / "door.toml"
    place.write_text(WHOLE.replace('fit = "fit.json"', f'fit = "{word}"'))
    with pytest.raises(ReadError, match="lies outside the folder of the door's file"):
        read_door(place)


def test_a_link_that_leads_out_is_outside(tmp_path):
    (tmp_path / "beside").mkdir()
    (tmp_path / "fit.json").write_text("{}")
    (tmp_path / "beside" / "fit.json").symlink_to(tmp_path / "fit.json")
    place = tmp_path / "beside" / "door.toml"
    place.write_text(WHOLE)
    with pytest.raises(ReadError, match="outside"):
        read_door(place)


@pytest.mark.parametrize(("count", "refused"), [(198, False), (199, True)])
def test_a_door_has_no_thousand_hinges(tmp_path, count, refused):
    more = '[[hinge]]\nat = "0, 300, 0 mm"\nstiffness = "5kN/mm"\n\n' * count
    place = tmp_path / "door.toml"
    place.write_text(WHOLE.replace("[latch]", more + "[latch]"))
    if not refused:
        assert len(read_door(place).hinges) == 200
        return
    with pytest.raises(ReadError, match="201 tables; expected at most 200"):
        read_door(place)


@pytest.mark.parametrize(("pitch", "refused"), [("0.3mm", False), ("0.1mm", True)])
def test_a_pitch_makes_no_thousand_stations_a_metre(tmp_path, pitch, refused):
    place = tmp_path / "door.toml"
    place.write_text(WHOLE.replace('pitch = "25mm"', f'pitch = "{pitch}"'))
    if not refused:
        assert read_door(place).seal.pitch == pytest.approx(3e-4)
        return
    with pytest.raises(ReadError, match="stations; expected at most 20000"):
        read_door(place)
