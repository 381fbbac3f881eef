"""Solver inputs of solids drawn from the uncertainty of a fit."""
