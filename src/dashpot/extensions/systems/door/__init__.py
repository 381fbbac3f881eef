"""Seal in a car door: vibration on the seal, and closing."""
