"""Least squares of anything: coefficients that are solved, parameters that descend."""
