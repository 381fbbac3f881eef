"""Joint fit of one solid to tests at several temperatures."""
