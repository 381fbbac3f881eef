"""Dynamic indentation: impact of a ball or block, and the contact law of the surface."""
