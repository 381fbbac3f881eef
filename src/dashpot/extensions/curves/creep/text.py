"""Text of the creep compliance behind a fit."""

from __future__ import annotations

from dashpot.datamodel.fit import Fit


def format_compliances(fit: Fit) -> list[str]:
    """Return the compliances that were fitted to creep, and their times."""
    creep = fit.evidence.creep
    assert creep is not None  # noqa: S101
    reported_values = creep.list_values("m/N" if fit.unit == "N/m" else "1/Pa")
    texts = {value.name: value.cells.ascii.with_unit for value in reported_values}
    parts = [f"instantaneous {texts['glass']}"]
    parts += [
        f"{texts[f'd_{j}']} in {texts[f'lam_{j}']}" for j in range(1, len(creep.spectrum.d) + 1)
    ]
    if "flow" in texts:
        parts.append(f"flow {texts['flow']}, without end")
    return [f"  creep       {'; '.join(parts)}"]
