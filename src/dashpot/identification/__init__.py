"""Viscoelastic solids from vibration, alone or together with relaxation."""

from dashpot.identification.bands import (
    FRFBand,
    formal_frf_band,
    frf_band,
    parameter_band,
    unseen_arm_band,
)
from dashpot.identification.identify import identify
from dashpot.identification.mass import infer_mass
from dashpot.identification.stiffness import (
    DynamicStiffness,
    causal_loss_factor,
    dynamic_stiffness,
)

__all__ = [
    "DynamicStiffness",
    "FRFBand",
    "causal_loss_factor",
    "dynamic_stiffness",
    "formal_frf_band",
    "frf_band",
    "identify",
    "infer_mass",
    "parameter_band",
    "unseen_arm_band",
]
