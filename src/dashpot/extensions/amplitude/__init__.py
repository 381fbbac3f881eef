"""Amplitude dependence of stiffness and loss, from tests at several amplitudes."""
