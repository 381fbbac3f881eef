"""Random base motion: response of a mass on seals, and of multibody systems."""
