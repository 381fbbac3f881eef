"""Comparison of predicted and measured FRFs."""
