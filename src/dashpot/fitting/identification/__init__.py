"""Viscoelastic solids from vibration, alone or together with relaxation."""
