"""Material tests: compression, stress relaxation, elasticity, indentation, rods, drop tests."""
