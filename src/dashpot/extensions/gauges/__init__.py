"""A force/torque transducer of six strain gauges: simulated records in its voltages."""
