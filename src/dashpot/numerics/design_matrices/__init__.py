"""Data sets as design matrices in the relaxation times."""
