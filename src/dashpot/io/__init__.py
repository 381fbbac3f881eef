"""One format, one file: read; and the archive of dashpot's own JSON."""
