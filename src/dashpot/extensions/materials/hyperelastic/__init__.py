"""Hyperelasticity: strain-energy laws of rubber and foam from stress and strain."""
