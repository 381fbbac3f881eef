"""The best stiffnesses and relaxation times of a stack of blocks."""
