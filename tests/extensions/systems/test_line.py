"""A seal line that holds its door sideways too: numbers that were computed apart.

The door, its hinges and its line are stated in full; stiffness and modes are of K' at 12.71 Hz of
the published seal, 331.727 N/m for 50 mm.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from kit import shell
from kit.doors import (
    ACROSS,
    ALONG,
    CENTRE,
    FREE,
    INERTIA,
    KAPPA,
    MASS,
    NORMAL_ONLY,
    SHEARED,
    close_outline,
    compute_largest_difference,
    leaning,
    parse_matrix,
    six_by_six,
)
from kit.fits import a_fit

from dashpot.base.errors import DataError
from dashpot.datamodel.seal_line import LineFriction, SealSection, Shear
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.systems.door.assembly import Assembly
from dashpot.extensions.systems.door.checks import lateral_restraint_present
from dashpot.extensions.systems.door.door_model import Door, RigidPart, SealChoice, Support
from dashpot.extensions.systems.door.modes import count_lateral_free_motions
from dashpot.extensions.systems.door.mounts import make_line_mounts
from dashpot.extensions.systems.door.read import read_door
from dashpot.extensions.systems.door.seal_line import Joint, SealLine
from dashpot.extensions.systems.level_response import response_at_level
from dashpot.extensions.systems.multibody import Body, System, planar_body
from dashpot.extensions.systems.time_response import complex_modes
from dashpot.solids import networks as net
from dashpot.solids.demo_seals import PAPER
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.workflow.json_archive import to_json


def line(shear: Shear = Shear()) -> SealLine:  # noqa: B008
    """Tilted outwards by 15 degrees in the plane of the door."""
    section = SealSection(net.spring(KAPPA), shear=shear)
    return SealLine(close_outline(), normal=leaning(), section=section)


SHEAR = Shear(ACROSS, ALONG)
DOOR = RigidPart(MASS, INERTIA, CENTRE)
HELD = Door(
    rigid=DOOR,
    hinges=(
        Support("lower", (0.0, 0.0, 0.30), (2e6,) * 3),
        Support("upper", (0.0, 0.0, 0.90), (2e6,) * 3),
    ),
    latch=Support("latch", (1.10, 0.0, 0.60), (1e6,) * 3),
    line=line(),
    seal=SealChoice("", pitch=0.05),
)
ON_ITS_SEAL = replace(HELD, hinges=(), latch=None)


def stiffness(seal: SealLine, pitch: float) -> np.ndarray:
    stations = seal.stations(pitch)
    return sum(
        six_by_six(stations.place, way.direction, way.solid.k_inf * way.share)
        for way in seal.section.ways(stations)
    )


@pytest.mark.parametrize("pitch", [0.05, 0.0237, 0.5])
@pytest.mark.parametrize(("shear", "words"), [(SHEAR, SHEARED), (Shear(), NORMAL_ONLY)])
def test_the_line_is_its_integral_at_any_pitch(pitch, shear, words):
    K = stiffness(line(shear), pitch)
    assert compute_largest_difference(K, parse_matrix(words)) < 2e-10  # the digits that are stated
    assert compute_largest_difference(K, stiffness(line(shear), 0.01)) < 1e-12


@pytest.mark.parametrize("pitch", [0.01, 0.023, 0.11, 0.5])
def test_a_line_that_lifts_off_is_the_integral_of_what_touches(pitch):
    """From -2 to 6 mm of compression over 1 m and back: the last three quarters touch."""
    section = SealSection(net.spring(KAPPA), shear=SHEAR)
    for pressed, first, last in ((np.array([-2e-3, 6e-3]), 0.25, 1.0), ([6e-3, -2e-3], 0.0, 0.75)):
        seal = SealLine([(0, 0, 0), (1, 0, 0)], pressed, section, normal=(0, 1, 0))
        mounts = seal.mounts("door", pitch)
        for power in range(4):
            whole = sum(mount.solid.k_inf * mount.at[0] ** power for mount in mounts)
            exact = (last ** (power + 1) - first ** (power + 1)) / (power + 1)
            assert whole == pytest.approx(KAPPA * (1 + ACROSS + ALONG) * exact, rel=1e-12)


@pytest.mark.parametrize(
    ("door", "shear", "hertz"),
    [
        (HELD, SHEAR, [53.4363647, 53.5562004, 55.4968630, 71.2289507, 104.1026325, 132.6740936]),
        (HELD, Shear(),
         [53.4303595, 53.4976812, 55.4883656, 71.1829604, 104.0637895, 132.6703242]),
        (ON_ITS_SEAL, SHEAR, FREE),
    ],
)  # fmt: skip
def test_the_modes_of_the_door(door, shear, hertz):
    assembly = Assembly(replace(door, line=line(shear)))
    frequencies = [mode.frequency for mode in complex_modes(assembly.system())]
    assert frequencies == pytest.approx(hertz, rel=2e-8)


def test_line_check_reports_unsupported_lateral_motion():
    """Of a line tilted by 15 degrees: .354, .456 and .808 Hz, which no door has."""
    count, slowest = count_lateral_free_motions(Assembly(ON_ITS_SEAL))
    assert count == 3
    assert slowest == pytest.approx(0.354, abs=5e-4)
    finding = lateral_restraint_present(count, slowest)
    assert finding.failed
    assert "In-plane motion is held by nothing" in finding.message
    assert "3 motions are free from 0.354 Hz" in finding.message
    assert count_lateral_free_motions(Assembly(HELD)) == (0, None)
    flat = replace(line(), normal=np.array([0.0, 1.0, 0.0]))
    assert count_lateral_free_motions(Assembly(replace(ON_ITS_SEAL, line=flat))) == (3, None)


@pytest.mark.parametrize(("degrees", "free"), [(26.5, 2), (26.7, 0)])
def test_a_line_that_leans_far_enough_holds_its_door_in_plane(degrees, free):
    """Half of a square that leans by 26.57 degrees carries a tenth of it either way."""
    ring = [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1), (0, 0, 0)]
    out = np.array([(0, 0, -1), (1, 0, 0), (0, 0, 1), (-1, 0, 0)])
    a = np.radians(degrees)
    normal = np.cos(a) * np.array([0, 1, 0]) + np.sin(a) * out
    seal = SealLine(ring, normal=normal, section=net.spring(KAPPA))
    slides = replace(DOOR, centre=(0.5, 0.0, 0.5), motions=("x", "z"))
    count, _ = count_lateral_free_motions(Assembly(replace(ON_ITS_SEAL, rigid=slides, line=seal)))
    assert count == free


# -- a block on two seals -------------------------------------------------------------------------

R = {
    0.0: [(12.709749460, 0.004435030), (16.868934038, 0.003341906)],
    0.2: [(5.594584735, 0.010064699), (12.709749460, 0.004435030), (17.133439323, 0.003290328)],
    0.35: [(7.300285044, 0.007717325), (12.709749460, 0.004435030), (17.372305049, 0.003245099)],
    1.0: [(11.338184274, 0.004971201), (12.709749460, 0.004435030), (18.909358572, 0.002981384)],
}
SHEAR_MODES = [
    (7.951822950, 0.008674566),
    (12.709749460, 0.004435030),
    (17.499793618, 0.003292172),
]
"""Arms half as stiff again across, at a ratio of .35: roots of the determinant, found apart."""
FIRMER = GeneralizedMaxwell(PAPER.k_inf, tuple(1.5 * k for k in PAPER.k), PAPER.tau)


def block(shear: Shear) -> System:
    """On two pieces of seal of 50 mm, 15 mm below its centre and 40 mm to either side."""
    mass = 0.1040426
    body = planar_body("block", mass, mass * (0.1**2 + 0.03**2) / 12)
    section = SealSection(20 * PAPER, shear=shear)
    mounts = [
        mount
        for x in (-0.04, 0.04)
        for mount in SealLine(
            [(x, -0.015, -0.025), (x, -0.015, 0.025)], normal=(0, 1, 0), section=section
        ).mounts("block", "25mm")
    ]
    return System((body,), tuple(mounts))


@pytest.mark.parametrize(
    ("shear", "expected"),
    [*((Shear(ratio), expected) for ratio, expected in R.items()),
     (Shear(20 * 0.35 * FIRMER), SHEAR_MODES)],
)  # fmt: skip
def test_a_block_on_two_seals_with_shear(shear, expected):
    """The nonlinear eigenproblem, solved apart; the last with arms of its own across."""
    result = [mode for mode in complex_modes(block(shear)) if mode.oscillates]
    assert [mode.frequency for mode in result] == pytest.approx([f for f, _ in expected], rel=1e-6)
    damped = [mode.damping_ratio for mode in result]
    assert damped == pytest.approx([zeta for _, zeta in expected], rel=1e-5)


# -- friction ------------------------------------------------------------------------------------

PRESSED = 0.006


def compute_friction(mu: float, across: float, shear: Shear = SHEAR) -> tuple[SealLine, ...]:
    """The two pieces of 50 mm of the block, pressed by 6 mm: 1.179 N each."""
    section = SealSection(20 * PAPER, shear=shear, friction=LineFriction(mu, across=across))
    return tuple(
        SealLine([(x, 0, -0.025), (x, 0, 0.025)], PRESSED, section, normal=(0, 1, 0))
        for x in (-0.04, 0.04)
    )


def test_a_pressed_seal_sticks_by_coulombs_law():
    """mu .4: .4716 N for 50 mm; with 0.35 of K' at 12.71 Hz it sticks up to 4.06 mm."""
    kt = 0.35 * 0.05 * KAPPA
    mounts = compute_friction(0.4, kt / PAPER.k_inf)[0].mounts("block", "25mm")
    rubs = [mount.friction for mount in mounts if mount.friction is not None]
    assert sum(item.slip for item in rubs) == pytest.approx(0.4716)
    assert sum(item.k for item in rubs) == pytest.approx(kt)
    assert rubs[0].yields_at == pytest.approx(4.06e-3, abs=2e-6)
    joint = replace(compute_friction(0.4, 0.5)[0], joints=(Joint(0.025, 0.05, 2.0),))
    rubs = [mount.friction for mount in joint.mounts("block", "25mm") if mount.friction]
    assert sum(item.slip for item in rubs) == pytest.approx(2 * 0.4716)


