"""Tests and results of curves over time, frequency and temperature."""
