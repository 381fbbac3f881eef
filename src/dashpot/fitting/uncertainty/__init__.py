"""How well a fit is known, and what it leaves open."""
