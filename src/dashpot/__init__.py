"""dashpot: from the relaxation test of a seal to a validated vibration model.

The public names stand in ``__init__.pyi``; each is imported when it is first used, so that
``import dashpot`` and ``dashpot --help`` cost next to nothing.
"""

from dashpot.base.lazy import names_of

__getattr__, __dir__, __all__ = names_of(__name__, __file__)
