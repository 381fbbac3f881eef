"""Dynamic transfer stiffness of a mount, as ISO 10846 reports it."""
