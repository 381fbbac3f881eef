"""Acceptance limits: requirements on a seal, compared with the results of its tests."""
