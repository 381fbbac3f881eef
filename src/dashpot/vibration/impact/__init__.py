"""From hits to a frequency response function."""
