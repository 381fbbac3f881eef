"""Creep: from a step of force to a compliance and its solid."""
