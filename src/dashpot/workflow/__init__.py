"""Every rule of the work that the command line and its siblings share."""
