"""Tests of materials: compression, stress relaxation, elasticity, indentation, rods, slams."""