@pytest.mark.parametrize(
    ("newton", "hertz", "metres"),
    [
        # at its peak: sticking, slipping more and more, and at last as if nothing rubbed
        (1e-4, 8.4338370, 0.322462776e-4), (0.01, 8.3019159, 0.0632609e-2),
        (0.03, 7.8084319, 0.048651225 * 0.03), (0.1, 7.5255394, 0.018092495),
        (0.5, 7.5181938, 0.265668566 / 2),
        # which a march in time met within a thousandth
        (0.1, 9.0, 1.238823e-3), (0.03, 8.0, 1.287151e-3),
    ],
)  # fmt: skip
def test_a_block_that_slips_across_its_seals(newton, hertz, metres):
    """Jenkins elements of 60 N/m and .03 N in all, by the first harmonic, computed apart."""
    mu = 0.015 / (PAPER.k_inf * PRESSED)
    mounts = [
        mount
        for line in compute_friction(mu, 30 / PAPER.k_inf)
        for mount in line.mounts("block", "25mm")
    ]  # fmt: skip
    block = System((Body("block", 0.1040426, free=("x",)),), tuple(mounts))
    level_response = response_at_level(
        block, response="block.x", force="block.x", level=newton, frequency=[hertz]
    )
    assert abs(level_response.motion[0]) == pytest.approx(metres, rel=1e-6)


