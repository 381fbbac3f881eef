"""Reproduction of the paper: its equations, figures and table beside dashpot's results."""
