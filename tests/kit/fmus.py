"""FMUs with a binary of this machine's own compiler, and two ways to run them."""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from pathlib import Path
from unittest.mock import patch

import numpy as np
from scipy.integrate import solve_ivp

from dashpot.export import TARGETS

HERE = {"fmi2": "linux64", "fmi3": "x86_64-linux"}


def write_fmu(solid, form, folder: Path, **arguments) -> str:
    """Write an FMU of sources, add the binary, and return its path."""
    unit = TARGETS["fmu"](solid, **{"units": "SI", "form": form} | arguments)
    name = unit.description.identifier
    path = folder / f"{form}_{name}.fmu"
    individual = "dashpot.extensions.solver_inputs.fmi"
    with (
        patch(f"{individual}.archive.find_platforms", return_value=()),
        patch(f"{individual}.binaries.find_platforms", return_value=()),
    ):
        path.write_bytes(unit.file_content)
    opened = folder / path.stem
    with zipfile.ZipFile(path) as archive:
        archive.extractall(opened)
    subprocess.run(
        ["cc", "-std=c99", "-Wall", "-Werror", "-O2", "-fPIC", "-shared", "-o", "unit.so",
         f"{form}.c", "-lm"], cwd=opened / "sources", check=True,
    )  # fmt: skip
    with zipfile.ZipFile(path, "a") as archive:
        archive.write(opened / "sources/unit.so", f"binaries/{HERE[form]}/{name}.so")
    return str(path)


def simulate(path, kind="CoSimulation", **arguments):
    import fmpy

    return fmpy.simulate_fmu(path, fmi_type=kind, **arguments)


def table(time, **columns):
    made = np.zeros(len(time), dtype=[("time", float), *((name, float) for name in columns)])
    made["time"] = time
    for name, values in columns.items():
        made[name] = values
    return made


def driven(time, value, names=("x", "v")):
    """A signal of straight lines, with the slope of each piece at its beginning."""
    slope = np.append(np.diff(value) / np.diff(time), 0.0)
    return table(time, **dict(zip(names, (value, slope), strict=True)))


def integrate(path, form, times, inputs, names, *, start=None):
    """Model Exchange by an integrator that sets the inputs whenever it asks for a derivative."""
    import fmpy
    from fmpy.fmi2 import FMU2Model
    from fmpy.fmi3 import FMU3Model

    folder, read = fmpy.extract(path), fmpy.read_model_description(path)
    where = {variable.name: variable.valueReference for variable in read.modelVariables}
    words = {
        "guid": read.guid, "unzipDirectory": folder, "instanceName": "one",
        "modelIdentifier": read.modelExchange.modelIdentifier,
    }  # fmt: skip
    unit = (FMU2Model if form == "fmi2" else FMU3Model)(**words)
    unit.instantiate()
    if form == "fmi2":
        unit.setupExperiment(startTime=times[0])
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    unit.enterContinuousTimeMode()
    n = read.numberOfContinuousStates
    states, slopes = (np.zeros(n) for _ in range(2))
    set_real = unit.setReal if form == "fmi2" else unit.setFloat64
    get_real = unit.getReal if form == "fmi2" else unit.getFloat64
    find = unit.getDerivatives if form == "fmi2" else unit.getContinuousStateDerivatives
    pointer = np.ctypeslib.ctypes.POINTER(np.ctypeslib.ctypes.c_double)

    def place(time, y):
        unit.setTime(time)
        states[:] = y
        unit.setContinuousStates(states.ctypes.data_as(pointer), n)
        set_real([where[name] for name in names], list(inputs(time)))

    def derivative(time, y):
        place(time, y)
        find(slopes.ctypes.data_as(pointer), n)
        return slopes.copy()

    run = solve_ivp(
        derivative, times[[0, -1]], np.zeros(n) if start is None else start, t_eval=times,
        rtol=1e-10, atol=1e-14, max_step=np.diff(times).max(),
    )  # fmt: skip
    outputs = [variable.name for variable in read.modelVariables if variable.causality == "output"]
    result = {name: [] for name in outputs}
    for time, y in zip(times, run.y.T, strict=True):
        place(time, y)
        for name, value in zip(outputs, get_real([where[o] for o in outputs]), strict=True):
            result[name].append(value)
    unit.terminate()
    unit.freeInstance()
    shutil.rmtree(folder)
    return {name: np.array(values) for name, values in result.items()} | {"states": run.y.T}
