"""Many records on one clock, fitted side by side."""
