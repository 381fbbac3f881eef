"""The text and UFF files that every tool here reads."""
