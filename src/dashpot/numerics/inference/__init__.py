"""Inference: uncertainty of a solution, and selection of the model order."""
