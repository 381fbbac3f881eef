"""Signals of single channels: noise, and segments of a motion."""
