"""The local app: a page on this machine for whoever opens a window rather than a shell."""
