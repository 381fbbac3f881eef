"""The seal in the car: a door on its seals, and its closing."""
