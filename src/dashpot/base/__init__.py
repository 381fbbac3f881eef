"""Foundation of all packages: errors, units, arrays, number format, provenance, checks."""

from dashpot.base.dataclasses import dataclass, field, fields, replace

__all__ = ["dataclass", "field", "fields", "replace"]
