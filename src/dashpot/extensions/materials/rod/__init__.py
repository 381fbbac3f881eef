"""Vibrating rod under a mass: modulus of its material at each frequency."""
