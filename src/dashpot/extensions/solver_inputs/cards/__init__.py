"""Solver cards read back to a model."""
