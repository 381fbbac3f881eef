"""Kinds of tests that a plug-in fits: columns in SI units to values and checks."""
