"""Arrays to Axes: one panel each, knowing no result."""
