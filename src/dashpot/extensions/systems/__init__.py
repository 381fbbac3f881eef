"""Systems of bodies on seals: FRFs, motion, levels, a random base, a door on its seal line."""
