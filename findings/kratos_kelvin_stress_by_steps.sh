#!/usr/bin/env bash
# Kratos: a block of ViscousGeneralizedKelvin3D does not relax; its force is proportional to the time step.
#
# Expected: pressed within the first step and held, a viscoelastic block answers with the modulus E
#   at first, and relaxes with the relaxation time. A finer step comes nearer to that.
# Happens: the force stands still from the first step on, and the finer the step, the smaller it is:
#   after the same 3 s of the same motion a third with 30 steps of what 10 steps give, and towards
#   zero. All strain but a share of the size of a step is viscous at once.
#   ViscousGeneralizedMaxwell3D, beside it, relaxes and converges. No message; Newton converges in
#   each step.
# Matters: to one who takes the law by its name, a seal carries next to nothing, and a refinement in
#   time makes it softer still. Try a law on one element, at two steps, before the numbers of a
#   relaxation test go into it.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "KratosConstitutiveLawsApplication==10.4.4" \
    "KratosStructuralMechanicsApplication==10.4.4" "KratosMultiphysics==10.4.4" "numpy==2.2.6"
cd "$folder"
cat > block.py <<'PYTHON'
from importlib.metadata import version

import KratosMultiphysics as kratos

kratos.Logger.GetDefaultOutput().SetSeverity(kratos.Logger.Severity.WARNING)
import KratosMultiphysics.ConstitutiveLawsApplication as laws
import KratosMultiphysics.StructuralMechanicsApplication  # the element

MODULUS, STRAIN, TAU, SHARE = 1e6, 1e-3, 1.0, 0.5
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def stretch(law, steps, end=3.0):
    """Stress over E strain after each step, of a unit cube stretched in the first one and held."""
    model = kratos.Model()
    cube = model.CreateModelPart("cube")
    cube.ProcessInfo[kratos.DOMAIN_SIZE] = 3
    for variable in (kratos.DISPLACEMENT, kratos.REACTION, kratos.VOLUME_ACCELERATION):
        cube.AddNodalSolutionStepVariable(variable)
    cube.SetBufferSize(2)
    rubber = cube.CreateNewProperties(1)
    rubber[kratos.YOUNG_MODULUS], rubber[kratos.POISSON_RATIO], rubber[kratos.DENSITY] = MODULUS, 0.0, 1.0
    rubber[laws.DELAY_TIME], rubber[laws.VISCOUS_PARAMETER] = TAU, SHARE
    rubber[kratos.CONSTITUTIVE_LAW] = law()
    for number, corner in enumerate(CORNERS, 1):
        cube.CreateNewNode(number, *map(float, corner))
    cube.CreateNewElement("SmallDisplacementElement3D8N", 1, list(range(1, 9)), rubber)
    for axis in "XYZ":
        displacement = getattr(kratos, "DISPLACEMENT_" + axis)
        kratos.VariableUtils().AddDof(displacement, getattr(kratos, "REACTION_" + axis), cube)
        for node in cube.Nodes:
            if axis == "X" or getattr(node, axis + "0") == 0:
                node.Fix(displacement)
    strategy = kratos.ResidualBasedNewtonRaphsonStrategy(
        cube,
        kratos.ResidualBasedIncrementalUpdateStaticScheme(),
        kratos.DisplacementCriteria(1e-10, 1e-12),
        kratos.ResidualBasedBlockBuilderAndSolver(kratos.SkylineLUFactorizationSolver()),
        30, True, False, True,
    )
    strategy.SetEchoLevel(0)
    strategy.Initialize()
    course = []
    for step in range(1, steps + 1):
        cube.CloneTimeStep(step * end / steps)
        cube.ProcessInfo[kratos.STEP] = step
        for node in cube.Nodes:
            node.SetSolutionStepValue(kratos.DISPLACEMENT_X, STRAIN * node.X0)
        strategy.InitializeSolutionStep()
        strategy.Predict()
        assert strategy.SolveSolutionStep()
        strategy.FinalizeSolutionStep()
        force = sum(node.GetSolutionStepValue(kratos.REACTION_X) for node in cube.Nodes if node.X0 == 1)
        course.append(force / (MODULUS * STRAIN))
    return course



print("KratosConstitutiveLawsApplication", version("KratosConstitutiveLawsApplication"))
print("stress over E strain of a stretch that is held for 3 s; relaxation time 1 s")
found = {}
for law in (laws.ViscousGeneralizedMaxwell3D, laws.ViscousGeneralizedKelvin3D):
    for steps in (10, 30, 100, 1000):
        course = found[law.__name__, steps] = stretch(law, steps)
        print(f"{law.__name__:28} {steps:5} steps: first {course[0]:.5f}, last {course[-1]:.5f}")
for steps in (10, 30, 100, 1000):
    kelvin = found["ViscousGeneralizedKelvin3D", steps]
    assert max(kelvin) - min(kelvin) < 1e-9
    assert abs(kelvin[-1] * steps - 0.3) < 0.01
    maxwell = found["ViscousGeneralizedMaxwell3D", steps]
    assert maxwell[0] > 0.9 and abs(maxwell[-1] - 0.683) < 1e-3
PYTHON
venv/bin/python block.py | grep -E "^(Kratos[A-Z]|stress|Viscous)"
