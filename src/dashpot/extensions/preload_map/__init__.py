"""Complex stiffness over frequency, amplitude and compression by one separable law."""
