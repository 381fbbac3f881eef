"""Compression stress relaxation (CSR): aging of the sealing force, and lifetime."""
