"""Time-temperature superposition of sweeps and moduli at several temperatures."""
