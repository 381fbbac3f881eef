"""Results to Axes."""
