"""Rigid bodies on mounts: prediction, state space, modes, response in time."""
