"""Stiffness and loss against amplitude, from sweeps and from FRFs at several levels."""
