"""Fit of a surface's contact law to the files of an indentation test."""

from __future__ import annotations

from pathlib import Path

from dashpot.base.errors import DataError, ReadError
from dashpot.extensions.materials.indentation.datamodel import IndentationFit
from dashpot.extensions.materials.indentation.fit import fit_indentation
from dashpot.extensions.materials.indentation.indenter import ImpactLawOption, Indenter
from dashpot.extensions.materials.indentation.read import read_indentation
from dashpot.reading.raw_file import add_name_to_errors
from dashpot.reading.read_options import ReadOptions


def indent_file(
    path: str | Path,
    *,
    indenter: Indenter,
    law: ImpactLawOption = "auto",
    options: ReadOptions | None = None,
) -> IndentationFit:
    """Fit the contact law of a surface to the largest contact in a file.

    Parameters
    ----------
    path : path
    indenter : Indenter
        With its mass.
    law : str
        As :func:`~dashpot.extensions.materials.indentation.fit.fit_indentation` takes it.
    options : ReadOptions, optional
        Reading options of the file.
    """
    if indenter.mass is None:
        raise ReadError(
            "the force follows from the mass of the indenter. Give it, for example --mass 5g"
        )
    test = read_indentation(path, indenter=indenter, options=options)
    with add_name_to_errors(Path(path).name):
        try:
            return fit_indentation(test, law=law)
        except DataError as error:
            raise ReadError(str(error)) from None
