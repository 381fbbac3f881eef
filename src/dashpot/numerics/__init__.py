"""Fits of exponential sums to plain arrays, and their inference."""
