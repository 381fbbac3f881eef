"""One command, one file: read, call, write."""
