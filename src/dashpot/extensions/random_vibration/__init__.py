"""Bases that shake at random: what they do to a mass on seals, and to many bodies."""
