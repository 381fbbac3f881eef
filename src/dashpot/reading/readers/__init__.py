"""From a table to a record."""
