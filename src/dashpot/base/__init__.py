"""What every room stands on: errors, units, arrays, numbers, provenance, checks."""
