"""Statistics of plain arrays and labels."""
