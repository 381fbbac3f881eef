"""Readers: records from tables."""
