"""Functional mock-up units (FMI 2.0 and 3.0) of a mount, and of a mass on it."""
