"""Every procedure of a solver under which a deck is run: ``python tests/kit/procedures.py`` writes
the table that headers and docs/export.md show.

Of a transient the deviation is the largest difference to the model over the peak; of an FRF the
largest relative one.
"""

from __future__ import annotations

import csv
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from scipy.signal import StateSpace, lsim

from dashpot.export import TARGETS
from dashpot.extensions.solver_inputs import procedures
from dashpot.extensions.solver_inputs.procedures import Run, read_runs
from dashpot.solids.maxwell import GeneralizedMaxwell
from kit.fmus import driven, integrate, simulate, write_fmu
from kit.solvers import receptance

ROOT = Path(__file__).parents[2]
TABLE = Path(procedures.__file__).with_name("runs.csv")
PAGE = ROOT / "docs" / "export.md"
MARK = ("<!-- runs: python tests/kit/procedures.py -->", "<!-- end of runs -->")

SEAL = GeneralizedMaxwell(196.5, (117.5, 17.8), (59 / 117.5, 292.2 / 17.8))
DAMPED = SEAL + GeneralizedMaxwell(0.0, b=20.0)
MASS = 0.05202
DEPTH = 8e-3
PULSE = ((0.0, 0.005, 0.01, 10.0), (0.0, 2.0, 0.0, 0.0))
PRESSED = "ramp and hold, 8 mm in 1 s, steps of 10 ms"
STRUCK = "pulse on a mass, 2 N for 10 ms on 52 g, steps of .1 ms"
FRF = "FRF, of 52 g, 1 to 30 Hz"
WITH_B = f"{PRESSED}, without two steps after each corner, {procedures.WITH_DASHPOT}"
STRUCK_WITH_B = f"{STRUCK}, {procedures.WITH_DASHPOT}"


def pressed_exactly(solid: GeneralizedMaxwell, t: np.ndarray) -> np.ndarray:
    return solid.ramp_hold_force(t, depth=DEPTH, ramp_time=1.0)


def struck_exactly(solid: GeneralizedMaxwell, t: np.ndarray) -> np.ndarray:
    """Displacement of the mass by SciPy's solution for a force of straight lines."""
    n = 2 + solid.arms
    A = np.zeros((n, n))
    A[0, 1], A[1] = 1.0, np.array([-solid.k_0, -solid.b, *solid.k]) / MASS
    A[2:, 0], A[2:, 2:] = 1 / np.array(solid.tau), -np.diag(1 / np.array(solid.tau))
    B = np.zeros((n, 1))
    B[1] = 1 / MASS
    system = StateSpace(A, B, np.eye(n)[:1], np.zeros((1, 1)))
    return np.squeeze(lsim(system, np.interp(t, *PULSE), t)[1])


# -- OpenSees --------------------------------------------------------------------------------------

SCRIPT = """
import json, sys
task = json.load(sys.stdin)
try:
    import openseespy.opensees as ops
except (ImportError, RuntimeError) as error:
    print(json.dumps({"missing": str(error)}))
    sys.exit()
ops.model("basic", "-ndm", 1, "-ndf", 1)
ops.node(1, 0.0)
ops.node(2, 0.0)
ops.fix(1, 1)
exec(task["deck"])
if task["material"]:
    ops.element("zeroLength", 1, 1, 2, "-mat", task["material"], "-dir", 1)
ops.timeSeries("Path", 1, "-time", *task["path"][0], "-values", *task["path"][1])
ops.pattern("Plain", 1, 1)
if task["mass"]:
    ops.mass(2, task["mass"])
    ops.load(2, 1.0)
    ops.constraints("Plain")
else:
    ops.sp(2, 1, 1.0)
    ops.constraints("Lagrange")
ops.numberer("Plain")
ops.system("FullGeneral")
ops.test("NormDispIncr", 1e-12, 30)
ops.algorithm("Newton")
ops.integrator(*task["integrator"])
ops.analysis(task["analysis"])
answer = []
for _ in range(task["steps"]):
    assert ops.analyze(*((1, task["dt"]) if task["analysis"] == "Transient" else (1,))) == 0
    if task["mass"]:
        answer.append(ops.nodeDisp(2, 1))
    else:
        each = [(e, ops.eleNodes(e)) for e in ops.getEleTags()]
        force = [ops.eleResponse(e, "material", 1, "stress")[0] for e, n in each if 2 in n]
        answer.append(sum(force))
print(json.dumps({"answer": answer}))
"""
INTEGRATORS = {
    "Newmark .5 .25": ("Newmark", 0.5, 0.25),
    "TRBDF2": ("TRBDF2",),
    "BackwardEuler": ("BackwardEuler", 0),
    "HHT .9": ("HHT", 0.9),
    "HHT .7": ("HHT", 0.7),
    "GeneralizedAlpha 1 .8": ("GeneralizedAlpha", 1.0, 0.8),
}
STATIC = "Static by LoadControl"
LOAD_CONTROL = ("LoadControl", 0.01)


