"""Many tests: one table, one page.

The names stand in ``__init__.pyi``; each is imported when it is first used.
"""

from dashpot.base.lazy import names_of

__getattr__, __dir__, __all__ = names_of(__name__, __file__)
