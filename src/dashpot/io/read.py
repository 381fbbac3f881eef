"""Every way in: from a file to a noun."""

from dashpot.io.impact import read_impact
from dashpot.io.inspecting import inspect_file
from dashpot.io.relaxation import read_relaxation
from dashpot.io.spectrum import read_dynamic, read_frf

__all__ = ["inspect_file", "read_dynamic", "read_frf", "read_impact", "read_relaxation"]