class Missing(Exception):
    """The solver is not here."""


def run_opensees(form: str, procedure: str, case: str) -> float:
    solid = DAMPED if case.endswith(procedures.WITH_DASHPOT) else SEAL
    struck = case.startswith(STRUCK)
    dt, end = (1e-4, 0.5) if struck else (0.01, 5.0)
    t = dt * np.arange(1, round(end / dt) + 1)
    task = {
        "deck": TARGETS["opensees"](solid, units="SI", form=form),
        "material": 0 if form == "network" else 2 + solid.arms + (solid.b > 0),
        "mass": MASS if struck else 0.0, "dt": dt,
        "integrator": INTEGRATORS.get(procedure, LOAD_CONTROL),
        "analysis": "Transient" if procedure in INTEGRATORS else "Static",
        "path": PULSE if struck else ((0.0, 1.0, 1000.0), (0.0, DEPTH, DEPTH)), "steps": len(t),
    }  # fmt: skip
    run = subprocess.run(
        [os.environ.get("DASHPOT_OPENSEES", sys.executable), "-c", SCRIPT],
        input=json.dumps(task), capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    document = json.loads(next(line for line in run.stdout.splitlines() if line.startswith("{")))
    if "missing" in document:
        raise Missing(f"OpenSeesPy does not run here ({document['missing']})")
    answer = np.array(document["answer"])
    from_rest = np.insert(t, 0, 0.0)
    exact = struck_exactly(solid, from_rest)[1:] if struck else pressed_exactly(solid, t)
    error = np.abs(answer - exact)
    if case == WITH_B:
        error = error[(t > 2.5 * dt) & ~((t > 1 - dt / 2) & (t < 1 + 2.5 * dt))]
    return float(error.max() / np.abs(exact).max())


TCL = """
model basic -ndm 1 -ndf 1
node 1 0.0
node 2 0.0
fix 1 1
{deck}
{element}
timeSeries Path 1 -time {{0.0 1.0 1000.0}} -values {{0.0 {depth} {depth}}}
pattern Plain 1 1 {{ sp 2 1 1.0 }}
constraints Lagrange
numberer Plain
system FullGeneral
test NormDispIncr 1e-12 30
algorithm Newton
integrator {integrator}
analysis {analysis}
for {{set i 0}} {{$i < 500}} {{incr i}} {{
    if {{[analyze {step}] != 0}} {{ exit 1 }}
    set force 0.0
    foreach e {{{moving}}} {{ set force [expr {{$force + [eleResponse $e material 1 stress]}}] }}
    puts "force $force"
}}
"""


def run_tcl(form: str, procedure: str, case: str) -> float:
    """The interpreter of the package xara; DASHPOT_XARA names a Python that has it."""
    python = os.environ.get("DASHPOT_XARA", sys.executable)
    command = [python, "-c", "import opensees"]
    if subprocess.run(command, capture_output=True, check=False).returncode:
        raise Missing("xara is not installed: pip install xara, in an environment of its own")
    with tempfile.TemporaryDirectory() as name:
        script = Path(name) / "pressed.tcl"
        element = "element zeroLength 1 1 2 -mat 4 -dir 1" if form == "tcl" else ""
        integrator = " ".join(map(str, INTEGRATORS.get(procedure, LOAD_CONTROL)))
        analysis, step = ("Transient", "1 0.01") if procedure in INTEGRATORS else ("Static", "1")
        script.write_text(TCL.format(
            deck=TARGETS["opensees"](SEAL, units="SI", form=form), element=element, depth=DEPTH,
            integrator=integrator, analysis=analysis, step=step,
            moving="1" if form == "tcl" else "1 3 5",
        ))  # fmt: skip
        run = subprocess.run(
            [python, "-m", "opensees", str(script)], capture_output=True, text=True, timeout=300,
            check=False,
        )  # fmt: skip
    matches = re.findall(r"force (\S+)", run.stdout + run.stderr)
    assert len(matches) == 500, run.stderr[-2000:]
    exact = pressed_exactly(SEAL, 0.01 * np.arange(1, 501))
    return float(np.abs(np.array(matches, float) - exact).max() / exact.max())


# -- FMI -------------------------------------------------------------------------------------------

CO_SIMULATION = "Co-Simulation"
EXCHANGE = "Model Exchange with inputs at every derivative"
HELD = "Model Exchange by the CVode of FMPy"


def run_fmu(form: str, procedure: str, case: str) -> float:
    if find_spec("fmpy") is None or shutil.which("cc") is None:
        raise Missing("FMPy or a C compiler is missing: pip install dashpot[solvers]")
    struck = case == STRUCK
    dt, end = (1e-4, 0.5) if struck else (0.01, 5.0)
    t = dt * np.arange(round(end / dt) + 1)
    inputs = np.interp(t, *PULSE) if struck else np.minimum(t, 1.0) * DEPTH
    names = ("F", "F_rate") if struck else ("x", "v")
    with tempfile.TemporaryDirectory() as name:
        path = write_fmu(SEAL, form, Path(name), **({"mass": MASS} if struck else {}))
        if procedure == EXCHANGE:
            record = integrate(path, form, t, lambda time: (np.interp(time, t, inputs), 0.0), names)
        else:
            kind = "CoSimulation" if procedure == CO_SIMULATION else "ModelExchange"
            signal = driven(t, inputs, names)
            record = simulate(
                path, kind, input=signal, stop_time=end, output_interval=dt, relative_tolerance=1e-8
            )
    answer = np.asarray(record["x" if struck else "F"])[: len(t)]
    exact = struck_exactly(SEAL, t) if struck else pressed_exactly(SEAL, t)
    return float(np.abs(answer - exact).max() / np.abs(exact).max())


# -- CalculiX --------------------------------------------------------------------------------------


def ccx(deck: str) -> str:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "deck.inp").write_text(deck)
        try:
            run = subprocess.run(
                ["ccx", "-i", "deck"], cwd=folder, capture_output=True, text=True, timeout=300,
                check=False,
            )  # fmt: skip
        except FileNotFoundError as error:
            raise Missing("CalculiX is not installed: apt-get install calculix-ccx") from error
        assert run.returncode == 0, run.stdout[-2000:]
        return (folder / "deck.dat").read_text()


