"""Columns of a table: units, roles, and the kind of record."""
