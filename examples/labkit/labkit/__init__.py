"""What one lab adds to dashpot. Nothing here imports dashpot."""
