"""Relaxation modulus over time, as another laboratory states it."""
