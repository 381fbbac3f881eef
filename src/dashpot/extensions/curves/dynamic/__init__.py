"""Dynamic mechanical analysis: storage and loss over frequency."""
