"""Tests at several amplitudes: what they do to stiffness and loss."""
