"""Fit of a testing machine to files of blank tests."""

from __future__ import annotations

from collections.abc import Sequence
from fnmatch import fnmatch
from pathlib import Path

from dashpot.base.errors import DataError, ReadError
from dashpot.extensions.blank_tests.datamodel import MachineFit, Role
from dashpot.extensions.blank_tests.fit import fit_blank_tests
from dashpot.extensions.blank_tests.read import read_blank_test
from dashpot.reading.read_options import ReadOptions


def fit_blank_files(
    files: Sequence[str | Path],
    *,
    spring_stiffness: float | None = None,
    spring_error: float | None = None,
    roles: Sequence[tuple[str, Role]] = (),
    options: ReadOptions | None = None,
) -> MachineFit:
    """Return the properties of a testing machine from files of blank tests.

    Parameters
    ----------
    files : sequence of path
    spring_stiffness, spring_error : float, optional
        Stiffness of the spring, N/m, and its relative standard error.
    roles : sequence of (str, str)
        Pattern of file names, empty for all, and the role of the files.
    options : ReadOptions, optional

    Raises
    ------
    ReadError
        If a file cannot be read, a pattern suits none, or a role is open.
    """
    names = [Path(path).name for path in files]
    for pattern, role in roles:
        if pattern and not any(fnmatch(name, pattern) for name in names):
            raise ReadError(
                f"--role {pattern}:{role} suits none of the files: {', '.join(names)}. Write the "
                "name of a file"
            )
    tests = [
        read_blank_test(path, options=options, role=_find_role(name, roles))
        for path, name in zip(files, names, strict=True)
    ]
    try:
        return fit_blank_tests(tests, spring_stiffness=spring_stiffness, spring_error=spring_error)
    except DataError as error:
        raise ReadError(str(error)) from None


def _find_role(name: str, roles: Sequence[tuple[str, Role]]) -> Role:
    """Return the last role whose pattern matches a file; "" if none does."""
    matching_roles: list[Role] = [
        role for pattern, role in roles if not pattern or fnmatch(name, pattern)
    ]
    return matching_roles[-1] if matching_roles else ""
