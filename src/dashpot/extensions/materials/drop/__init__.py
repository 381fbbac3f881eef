"""Drop tests: a mass hits a seal, for its dynamic load deflection and loss factor."""
