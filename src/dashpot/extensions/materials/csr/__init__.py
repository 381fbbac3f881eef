"""Compression stress relaxation: how long a seal seals."""
