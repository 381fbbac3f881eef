"""Batches of many tests: one table and one page.

The names are listed in ``__init__.pyi``; each is imported when it is first used.
"""

from dashpot.base.lazy import build_lazy_exports

__getattr__, __dir__ = build_lazy_exports(__name__, __file__)
