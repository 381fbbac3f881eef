"""A study to one self-contained HTML file."""