def read_printed(dat: str, block: str, node: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Times, and first components of a node, of the blocks of one kind."""
    time, result, wanted = [], [], False
    for line in dat.splitlines():
        if line.lstrip().startswith(("displacements", "forces")):
            wanted = line.lstrip().startswith(block)
            if wanted:
                time.append(float(line.split()[-1]))
        elif wanted and line.split()[:1] == [str(node)]:
            result.append(float(line.split()[1]))
    return np.array(time), np.array(result)


PRESS_STEPS = {
    "*DYNAMIC, DIRECT": ("*STEP, INC=1000", "*DYNAMIC, DIRECT", "0.01, 5."),
    "*DYNAMIC, DIRECT with NLGEOM": ("*STEP, NLGEOM, INC=1000", "*DYNAMIC, DIRECT", "0.01, 5."),
    "*DYNAMIC, DIRECT, ALPHA=-0.3": ("*STEP, INC=1000", "*DYNAMIC, DIRECT, ALPHA=-0.3", "0.01, 5."),
    "*DYNAMIC with automatic increments": ("*STEP, INC=10000", "*DYNAMIC", "0.01, 5."),
    "*STATIC": ("*STEP, INC=1000", "*STATIC, DIRECT", "0.01, 1."),
    "*STATIC with NLGEOM": ("*STEP, NLGEOM, INC=1000", "*STATIC, DIRECT", "0.01, 5."),
    "*VISCO": ("*STEP, INC=1000", "*VISCO, CETOL=1.e-3, DIRECT", "0.01, 1."),
    "*VISCO with NLGEOM": ("*STEP, NLGEOM, INC=1000", "*VISCO, CETOL=1.e-3, DIRECT", "0.01, 5."),
}


def press_calculix(form: str, procedure: str, case: str) -> float:
    deck = TARGETS["calculix"](SEAL, units="mm-t-s", form=form) + "\n".join([
        "*AMPLITUDE, NAME=RAMP", "0., 0., 1., 1., 1000., 1.", "*NSET, NSET=MOVING", "2",
        *PRESS_STEPS[procedure], "*BOUNDARY, AMPLITUDE=RAMP", "2, 1, 1, -8.",
        "*NODE PRINT, NSET=MOVING", "U, RF", "*END STEP", "",
    ])  # fmt: skip
    t, force = read_printed(ccx(deck), "forces")
    if len(t) == 1:  # a linear step is one increment: its end
        assert procedure in {"*STATIC", "*VISCO"}
        t = np.ones(1)
    exact = pressed_exactly(SEAL, t)
    return float(np.abs(-force - exact).max() / exact.max())


def shake_calculix(form: str, procedure: str, case: str) -> float:
    deck = TARGETS["calculix"](
        SEAL, units="SI", form=form, mass=MASS, frequency_range=(1.0, 30.0), points=200
    )
    f, u = receptance(ccx(deck), node=2)
    omega = 2 * np.pi * f
    exact = 1 / (SEAL.complex_stiffness(omega=omega) - MASS * omega**2)
    return float(np.abs(u / exact - 1).max())


def strike_calculix(form: str, procedure: str, case: str) -> float:
    """The modal step with the deck's own mass and dummies."""
    deck = TARGETS["calculix"](SEAL, units="SI", form=form, mass=MASS, frequency_range=(1.0, 30.0))
    head = deck[: deck.index("\n*STEP\n*STEADY STATE DYNAMICS") + 1]
    pulse = ", ".join(f"{value!r}" for pair in zip(*PULSE, strict=True) for value in pair)
    head = head.replace("*STEP\n", f"*AMPLITUDE, NAME=PULSE\n{pulse}\n*STEP\n", 1)
    deck = head + "\n".join([
        "*STEP, INC=100000", "*MODAL DYNAMIC", "1.e-4, 0.5", "*CLOAD, AMPLITUDE=PULSE", "2, 1, 1.",
        "*NODE PRINT, NSET=MOVING", "U", "*END STEP", "",
    ])  # fmt: skip
    t, displacement = read_printed(ccx(deck), "displacements")
    keep = t > 0
    t, displacement = t[keep], displacement[keep]
    grid = 1e-4 * np.arange(5001)
    exact = np.interp(t, grid, struck_exactly(SEAL, grid))
    return float(np.abs(displacement - exact).max() / np.abs(exact).max())


def find_ccx_version() -> str:
    try:
        run = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False)
    except FileNotFoundError as error:
        raise Missing("CalculiX is not installed: apt-get install calculix-ccx") from error
    return f"CalculiX {run.stdout.split()[-1]}"


