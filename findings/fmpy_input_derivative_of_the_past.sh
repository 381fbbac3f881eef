#!/usr/bin/env bash
# FMPy: at a knot of the input the derivative that it sets is that of the piece that has just ended.
#
# Expected: simulate_fmu(set_input_derivatives=True) tells a co-simulation FMU, before the step from t to t + h,
#   how fast the input moves in that step. With knots at the communication points, the usual case, that is
#   the slope of the piece that begins at t, so x + dx/dt h is the next knot.
# Happens: the slope is that of the piece that ends at t, and 0 at the first point. The input is extrapolated
#   from the past: a triangle overshoots its tip, a ramp lags by a step at its beginning and goes on for one
#   after its end. A table whose knots differ from the communication points by rounding gets either.
#   (FMPy 0.3.32 has the same interpolation, but raises ValueError for one input: its array has nine places.)
# Matters: interpolating inputs is what makes co-simulation of a damper free of lag; so it has an error
#   of the second difference of the motion in its place, and its damping force comes a step late.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "FMPy==0.3.22" "numpy==2.2.6"
cd "$folder"
cat > slope.c <<'C'
#include <stddef.h>
typedef void *Instance; typedef const char *String; typedef const unsigned int *References;
static double x, slope, reached;            /* where the input is at the end of a step, as it is told */
String fmi2GetTypesPlatform(void) { return "default"; }
String fmi2GetVersion(void) { return "2.0"; }
Instance fmi2Instantiate(String a, int b, String c, String d, const void *e, int g, int h) { return &x; }
void fmi2FreeInstance(Instance c) {}
int fmi2SetReal(Instance c, References v, size_t n, const double *s) { if (n) x = s[0]; return 0; }
int fmi2GetReal(Instance c, References v, size_t n, double *s) {
    for (size_t i = 0; i < n; i++) s[i] = v[i] == 2 ? reached : v[i] == 3 ? slope : x;
    return 0;
}
int fmi2SetRealInputDerivatives(Instance c, References v, size_t n, const int *o, const double *s) {
    if (n) slope = s[0];
    return 0;
}
int fmi2DoStep(Instance c, double time, double step, int keep) { reached = x + slope * step; return 0; }
#define SUCCEED(name) int name() { return 0; }
SUCCEED(fmi2SetDebugLogging) SUCCEED(fmi2SetupExperiment) SUCCEED(fmi2EnterInitializationMode)
SUCCEED(fmi2ExitInitializationMode) SUCCEED(fmi2Terminate) SUCCEED(fmi2Reset)
SUCCEED(fmi2GetInteger) SUCCEED(fmi2GetBoolean) SUCCEED(fmi2GetString)
SUCCEED(fmi2SetInteger) SUCCEED(fmi2SetBoolean) SUCCEED(fmi2SetString)
SUCCEED(fmi2GetFMUstate) SUCCEED(fmi2SetFMUstate) SUCCEED(fmi2FreeFMUstate)
SUCCEED(fmi2SerializedFMUstateSize) SUCCEED(fmi2SerializeFMUstate) SUCCEED(fmi2DeSerializeFMUstate)
SUCCEED(fmi2GetDirectionalDerivative) SUCCEED(fmi2GetRealOutputDerivatives) SUCCEED(fmi2CancelStep)
SUCCEED(fmi2GetStatus) SUCCEED(fmi2GetRealStatus) SUCCEED(fmi2GetIntegerStatus)
SUCCEED(fmi2GetBooleanStatus) SUCCEED(fmi2GetStringStatus)
C
cc -shared -fPIC -w -o slope.so slope.c
venv/bin/python - <<'PYTHON'
import zipfile

import fmpy
import numpy as np
from fmpy.validation import validate_fmu

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="slope" guid="{1}">
  <CoSimulation modelIdentifier="slope" canHandleVariableCommunicationStepSize="true"
    canInterpolateInputs="true"/>
  <ModelVariables>
    <ScalarVariable name="x" valueReference="1" causality="input" variability="continuous">
      <Real start="0"/>
    </ScalarVariable>
    <ScalarVariable name="reached" valueReference="2" causality="output" variability="continuous"
      initial="exact"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="slope" valueReference="3" causality="output" variability="continuous"
      initial="exact"><Real start="0"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="2"/><Unknown index="3"/></Outputs></ModelStructure>
</fmiModelDescription>"""
with zipfile.ZipFile("slope.fmu", "w") as archive:
    archive.writestr("modelDescription.xml", DESCRIPTION)
    archive.write("slope.so", "binaries/linux64/slope.so")
print("FMPy", fmpy.__version__, "finds in the FMU:", validate_fmu("slope.fmu") or "no problem")
assert not validate_fmu("slope.fmu")
time = np.arange(7) / 4  # knots that are exact in binary
triangle = np.array([0.0, 1.0, 2.0, 3.0, 2.0, 1.0, 0.0])
motion = np.zeros(7, dtype=[("time", float), ("x", float)])
motion["time"], motion["x"] = time, triangle
found = fmpy.simulate_fmu(
    "slope.fmu", fmi_type="CoSimulation", input=motion, set_input_derivatives=True, stop_time=1.5,
    output_interval=0.25,
)
print("knots          ", triangle[1:])
print("input reached  ", found["reached"][1:], " by x + slope * step")
print("slope of step  ", np.diff(triangle) * 4)
print("slope that came", found["slope"][1:])
assert found["slope"][1:].tolist() == [0.0, 4.0, 4.0, 4.0, -4.0, -4.0], "the slopes have changed"
assert found["reached"][4] == 4.0  # the tip is at 3
PYTHON