def test_a_seal_that_sticks_is_a_spring_more():
    mounts = compute_friction(0.4, 0.2)[0].mounts("block", "25mm")
    stuck = make_line_mounts(compute_friction(0.4, 0.2)[0], "block", "25mm", friction_sticks=True)
    assert len(stuck) == len(mounts) + 2
    assert not any(item.friction for item in stuck)
    across = [item.solid.k_inf for item in stuck if abs(item.along[0]) > 0.5]
    assert sum(across) == pytest.approx((0.35 + 0.2) * PAPER.k_inf)


@pytest.mark.parametrize(
    ("made", "sentence"),
    [
        (lambda: LineFriction(0.0, 0.1), "mu = 0; expected more than 0 and at most 3"),
        (lambda: LineFriction(3.01, 0.1), "mu = 3.01; expected more than 0 and at most 3"),
        (lambda: LineFriction(0.4, 3.1), "friction: across = 3.1; expected 0 to 3"),
        (lambda: LineFriction(0.4), "neither across nor along is given"),
        (
            lambda: compute_friction(0.4, 0.2, Shear(0.0, 0.1)),
            "rubs across the line, where the seal has no",
        ),
        (
            lambda: replace(compute_friction(0.4, 0.2)[0], compression=None).mounts(
                "block", "25mm"
            ),
            "follows from the force by which it is pressed",
        ),
    ],
)
def test_what_friction_cannot_be(made, sentence):
    assert LineFriction(3.0, 3.0).mu == 3.0
    with pytest.raises(DataError, match=sentence):
        made()


