"""What dashpot does beyond the paper's method; the core knows it by its registry alone."""
