"""The seal in the car."""