# -- NASTRAN-95 ------------------------------------------------------------------------------------

SOL_8 = "SOL 8 direct frequency response in 32 bits"
SOL_9 = "SOL 9 direct transient response in 32 bits"
NASTRAN_RUN = """
import sys
from nastran95.runner import NastranRunner
print(NastranRunner().run(sys.stdin.read()).output)
"""
NASTRAN_CONTROL = """ID SEAL,ARMS
APP DISP
SOL {sol}
TIME 10
CEND
TITLE = MASS ON A SEAL
ECHO = NONE
SPC = 1
{of_loads}
DLOAD = 1
SET 1 = 2
OUTPUT
DISP({output}) = 1
BEGIN BULK
{bulk}
CMASS2  9001    {mass:<8}2       1
SPC1    1       123456  1
SPC1    1       23456   2
DAREA   1       2       1       1.
{loads}
ENDDATA
"""
FREQUENCIES = """FREQ1   1       1.      0.5     58
RLOAD1  1       1                       1
TABLED1 1                                                               +T
+T      0.      1.      1000.   1.      ENDT"""
INSTANTS = """TSTEP   1       5000    1.-4    10
TLOAD1  1       1                       1
TABLED1 1                                                               +T
+T      0.      0.      .005    2.      .01     0.      10.     0.      +U
+U      ENDT"""


