"""A mass slammed on a piece: dynamic load deflection."""