# -- its file -------------------------------------------------------------------------------------

FILE = """
[door]
mass = "25kg"
centre = "0.55, 0, 0.6 m"
inertia = "3.0, 5.5, 2.5 kg*m^2"
[seal]
fit = "fit.json"
points = ["50, 0, 50 mm", "1050, 0, 50 mm", "1050, 0, 750 mm", "750, 0, 1150 mm", "50, 0, 1150 mm"]
closed = true
normal = [0, 1, 0]
tilt = "15deg"
pitch = "50mm"
[seal.shear]
across = 0.35
along = 0.15
"""


@pytest.fixture
def folder(tmp_path):
    specimen = Specimen(length=0.05, temperature=296.15)
    for name, scale in (("fit", 1.0), ("side", 0.35)):
        spring = GeneralizedMaxwell(scale * 0.05 * KAPPA)
        fit = a_fit(spring, specimen=specimen, band=(1e-3, 1e3))
        (tmp_path / f"{name}.json").write_text(to_json(fit))
    (tmp_path / "door.toml").write_text(FILE)
    return tmp_path


@pytest.mark.parametrize("backwards", [False, True])
def test_a_tilt_leans_outwards_whichever_way_the_line_runs(folder, backwards):
    text = FILE
    if backwards:
        head, _, tail = text.partition('points = ["')
        points, _, tail = tail.partition('"]')
        text = f'{head}points = ["{chr(34).join(points.split(chr(34))[::-1])}"]{tail}'
    (folder / "door.toml").write_text(text)
    seal = replace(read_door(folder / "door.toml").line, section=line(SHEAR).section)
    assert compute_largest_difference(stiffness(seal, 0.05), parse_matrix(SHEARED)) < 2e-10


@pytest.mark.parametrize(("high", "informed"), [(1e3, True), (6.0, False)])
def test_lateral_fit_is_valid_only_in_its_band(folder, high, informed):
    """What the test across does not inform is not known, however wide the other test is."""
    spring = GeneralizedMaxwell(0.35 * 0.05 * KAPPA)
    specimen = Specimen(length=0.05, temperature=296.15)
    fit = a_fit(spring, specimen=specimen, band=(1e-2, high))
    (folder / "side.json").write_text(to_json(fit))
    (folder / "door.toml").write_text(FILE.replace("across = 0.35", 'across = "side.json"'))
    result = shell.ran("predict", folder / "door.toml", "--json")
    checks = {check["name"]: check["passed"] for check in json.loads(result.stdout)["checks"]}
    assert checks["door_modes_in_valid_band"] is informed


@pytest.mark.parametrize("across", ["0.35", '"side.json"'])
def test_the_file_of_a_door_says_its_shear(folder, across):
    """As a ratio, or as a fit of its own: the modes are those of the stated door."""
    (folder / "door.toml").write_text(FILE.replace("across = 0.35", f"across = {across}"))
    result = shell.ran("predict", folder / "door.toml", "--json")
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    outcome = [mode["frequency_hz"] for mode in document["modes"]]
    assert outcome == pytest.approx(FREE, rel=1e-7)
    assert all(mode["shares"][0]["energy"] == pytest.approx(1) for mode in document["modes"])
    whole = 4.0 * KAPPA
    sideways = {"across": 0.35 * whole, "along": 0.15 * whole}
    assert document["seal"]["sideways"] == pytest.approx(sideways)
    assert "lateral_restraint_present" not in {check["name"] for check in document["checks"]}