def run_nastran(form: str, procedure: str, case: str) -> float:
    """A mass on the network by NASTRAN-95; DASHPOT_NASTRAN95 names a Python that has it."""
    python = os.environ.get("DASHPOT_NASTRAN95", sys.executable)
    if subprocess.run(
        [python, "-c", "import nastran95"], capture_output=True, check=False
    ).returncode:
        raise Missing("NASTRAN-95 is not installed: pip install nastran95, for Python 3.12")
    deck = TARGETS["nastran"](SEAL, units="SI", form=form)
    bulk = "\n".join(line for line in deck.splitlines() if line and line[0] != "$")
    shaken = procedure == SOL_8
    run = subprocess.run(
        [python, "-c", NASTRAN_RUN], capture_output=True, text=True, timeout=300, check=True,
        input=NASTRAN_CONTROL.format(
            sol=8 if shaken else 9, bulk=bulk, mass=MASS,
            of_loads="FREQ = 1" if shaken else "TSTEP = 1",
            output="SORT2,REAL" if shaken else "SORT2",
            loads=FREQUENCIES if shaken else INSTANTS,
        ),
    )  # fmt: skip
    if shaken:
        rows = re.findall(r"^0 *(\S+) +G +(\S+).*\n +(\S+)", run.stdout, flags=re.MULTILINE)
        f, real, imaginary = np.array(rows, dtype=float).T
        assert len(f) == 59, run.stdout[-2000:]
        omega = 2 * np.pi * f
        exact = 1 / (SEAL.complex_stiffness(omega=omega) - MASS * omega**2)
        return float(np.abs((real + 1j * imaginary) / exact - 1).max())
    rows = re.findall(r"^ +(\S+) +G +(\S+) ", run.stdout, flags=re.MULTILINE)
    t, displacement = np.array(rows, dtype=float).T
    assert len(t) == 501, run.stdout[-2000:]
    grid = 1e-4 * np.arange(5001)
    exact = struck_exactly(SEAL, grid)
    return float(np.abs(displacement - np.interp(t, grid, exact)).max() / np.abs(exact).max())


# -- FElupe ----------------------------------------------------------------------------------------

STRAIN_STEPS = "MaterialStrain, small strain"
SHEARED = "shear ramp and hold, .1 in 1 s, steps of 10 ms"
FELUPE_RUN = """
import json, sys
import numpy as np
deck, strains = json.load(sys.stdin)
exec(deck)
material = make_material(0.01)
state = np.zeros((material.x[-1].size, 1, 1))
stress = []
for strain in strains:
    F = np.eye(3)[:, :, None, None].copy()
    F[0, 1] = strain
    first, state = material.gradient([F, state])
    stress.append(float(first[0, 1, 0, 0]))
print(json.dumps(stress))
"""


def run_felupe(form: str, procedure: str, case: str) -> float:
    """Simple shear of the material; DASHPOT_FELUPE names a Python that has FElupe."""
    python = os.environ.get("DASHPOT_FELUPE", sys.executable)
    if subprocess.run([python, "-c", "import felupe"], capture_output=True, check=False).returncode:
        raise Missing("FElupe is not installed: pip install felupe, and set DASHPOT_FELUPE")
    G_0, t = 1e6, 0.01 * np.arange(1, 501)
    deck = TARGETS["felupe"](SEAL, units="SI", form=form, modulus=G_0)
    run = subprocess.run(
        [python, "-c", FELUPE_RUN], capture_output=True, text=True, timeout=120, check=True,
        input=json.dumps([str(deck), (0.1 * np.minimum(t, 1.0)).tolist()]),
    )  # fmt: skip
    exact = G_0 / SEAL.k_0 * SEAL.ramp_hold_force(t, depth=0.1, ramp_time=1.0)
    return float(np.abs(np.array(json.loads(run.stdout)) - exact).max() / exact.max())


