"""Vibration: FRFs from impacts, measured and predicted."""
