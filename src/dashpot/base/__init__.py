"""Foundation of all packages: errors, units, arrays, number format, provenance, checks."""
