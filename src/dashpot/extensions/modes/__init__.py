"""Modes over several points, masses and hits: shapes, stabilisation, leave-one-out."""
