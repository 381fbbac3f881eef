"""Public functions for systems on seals: bodies, mounts, seal lines, doors.

The names are listed in ``systems.pyi``; each is imported when it is first used.
"""

from dashpot.base.lazy import build_lazy_exports

__getattr__, __dir__ = build_lazy_exports(__name__, __file__)
