"""Every way in: from a file to a noun."""

from dashpot.io.readers.dynamic import read_dynamic
from dashpot.io.readers.frf import read_frf
from dashpot.io.readers.impact import read_impact
from dashpot.io.readers.inspect import inspect_file
from dashpot.io.readers.modulus import read_modulus
from dashpot.io.readers.relaxation import read_relaxation

__all__ = [
    "inspect_file",
    "read_dynamic",
    "read_frf",
    "read_impact",
    "read_modulus",
    "read_relaxation",
]
