r"""Complex viscosities of a frequency sweep as moduli.

.. math:: |G^*| = \omega |\eta^*|, \qquad G'' = \omega \eta', \qquad G' = \omega \eta''

References
----------
ISO 6721-10, 3.1 to 3.6.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dashpot.base.errors import ReadError
from dashpot.reading.columns.role_assignment import RoleAssignment, assign_role, get_unit
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.table import FileTable, LoadedColumns

_PRIME = "['′’´]"
_NAMES = (
    ("G'", re.compile(rf"(?:eta|η)\s?(?:{_PRIME}{{2}}|[\"″”])", re.IGNORECASE)),
    ("G''", re.compile(rf"(?:eta|η)\s?{_PRIME}|dynamic viscosity", re.IGNORECASE)),
    (
        "|G*|",
        re.compile(
            r"\|?(?:eta|η)\s?\*\|?"
            r"|(?:complex|dynamic complex|komplexe|complexe|compleja|complessa) "
            r"(?:shear )?vis[ck]os\w*"
            r"|vis[ck]os\w* (?:complexe|compleja|complessa|\(?complex\)?)|复数?[粘黏]度|複素粘度",
            re.IGNORECASE,
        ),
    ),
)  # fmt: skip
"""Modulus of each viscosity, and its names; the longer name first."""
_UNITS = {
    "pas": 1.0, "mpas": 1e-3, "kpas": 1e3, "MPas": 1e6, "ns/m2": 1.0, "ns/m²": 1.0, "p": 0.1,
    "poise": 0.1, "cp": 1e-3, "cps": 1e-3, "psec": 0.1,
}  # fmt: skip
"""Pa s, by words without blanks and dots."""


def convert_viscosities(table: FileTable, options: ReadOptions) -> FileTable:
    """Return the table with each complex viscosity times omega, as a modulus.

    The table stays as it is without a frequency, with a storage modulus, or where the size of the
    viscosity stands without loss angle and loss factor.
    """
    viscosities = {
        index: (modulus, factor)
        for index, column in enumerate(table.columns)
        if column.content == "number"
        and (modulus := _name_modulus(column.name))
        and (factor := _parse_viscosity(column.unit))
    }
    frequency = assign_role(table, "frequency", options) if viscosities else None
    if not isinstance(frequency, RoleAssignment) or frequency.index in viscosities:
        return table
    if isinstance(assign_role(table, "storage", options), RoleAssignment):
        return table
    moduli = {modulus for modulus, _ in viscosities.values()}
    angles = [assign_role(table, role, options) for role in ("loss_factor", "loss_angle", "phase")]
    if moduli == {"|G*|"} and not any(isinstance(angle, RoleAssignment) for angle in angles):
        return table
    frequency_index = frequency.index
    try:
        hertz = get_unit(table.columns[frequency_index], frequency_index + 1, "frequency", options)
    except ReadError:
        return table

    def load(indexes: Sequence[int]) -> LoadedColumns:
        loaded_columns = table.load(
            [*indexes, frequency_index] if viscosities.keys() & set(indexes) else indexes
        )
        if len(loaded_columns.values.T) == len(indexes):
            return loaded_columns
        omega = 2 * np.pi * hertz.factor * loaded_columns.values[:, -1]
        values = loaded_columns.values[:, :-1].copy()
        for column, index in enumerate(indexes):
            if index in viscosities:
                values[:, column] *= omega * viscosities[index][1]
        return replace(loaded_columns, values=values)

    columns = tuple(
        replace(column, name=viscosities[i][0], unit="Pa") if i in viscosities else column
        for i, column in enumerate(table.columns)
    )
    viscosities_text = ", ".join(
        f"'{table.columns[i].name}' times omega is {modulus}"
        for i, (modulus, _) in viscosities.items()
    )
    return replace(table, columns=columns, load=load, notes=(*table.notes, viscosities_text))


def _name_modulus(name: str) -> str:
    """Return the modulus that a viscosity of this name is times omega; empty of another name.

    >>> _name_modulus("Complex viscosity"), _name_modulus("|η*|"), _name_modulus("eta''")
    ('|G*|', '|G*|', "G'")
    """
    return next((modulus for modulus, pattern in _NAMES if pattern.fullmatch(name.strip())), "")


def _parse_viscosity(word: str | None) -> float:
    """Return a unit of viscosity in Pa s, 0 of any other word."""
    bare_unit = re.sub(r"[\s.·*⋅∙\-]", "", word or "")
    return _UNITS["MPas"] if bare_unit[:3] == "MPa" else _UNITS.get(bare_unit.casefold(), 0.0)
