"""Relaxation modulus over time, as laboratories publish it."""
