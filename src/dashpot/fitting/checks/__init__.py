"""Criteria on fits."""
