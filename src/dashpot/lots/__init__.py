"""Many tests: one table, one page."""
