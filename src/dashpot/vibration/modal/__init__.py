"""Peaks, poles and stiffness of a measured frequency response function."""
