"""Other names of kinds of files, as ``--kind`` and `dashpot.read` take them."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

KIND_SYNONYMS: Mapping[str, str] = MappingProxyType(
    {
        "hammer": "impact", "hammer-test": "impact", "hit": "impact", "hits": "impact",
        "impulse": "impact", "modal": "impact", "tap": "impact", "tap-test": "impact",
        "hold": "relaxation", "ramp-hold": "relaxation", "relaxation-test": "relaxation",
        "force-relaxation": "relaxation", "stress-relaxation": "relaxation",
        "accelerance": "frf", "mobility": "frf", "receptance": "frf", "transfer-function": "frf",
        "sweep": "dma", "dynamic": "dma", "frequency-sweep": "dma",
        "amplitude-sweep": "strain-sweep", "mastercurve": "master-curve",
        "relaxation-modulus": "modulus", "creep-test": "creep",
        "loops": "cyclic", "hysteresis": "cyclic", "fatigue": "cyclic",
        "compression": "cld", "load-deflection": "cld", "tensile": "stress-strain",
        "tension": "stress-strain", "rebound": "indentation", "compression-set": "csr",
        "slam": "drop", "drop-test": "drop", "one-frequency": "single-frequency",
    }
)  # fmt: skip
"""Kind of file by its name in the documentation, in other programs or in an earlier version."""


def find_kind_of_file(name: str) -> str:
    """Return the kind of file that a name means, or the name itself.

    >>> find_kind_of_file("Hammer test"), find_kind_of_file("dma")
    ('impact', 'dma')
    """
    return KIND_SYNONYMS.get(name.strip().lower().replace(" ", "-").replace("_", "-"), name)
