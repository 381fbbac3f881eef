"""Fit of a hyperelastic law to stress-strain files of one mode or several."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Literal

from dashpot.base.errors import DataError, FitError, ReadError
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.hyperelastic.datamodel import HyperelasticFit, Span
from dashpot.extensions.materials.hyperelastic.fit import fit_hyperelastic
from dashpot.extensions.materials.hyperelastic.law_choices import ElasticKindOption
from dashpot.extensions.materials.hyperelastic.read import read_stress_strain
from dashpot.extensions.materials.options import MODES, Measures
from dashpot.extensions.materials.relaxation_model import normalise_relaxation
from dashpot.reading.read_options import ReadOptions

if TYPE_CHECKING:
    from pathlib import Path


def hyperelastic_files(
    files: Mapping[str, Sequence[str | Path]],
    *,
    law: ElasticKindOption = "auto",
    terms: int | Literal["auto"] = "auto",
    poisson: float | None = None,
    relaxation: Fit | None = None,
    stretches: Span | None = None,
    measures: Measures | None = None,
    specimen: Specimen | None = None,
    options: ReadOptions | None = None,
) -> HyperelasticFit:
    """Fit a hyperelastic law to files.

    Parameters
    ----------
    files : mapping of str to sequence of path
        By a key of :data:`MODES`, or ``"auto"``: as the header of each file says.
    relaxation : Fit, optional
        Fit of a relaxation test of the material: its relaxation is removed.
    law, terms, poisson, stretches
        As :func:`~dashpot.extensions.materials.hyperelastic.fit.fit_hyperelastic` takes them.
    measures : Measures, optional
    specimen : Specimen, optional
        Its temperature is written into decks.
    options : ReadOptions, optional
    """
    kinds_and_paths = [(kind, path) for kind in ("auto", *MODES) for path in files.get(kind, ())]
    if not kinds_and_paths:
        raise ReadError(
            "no file is given; name the mode of each: --test uniaxial, compression, biaxial, "
            "planar or volumetric"
        )
    tests = [
        read_stress_strain(
            path,
            None if kind == "auto" else MODES[kind].mode,
            is_compression=kind != "auto" and MODES[kind].is_compressed,
            measures=measures,
            options=options,
        )
        for kind, path in kinds_and_paths
    ]
    temperature = None if specimen is None else specimen.temperature
    try:
        return fit_hyperelastic(
            tests,
            law=law,
            terms=terms,
            poisson=poisson,
            relaxation=None if relaxation is None else normalise_relaxation(relaxation.model),
            cycle=None if options is None else options.cycle,
            stretches=stretches,
            temperature=temperature,
        )
    except (DataError, FitError) as error:
        raise ReadError(str(error)) from None
