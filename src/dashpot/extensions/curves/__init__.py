"""Curves of a material: creep, DMA, modulus, master curves, several temperatures."""
