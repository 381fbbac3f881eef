"""Delimited text: dialect, header, cells and rows."""
