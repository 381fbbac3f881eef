#!/usr/bin/env bash
# FMPy: in Model Exchange the input stands still while CVode integrates.
#
# Expected: simulate_fmu(fmi_type="ModelExchange", input=...) integrates dy/dt = x(t) to the tolerance that
#   is asked for: the integral of x = t from 0 to 1 is 0.5, whatever the interval of the output.
# Happens: the right-hand side that CVode calls sets time and states, but no inputs. Of a model without
#   event indicators they are set at the beginning of an output interval and hold, also in the steps that
#   CVode takes beyond its end: the integral falls short, 0.44 with an interval of 0.1 and 0.486 with 0.01,
#   and a smaller tolerance does not help.
# Matters: a tolerance says nothing of such an error, which is a lag of half an output interval or more, and
#   of a damper a false loss factor. Validate an FMU in Model Exchange with an integrator that sets the
#   inputs whenever it asks for a derivative.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "FMPy==0.3.32" "numpy==2.2.6"
cd "$folder"
cat > integral.c <<'C'
#include <stddef.h>
#include <string.h>
typedef void *Instance; typedef const char *String; typedef const unsigned int *References;
static double x, y;                                                     /* dy/dt = x, nothing else */
String fmi2GetTypesPlatform(void) { return "default"; }
String fmi2GetVersion(void) { return "2.0"; }
Instance fmi2Instantiate(String a, int b, String c, String d, const void *e, int g, int h) { return &x; }
void fmi2FreeInstance(Instance c) {}
int fmi2SetReal(Instance c, References v, size_t n, const double *s) { if (n) x = s[0]; return 0; }
int fmi2GetReal(Instance c, References v, size_t n, double *s) {
    for (size_t i = 0; i < n; i++) s[i] = v[i] == 2 ? y : x;
    return 0;
}
int fmi2GetDerivatives(Instance c, double *s, size_t n) { s[0] = x; return 0; }
int fmi2GetContinuousStates(Instance c, double *s, size_t n) { s[0] = y; return 0; }
int fmi2SetContinuousStates(Instance c, const double *s, size_t n) { y = s[0]; return 0; }
int fmi2GetNominalsOfContinuousStates(Instance c, double *s, size_t n) { s[0] = 1; return 0; }
typedef struct { int flag[5]; double next; } Event;
int fmi2NewDiscreteStates(Instance c, Event *e) { memset(e, 0, sizeof *e); return 0; }
int fmi2CompletedIntegratorStep(Instance c, int k, int *e, int *t) { *e = *t = 0; return 0; }
#define SUCCEED(name) int name() { return 0; }
SUCCEED(fmi2SetDebugLogging) SUCCEED(fmi2SetupExperiment) SUCCEED(fmi2EnterInitializationMode)
SUCCEED(fmi2ExitInitializationMode) SUCCEED(fmi2Terminate) SUCCEED(fmi2Reset) SUCCEED(fmi2SetTime)
SUCCEED(fmi2EnterEventMode) SUCCEED(fmi2EnterContinuousTimeMode) SUCCEED(fmi2GetEventIndicators)
SUCCEED(fmi2GetInteger) SUCCEED(fmi2GetBoolean) SUCCEED(fmi2GetString)
SUCCEED(fmi2SetInteger) SUCCEED(fmi2SetBoolean) SUCCEED(fmi2SetString)
SUCCEED(fmi2GetFMUstate) SUCCEED(fmi2SetFMUstate) SUCCEED(fmi2FreeFMUstate)
SUCCEED(fmi2SerializedFMUstateSize) SUCCEED(fmi2SerializeFMUstate) SUCCEED(fmi2DeSerializeFMUstate)
SUCCEED(fmi2GetDirectionalDerivative)
C
cc -shared -fPIC -w -o integral.so integral.c
venv/bin/python - <<'PYTHON'
import zipfile

import fmpy
import numpy as np

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="integral" guid="{1}" numberOfEventIndicators="0">
  <ModelExchange modelIdentifier="integral"/>
  <ModelVariables>
    <ScalarVariable name="x" valueReference="1" causality="input" variability="continuous">
      <Real start="0"/>
    </ScalarVariable>
    <ScalarVariable name="y" valueReference="2" causality="output" variability="continuous"
      initial="exact"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="der(y)" valueReference="3" variability="continuous" initial="calculated">
      <Real derivative="2"/>
    </ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="2"/></Outputs>
    <Derivatives><Unknown index="3"/></Derivatives>
    <InitialUnknowns><Unknown index="3"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>"""
with zipfile.ZipFile("integral.fmu", "w") as archive:
    archive.writestr("modelDescription.xml", DESCRIPTION)
    archive.write("integral.so", "binaries/linux64/integral.so")
from fmpy.validation import validate_fmu

print("FMPy", fmpy.__version__, "finds in the FMU:", validate_fmu("integral.fmu") or "no problem")
assert not validate_fmu("integral.fmu")
ramp = np.array([(0.0, 0.0), (1.0, 1.0)], dtype=[("time", float), ("x", float)])
for interval in (0.1, 0.01):
    for tolerance in (1e-6, 1e-10):
        found = fmpy.simulate_fmu(
            "integral.fmu", fmi_type="ModelExchange", input=ramp, stop_time=1.0,
            output_interval=interval, relative_tolerance=tolerance,
        )["y"][-1]
        print(f"interval {interval:g}, tolerance {tolerance:g}: integral {found:.6f} (0.5)")
        assert interval / 4 < 0.5 - found, "the inputs are no longer held"
PYTHON
