"""Everything that ends in a fit."""
