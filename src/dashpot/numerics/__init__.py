"""Sums of exponentials, exactly: no seal, no unit, no file in here."""
