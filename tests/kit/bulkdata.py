"""A reader of Nastran bulk data that shares nothing with the writer."""

from __future__ import annotations

import re

import numpy as np


def read_cards(text: str) -> list[tuple[str, list[str]]]:
    """Each card as its name and fields; small field, large field, continuations by position."""
    cards: list[tuple[str, list[str]]] = []
    for raw in text.splitlines():
        line = raw.split("$")[0].rstrip()
        if not line:
            continue
        head = line[:8].strip()
        width = 16 if "*" in line[:8] else 8
        body = line[8:72].ljust(64)
        fields = [body[i : i + width].strip() for i in range(0, 64, width)]
        name = head.strip().rstrip("*") or head.strip()
        if name and name[0] not in "+*":
            cards.append((name, fields))
        else:
            cards[-1][1].extend(fields)
    return cards


def real(field: str) -> float:
    """A Nastran real: 1.5, 1.5E-3, 1.5-3, and blank as 0."""
    if not field:
        return 0.0
    assert "." in field, f"{field!r} is an integer to Nastran, not a real"
    return float(re.sub(r"(?<=[\d.])([+-]\d+)$", r"E\1", field))


class Bush:
    """What PBUSH, PBUSHT and TABLED1 say together, evaluated as the manual says."""

    def __init__(self, text: str) -> None:
        cards = read_cards(text)
        self.cards = cards
        self.tables: dict[str, tuple[np.ndarray, np.ndarray]] = {}
        self.nominal: dict[str, float] = {}
        self.table_of: dict[str, str] = {}
        for name, fields in cards:
            if name == "TABLED1":
                pairs = [field for field in fields[8:] if field]
                assert pairs[-1] == "ENDT"
                values = np.array([real(field) for field in pairs[:-1]]).reshape(-1, 2)
                self.tables[fields[0]] = values[:, 0], values[:, 1]
            elif name in ("PBUSH", "PBUSHT"):
                for start in range(0, len(fields), 8):
                    row = fields[start : start + 8]
                    if name == "PBUSH":
                        self.nominal[row[1]] = real(row[2])
                    else:
                        self.table_of[row[1]] = row[2]

    def table(self, label: str, frequency):
        x, y = self.tables[self.table_of[label]]
        return np.interp(frequency, x, y)

    def complex_stiffness(self, frequency):
        """K (1 + j GE) + j 2 pi f B, frequency in cycles per unit of time."""
        frequency = np.asarray(frequency, dtype=float)
        K = self.table("K", frequency)
        loss = K * self.table("GE", frequency) if "GE" in self.table_of else 0.0
        viscous = self.table("B", frequency) if "B" in self.table_of else 0.0
        return K + 1j * (loss + 2 * np.pi * frequency * viscous)
