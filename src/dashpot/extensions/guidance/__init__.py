"""What to type instead: options and commands that are meant, and how to install an extra."""
