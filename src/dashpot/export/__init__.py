"""One target, one file: solid to text."""
