"""Acceptance limits: what was asked of a seal, held against what its tests found."""
