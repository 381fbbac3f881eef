"""Fractional Zener solids, fitted to the same data as Maxwell arms."""
