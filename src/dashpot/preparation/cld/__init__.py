"""Compression load deflection: from a record to cycles and their figures."""
