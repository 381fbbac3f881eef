"""Preparation of a raw relaxation test as a ramp and a hold."""
