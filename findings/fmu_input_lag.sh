#!/usr/bin/env bash
# FMPy: a pure spring, driven through a co-simulation, becomes a source of energy.
#
# Expected: simulate_fmu(input=...) interpolates the given signal; a spring F = k x answers with the
#   force of the displacement at the time that stands beside it, and its loss factor is zero.
# Happens: inputs are set at the beginning of each communication step and held, and the output is
#   written down at its end. The force belongs to the displacement one step earlier: at 12.71 Hz and
#   a step of 1 ms the loss factor is -tan(omega h) = -0.080, of 5 ms -0.42.
# Matters: that is more than the loss factor of most seals, and of the wrong sign. A co-simulation
#   FMU of a mount needs steps that are short beside 1/omega, and a check of one against a given
#   motion must compare the force with the motion one step earlier.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "FMPy==0.3.22" "numpy==2.2.6"
cd "$folder"
cat > spring.c <<'C'
#include <stddef.h>
typedef void *Instance; typedef const char *String; typedef const unsigned int *References;
static double x, f;                                   /* f = 1000 N/m * x, nothing else */
String fmi2GetTypesPlatform(void) { return "default"; }
String fmi2GetVersion(void) { return "2.0"; }
Instance fmi2Instantiate(String a, int b, String c, String d, const void *e, int g, int h) { return &x; }
void fmi2FreeInstance(Instance c) {}
int fmi2SetReal(Instance c, References v, size_t n, const double *y) { if (n) x = y[0]; return 0; }
int fmi2GetReal(Instance c, References v, size_t n, double *y) {
    for (size_t i = 0; i < n; i++) y[i] = v[i] == 1 ? x : f;
    return 0;
}
int fmi2DoStep(Instance c, double time, double step, int keep) { f = 1000 * x; return 0; }
#define SUCCEED(name) int name() { return 0; }
SUCCEED(fmi2SetDebugLogging) SUCCEED(fmi2SetupExperiment) SUCCEED(fmi2EnterInitializationMode)
SUCCEED(fmi2ExitInitializationMode) SUCCEED(fmi2Terminate) SUCCEED(fmi2Reset)
SUCCEED(fmi2GetInteger) SUCCEED(fmi2GetBoolean) SUCCEED(fmi2GetString)
SUCCEED(fmi2SetInteger) SUCCEED(fmi2SetBoolean) SUCCEED(fmi2SetString)
SUCCEED(fmi2GetFMUstate) SUCCEED(fmi2SetFMUstate) SUCCEED(fmi2FreeFMUstate)
SUCCEED(fmi2SerializedFMUstateSize) SUCCEED(fmi2SerializeFMUstate) SUCCEED(fmi2DeSerializeFMUstate)
SUCCEED(fmi2GetDirectionalDerivative) SUCCEED(fmi2SetRealInputDerivatives)
SUCCEED(fmi2GetRealOutputDerivatives) SUCCEED(fmi2CancelStep) SUCCEED(fmi2GetStatus)
SUCCEED(fmi2GetRealStatus) SUCCEED(fmi2GetIntegerStatus) SUCCEED(fmi2GetBooleanStatus)
SUCCEED(fmi2GetStringStatus)
C
cc -shared -fPIC -w -o spring.so spring.c
venv/bin/python - <<'PYTHON'
import zipfile

import fmpy
import numpy as np

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="spring" guid="{1}">
  <CoSimulation modelIdentifier="spring" canHandleVariableCommunicationStepSize="true"/>
  <ModelVariables>
    <ScalarVariable name="x" valueReference="1" causality="input" variability="continuous">
      <Real start="0"/>
    </ScalarVariable>
    <ScalarVariable name="f" valueReference="2" causality="output" variability="continuous">
      <Real/>
    </ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="2"/></Outputs></ModelStructure>
</fmiModelDescription>"""
with zipfile.ZipFile("spring.fmu", "w") as archive:
    archive.writestr("modelDescription.xml", DESCRIPTION)
    archive.write("spring.so", "binaries/linux64/spring.so")
print("FMPy", fmpy.__version__)
OMEGA = 2 * np.pi * 12.71
for step in (1e-3, 5e-3):
    time = np.arange(0, 1.6, step / 10)
    motion = np.zeros(len(time), dtype=[("time", float), ("x", float)])
    motion["time"], motion["x"] = time, np.sin(OMEGA * time)
    result = fmpy.simulate_fmu(
        "spring.fmu", fmi_type="CoSimulation", stop_time=1.5, output_interval=step, input=motion
    )
    time = result["time"][10:]
    columns = np.column_stack((np.sin(OMEGA * time), np.cos(OMEGA * time)))
    (storage, loss), *_ = np.linalg.lstsq(columns, result["f"][10:], rcond=None)
    print(f"step {1e3 * step:.0f} ms: k {storage:.1f} N/m (1000), loss factor {loss / storage:+.4f}")
    assert abs(loss / storage + np.tan(OMEGA * step)) < 0.01
PYTHON
