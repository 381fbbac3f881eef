"""What numbers of a lot say: arrays and labels in, values out; no file, no unit, no table."""
