"""Public Python functions for indentation tests."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dashpot.base.errors import FitError, ReadError
from dashpot.extensions.materials.indentation.datamodel import IndentationFit
from dashpot.extensions.materials.indentation.indenter import ImpactLawOption
from dashpot.registry import KINDS, load_object


def fit_hit(records: list[Any], *, model: ImpactLawOption = "auto") -> IndentationFit:
    """Fit the law of one hit of an indenter."""
    from dashpot.extensions.materials.indentation.fit import fit_indentation

    if len(records) > 1:
        raise FitError(
            f"one hit of an indenter is fitted at a time, and there are {len(records)}. For a "
            "table of all: dp.batch(FOLDER)"
        )
    return fit_indentation(records[0], law=model)


_INDENTER = ("mass", "radius", "radius_error", "drop_height", "impact_velocity")


def read_hit_record(
    path: str | Path, options: dict[str, Any], fit_options: Mapping[str, Any]
) -> Any:
    """Read a hit of an indenter whose mass is stated."""
    from dashpot.extensions.materials.indentation.indenter import Indenter

    if "mass" not in fit_options:
        raise ReadError(
            f"{Path(path).name} is a hit of an indenter, and its mass is needed for the force. "
            f'Give it: dp.read("{Path(path).name}", mass="5g")'
        )
    indenter = Indenter(**{name: fit_options[name] for name in _INDENTER if name in fit_options})
    return load_object(KINDS["indentation"].reader)(path, indenter=indenter, **options)
