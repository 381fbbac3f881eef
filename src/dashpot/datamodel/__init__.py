"""The values that pass between rooms: what was measured, and the fit."""
