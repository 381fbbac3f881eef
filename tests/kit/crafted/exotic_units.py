"""Sweeps in viscosities in place of moduli, as rheometers export them."""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

import numpy as np

from kit.crafted.row import LOSS, STORAGE, SWEEP, TANGENT, F, Row, table

OMEGA = 2 * np.pi * F
SIZE = np.hypot(STORAGE, LOSS)
DELTA = np.degrees(np.arctan2(LOSS, STORAGE))
_TIMES = ("times omega is",)

EXOTIC_UNITS = [
    Row("|eta*| and delta over angular frequency", table("Angular frequency [rad/s];Complex viscosity [Pa·s];Phase angle [°]", OMEGA, SIZE / OMEGA, DELTA, form="%.9g").encode(), "noted", _TIMES, SWEEP),
    Row("|eta*| by its sign and delta", table("f [Hz];|η*| [Pa·s];δ [°]", F, SIZE / OMEGA, DELTA, form="%.9g").encode(), "noted", _TIMES, SWEEP),
    Row("|eta*| in mPa s and tan delta, tabs", table("Frequency [Hz]\tComplex Viscosity [mPa·s]\ttan(delta) [-]", F, 1e3 * SIZE / OMEGA, TANGENT, sign="\t", form="%.9g").encode(), "noted", _TIMES, SWEEP),
    Row("|eta*| in kPa s, German, decimal commas", table("Kreisfrequenz [1/s];Komplexe Viskosität [kPa·s];Verlustfaktor [-]", OMEGA, SIZE / OMEGA / 1e3, TANGENT, form="%.9g", comma=True).encode("cp1252"), "noted", _TIMES, SWEEP),
    Row("eta* in poise", table("Freq [Hz],Eta* [P],tan_delta", F, 10 * SIZE / OMEGA, TANGENT, sign=",", form="%.9g").encode(), "noted", _TIMES, SWEEP),
    Row("both parts of eta*", table("Angular frequency [rad/s];η' [Pa·s];η'' [Pa·s]", OMEGA, LOSS / OMEGA, STORAGE / OMEGA, form="%.9g").encode(), "noted", _TIMES, SWEEP),
    Row("|eta*| beside moduli is left alone", table("Frequency [Hz];Storage modulus [MPa];Loss modulus [MPa];Complex viscosity [Pa·s]", F, STORAGE / 1e6, LOSS / 1e6, SIZE / OMEGA, form="%.9g").encode(), truth=SWEEP),
    Row("a storage modulus alone", table("Frequency [Hz];Storage modulus [MPa]", F, STORAGE / 1e6, form="%.9g").encode(), "refused", ("storage modulus alone", "--column loss=NAME"), SWEEP),
    Row("a storage modulus and a temperature alone", table("f [Hz]\tE' [MPa]\tT [°C]", F, STORAGE / 1e6, 23 + 0 * F, sign="\t", form="%.9g").encode(), "refused", ("storage modulus alone",), SWEEP),
    Row("|eta*| without an angle", table("Angular frequency [rad/s];Complex viscosity [Pa·s]", OMEGA, SIZE / OMEGA, form="%.9g").encode(), "refused", ("flow curve",), SWEEP),
    Row("a viscosity in a unit that nobody knows", table("Frequency [Hz];Complex viscosity [St];tan delta [-]", F, SIZE / OMEGA, TANGENT, form="%.9g").encode(), "refused", ("flow curve",), SWEEP),
]  # fmt: skip
