"""Simultaneous fits of many records on one clock."""
