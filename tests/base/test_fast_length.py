"""Lengths of Fourier transforms against a search one by one."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from dashpot.base.arrays import find_fast_length


def smooth(n: int) -> bool:
    for prime in (2, 3, 5):
        while n % prime == 0:
            n //= prime
    return n == 1


@given(st.integers(1, 100_000))
def test_fast_length_is_the_next_without_a_prime_above_five(n: int) -> None:
    assert find_fast_length(n) == next(size for size in range(n, 2 * n + 1) if smooth(size))
