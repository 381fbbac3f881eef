"""Compression load deflection: cycles of a plate, and the elastic law under them."""
