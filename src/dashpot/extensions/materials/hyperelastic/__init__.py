"""Stress and strain of a rubber: the energy of its deformation."""
