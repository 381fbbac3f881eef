"""A fractional Zener solid fitted to whatever arms can be fitted to."""
