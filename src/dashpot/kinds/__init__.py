"""Kinds of tests, a room for each: its record, how it is read, prepared, fitted, judged, drawn."""
