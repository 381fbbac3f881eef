"""Elastic law of a seal from the ramps of its relaxation tests."""
