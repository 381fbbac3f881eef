"""What one channel of a record shows: its scatter; the rests, ramps and holds of a motion."""
