"""Predicted against measured: what the hammer confirms, and which arms it tested."""
