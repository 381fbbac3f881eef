"""Compression load deflection: loading cycles of a seal, and its elastic law."""
