"""Time-temperature superposition: sweeps and moduli at several temperatures, one solid."""
