"""dashpot: from the relaxation test of a seal to a validated vibration model.

The public names stand in ``__init__.pyi``; each is imported when it is first used, so that
``import dashpot`` and ``dashpot --help`` cost next to nothing.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
