"""What stress over strain of a rubber may reach: asked where such a file is read or inspected."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.reading.readers import channels, size_checks
from dashpot.reading.readers.channels import Channel, OpenedFile


def refuse_sizes_of_rubber(
    file: OpenedFile,
    stretched: Channel,
    stressed: Channel,
    strain: FloatArray | None,
    stress: FloatArray,
) -> None:
    """Ask for the units again that make a size no test of a rubber has.

    Parameters
    ----------
    file : Opened
    stretched, stressed : Channel
        Of strain or stretch, and of stress.
    strain : array, shape (n,), or None
        None where none is too small.
    stress : array, shape (n,)
        Pa.

    Raises
    ------
    ReadError
    """
    most = float(np.abs(stress).max(initial=0.0))
    answers = [(stressed, [size_checks.stress_of_a_rubber(most, stressed.unit.word)])]
    if strain is not None:
        far = float(np.abs(strain).max(initial=0.0))
        answers.insert(0, (stretched, [size_checks.strain_of_a_rubber(far, stretched.unit.word)]))
    channels.refuse_sizes(file, answers)
