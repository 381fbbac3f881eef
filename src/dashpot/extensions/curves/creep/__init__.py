"""Creep: the compliance after a force step, and the solid fitted to it."""
