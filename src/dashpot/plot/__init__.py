"""Results to figures: functions from results to a `Picture`, and writers of pictures.

A :class:`~dashpot.plot.picture.Picture` is a frozen value, what is drawn before anything draws it.
:func:`save` writes it as SVG, PNG or PDF; :func:`to_svg` gives the text of the first,
:func:`to_figure` a :class:`matplotlib.figure.Figure`. matplotlib is loaded for PNG and PDF only.

The names stand in ``__init__.pyi``; each is imported when it is first used.
"""

from dashpot.base.lazy import names_of

__getattr__, __dir__, __all__ = names_of(__name__, __file__)
