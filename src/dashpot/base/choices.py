"""What users choose among: words that help pages and forms need before anything is imported."""

DECKS = (
    "nastran", "abaqus", "ansys", "lsdyna", "radioss", "calculix", "opensees", "adams",
    "statespace", "csv",
)  # fmt: skip
"""Solvers: each a file of ``export/decks``."""