def test_door_reports_a_seal_without_shear(folder):
    (folder / "door.toml").write_text(FILE.partition("[seal.shear]")[0])
    result = shell.ran("predict", folder / "door.toml")
    assert result.exit_code == 0, result.output
    text = " ".join(result.output.split())
    assert "n-plane motion is held by nothing: no shear is given, and 3 motions are free" in text
    assert "across and along in [seal.shear]" in text


def test_the_file_of_a_door_says_its_friction(folder):
    """Twice as stiff sideways as the stated door, with the range of sticking reported."""
    rubs = FILE.replace("across = 0.35", "across = 0.20").replace("along = 0.15", "along = 0.05")
    rubs += "[seal.friction]\nmu = 0.4\nacross = 0.15\nalong = 0.10\n"
    (folder / "door.toml").write_text(rubs.replace("pitch", 'compression = "6mm"\npitch'))
    result = shell.ran("predict", folder / "door.toml", "-o", folder / "door.json")
    assert result.exit_code == 0, result.output
    document = json.loads((folder / "door.json").read_text())
    assert [mode["frequency_hz"] for mode in document["modes"]] == pytest.approx(FREE, rel=1e-7)
    assert document["seal"]["slip_limit"] == pytest.approx(0.4 * 0.006 / 0.15)
    text = " ".join(result.output.split())
    assert "its friction sticks sideways up to 16.0 mm; the modes are of a seal that sticks" in text


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("[seal.shear]", "[seal.friction]\nacross = 0.1\n[seal.shear]", "mu is missing"),
        (
            "[seal.shear]",
            "[seal.friction]\nmu = 0.4\nacross = 0.1\n[seal.shear]",
            "its compression is not stated; give its compression, or gap and height",
        ),
        ("across = 0.35", "across = 35", r"\[seal\]: shear: across = 35; expected 0 to 3"),
        ("across = 0.35", "side = 0.35", r"\[seal.shear\]: 'side' is unknown; known are across"),
        ("across = 0.35", 'across = "none.json"', "none.json: there is no such file"),
        ("across = 0.35", 'across = "../side.json"', "lies outside the folder"),
        ("normal = [0, 1, 0]", "normal = [0, 0, 1]", "runs along its own normal from point 1 to 2"),
        ("15deg", "81deg", "tilt = 81 deg; expected at most 80 deg"),
        ("15deg", "15mm", "tilt = "),
    ],
)
def test_what_a_line_cannot_be(folder, old, new, sentence):
    assert old in FILE
    text = FILE.replace(old, new).replace('tilt = "15deg"\n', "" if "normal" in old else
                                          'tilt = "15deg"\n')  # fmt: skip
    (folder / "door.toml").write_text(text)
    result = shell.ran("predict", folder / "door.toml")
    assert result.exit_code == 2, result.output
    message = " ".join(result.output.split())
    assert re.search(sentence, message), message


def test_the_deck_of_a_door_has_its_shear(folder):
    words = ["export", folder / "fit.json", "--to", "calculix", "--unit-system", "SI", "--line",
             folder / "door.toml", "--nominal", "12.71Hz", "--first-id", "501"]  # fmt: skip
    result = shell.ran(*words)
    assert result.exit_code == 0, result.output
    assert "across it: 0.35 of it; along it: 0.15 of it" in result.stdout
    assert "nodes 501 to 660" in result.stdout
    (folder / "door.toml").write_text(FILE.replace("across = 0.35", 'across = "side.json"'))
    result = shell.ran(*words)
    assert "across it: a stiffness of its own" in result.stdout
    result = shell.ran(*words[:6], "--first-id", "501")
    assert result.exit_code == 2
    assert "add --line FILE" in result.output
    rubs = FILE + "[seal.friction]\nmu = 0.4\nacross = 0.1\n"
    (folder / "door.toml").write_text(rubs)
    result = shell.ran(*words)
    assert result.exit_code == 2
    assert "no deck of a line holds friction" in result.output
