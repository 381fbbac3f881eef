"""Material curves: creep, DMA, modulus, master curves, several temperatures."""
