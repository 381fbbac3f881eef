"""Every way in: from a file to a noun."""

from dashpot.io.dynamic import read_dynamic
from dashpot.io.frf import read_frf
from dashpot.io.impact import read_impact
from dashpot.io.inspecting import inspect_file
from dashpot.io.modulus import read_modulus
from dashpot.io.relaxation import read_relaxation

__all__ = [
    "inspect_file",
    "read_dynamic",
    "read_frf",
    "read_impact",
    "read_modulus",
    "read_relaxation",
]
