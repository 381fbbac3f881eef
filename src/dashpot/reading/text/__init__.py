"""Delimited text, whoever wrote it."""