# -- the table -------------------------------------------------------------------------------------

Measure = Callable[[str, str, str], float]
TASKS: dict[tuple[str, str, str, str], Measure] = {
    **{
        ("opensees", form, procedure, case): run_opensees
        for form in ("network", "python")
        for procedure in (*INTEGRATORS, STATIC)
        for case in (PRESSED, STRUCK, WITH_B, STRUCK_WITH_B)
        if procedure in INTEGRATORS or case in {PRESSED, WITH_B}
    },
    **{
        ("opensees", form, procedure, PRESSED): run_tcl
        for form in ("network-tcl", "tcl")
        for procedure in (*INTEGRATORS, STATIC)
    },
    **{
        ("fmu", form, procedure, case): run_fmu
        for form in ("fmi2", "fmi3")
        for procedure in (CO_SIMULATION, EXCHANGE)
        for case in (PRESSED, STRUCK)
    },
    **{("fmu", form, HELD, PRESSED): run_fmu for form in ("fmi2", "fmi3")},
    ("calculix", "arms", "*STEADY STATE DYNAMICS", FRF): shake_calculix,
    **{("calculix", "arms", procedure, PRESSED): press_calculix for procedure in PRESS_STEPS},
    ("calculix", "arms", "*MODAL DYNAMIC", STRUCK): strike_calculix,
    ("nastran", "arms", SOL_8, FRF): run_nastran,
    ("nastran", "arms", SOL_9, STRUCK): run_nastran,
    ("felupe", "prony", STRAIN_STEPS, SHEARED): run_felupe,
}


def measure(target: str, form: str, procedure: str, case: str) -> float:
    """Return the deviation of a task, which its solver runs now."""
    return TASKS[target, form, procedure, case](form, procedure, case)


def measure_all() -> list[Run]:
    solvers = {
        run_opensees: f"OpenSeesPy {version('openseespy')}", run_tcl: "OpenSees of xara 0.0.46",
        run_fmu: f"FMPy {version('fmpy')}", run_nastran: "NASTRAN-95 0.3",
        run_felupe: "FElupe 11.3.0",
    }  # fmt: skip
    runs = []
    for task, run_task in TASKS.items():
        target, form, procedure, case = task
        solver = solvers.get(run_task) or find_ccx_version()
        runs.append(Run(target, form, solver, procedure, case, measure(*task)))
        print(*runs[-1], flush=True)
    return runs


def format_matrix() -> str:
    """Return the table of docs/export.md."""
    rows = [
        "| Deck | Run by | Procedure | Case | Largest deviation | Result |",
        "|---|---|---|---|---|---|",
    ]
    for run in read_runs():
        word = "right" if run.is_right else "**wrong**"
        procedure = run.procedure.replace("*", "\\*")
        rows.append(
            f"| `{run.target}` `{run.form}` | {run.solver} | {procedure} | {run.case} | "
            f"{run.deviation:.1e} | {word} |"
        )
    return "\n".join(rows)


def place_matrix(page: str) -> str:
    """Return the page with the table between its marks."""
    before, rest = page.split(MARK[0])
    after = rest.split(MARK[1])[1]
    return f"{before}{MARK[0]}\n\n{format_matrix()}\n\n{MARK[1]}{after}"


def main() -> None:
    """Run everything, and write the table and the page."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(Run._fields)
    for run in measure_all():
        writer.writerow([*run[:-1], f"{run.deviation:.1e}"])
    TABLE.write_text(text.getvalue(), encoding="utf-8")
    read_runs.cache_clear()
    PAGE.write_text(place_matrix(PAGE.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
