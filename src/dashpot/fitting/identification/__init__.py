"""Identification of viscoelastic solids from vibration, with or without relaxation."""
