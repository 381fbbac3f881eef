"""Limits of a hammer fit over every spectrum that its lines do not reject."""
