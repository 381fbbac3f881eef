"""Storage and loss stiffness of a fit at frequencies, without a mass."""
