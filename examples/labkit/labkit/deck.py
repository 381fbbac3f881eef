"""The input of the lab's own solver."""

COMMENT = "#"


def labsolver(solid: dict, *, units: str, name: str) -> str:
    """Return the cards of a solid, of which dashpot gives SI numbers."""
    if units != "SI":
        raise ValueError(f"{name} reads SI alone, and {units} was asked for")
    arms = [f"ARM {k!r} {tau!r}" for k, tau in zip(solid["k"], solid["tau"], strict=True)]
    return "\n".join([f"SPRING {solid['k_inf']!r}", *arms, "END"])
