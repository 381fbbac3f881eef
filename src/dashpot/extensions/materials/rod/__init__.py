"""A mass on a rod, shaken: the modulus of its material at each frequency."""
