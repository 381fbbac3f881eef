"""Tests at several temperatures, one solid."""
