"""Lengths that a fast Fourier transform likes.

`scipy.fft.next_fast_len` says the same, at the price of an import that outlasts the first fit.
"""

from __future__ import annotations


def fast_length(least: int) -> int:
    """Return the smallest 2^i 3^j 5^k >= least."""
    best = 1 << max(least - 1, 0).bit_length()
    five = 1
    while five < best:
        three = five
        while three < best:
            rest = -(-least // three)
            best = min(best, three << (rest - 1).bit_length())
            three *= 3
        five *= 5
    return best
