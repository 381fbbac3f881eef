"""Solver inputs beyond Nastran, Abaqus, tables and state space."""
