"""From a raw relaxation test to a ramp and a hold."""
