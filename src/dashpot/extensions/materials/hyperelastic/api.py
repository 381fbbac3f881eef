"""Public Python functions for stress-strain tests."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from dashpot.base.errors import ReadError
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.fit import Fit
from dashpot.extensions.materials.hyperelastic.datamodel import HyperelasticFit
from dashpot.extensions.materials.hyperelastic.law_choices import ElasticKindOption
from dashpot.registry import KINDS, load_object


def fit_stress_strain(
    records: list[Any],
    *,
    model: ElasticKindOption = "auto",
    terms: int | Literal["auto"] = "auto",
    poisson: float | None = None,
    relaxation: Fit | None = None,
    stretches: tuple[float, float] | None = None,
    temperature: Quantity | None = None,
    cycle: int | None = None,
) -> HyperelasticFit:
    """Fit an elastic law to tests of stress over strain."""
    from dashpot.extensions.materials.hyperelastic.fit import fit_hyperelastic
    from dashpot.extensions.materials.relaxation_model import normalise_relaxation

    return fit_hyperelastic(
        records,
        law=model,
        terms=terms,
        poisson=poisson,
        relaxation=None if relaxation is None else normalise_relaxation(relaxation.model),
        cycle=cycle,
        stretches=stretches,
        temperature=convert_to_si(temperature, "temperature"),
    )


def read_stress_strain_record(
    path: str | Path, options: dict[str, Any], fit_options: Mapping[str, Any]
) -> Any:
    """Read a test of stress over strain."""
    from dashpot.extensions.materials.options import MODES

    word = fit_options.get("test")
    read_it = load_object(KINDS["stress-strain"].reader)
    if word is None:
        return read_it(path, None, **options)
    if word not in MODES:
        raise ReadError(f"test='{word}': expected one of {', '.join(MODES)}")
    return read_it(path, MODES[word].mode, is_compression=MODES[word].is_compressed, **options)
