"""Predicted against measured: what the hammer confirms, and which arms it tested."""

from dashpot.comparison.compare import compare
from dashpot.comparison.records import ArmEvidence, Comparison

__all__ = ["ArmEvidence", "Comparison", "compare"]
