"""Public functions for files besides records: profiles, motions, instruments, tables.

The names are listed in ``files.pyi``; each is imported when it is first used.
"""

from dashpot.base.lazy import build_lazy_exports

__getattr__, __dir__ = build_lazy_exports(__name__, __file__)
