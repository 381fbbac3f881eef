"""How well a solution is known, and how many arms the data support."""
