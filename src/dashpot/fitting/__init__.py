"""Fits of viscoelastic solids to tests."""
