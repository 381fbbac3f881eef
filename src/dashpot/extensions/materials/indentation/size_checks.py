"""Criteria on the sizes of an indenter's record."""

from __future__ import annotations

from dashpot.reading.readers.size_checks import make_size_criterion

shock_not_large = make_size_criterion(
    "shock_not_large",
    "The acceleration of the indenter is within the range of a shock accelerometer.",
    "greatest acceleration <= 1e6 m/s^2", "a hundred thousand g, the range of shock accelerometers",
    message="The acceleration reaches", role="acceleration",
)  # fmt: skip
indenter_not_fast = make_size_criterion(
    "indenter_not_fast",
    "The indenter is no faster than in tests of rubber.",
    "greatest speed <= 100.0 m/s", "rubber is hit more slowly",
    message="The velocity reaches", role="velocity",
)  # fmt: skip
contact_rate = make_size_criterion(
    "contact_rate",
    "The sampling rate is high enough for a contact.",
    "sampling rate >= 500.0 Hz", "a contact lasts 40 ms at most",
    message="The record is sampled at", role="time",
)  # fmt: skip
