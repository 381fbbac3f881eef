"""What many tests share: hand-made results, the broad seal, look-alike files."""
