"""Figures: functions from results to a `Picture`, and writers of pictures.

A :class:`~dashpot.plot.picture.Picture` is a frozen description of a drawing, independent of its
format. :func:`save` writes it as SVG, PNG or PDF; :func:`to_svg` gives the text of the first,
:func:`to_figure` a :class:`matplotlib.figure.Figure`. matplotlib is loaded for PNG and PDF only.

The names stand in ``__init__.pyi``, those of an extension in its rows; each is imported when it is
first used.
"""

from functools import cache, wraps
from types import FunctionType
from typing import Any

from dashpot.base.lazy import build_lazy_exports
from dashpot.registry import call_handler, find_handler, list_names

_find, _list = build_lazy_exports(__name__, __file__)


def __getattr__(name: str) -> Any:
    """Return the function that draws a figure: of the core, or of an extension."""
    if name == "__all__":
        return __dir__()
    value = find_handler("plot", name) or _find(name)
    return _add_advice(value) if isinstance(value, FunctionType) else value


@cache
def _add_advice(function: FunctionType) -> FunctionType:
    """Let errors of a figure's function say what to do, as a decorator."""

    @wraps(function)
    def draw(*args: Any, **keywords: Any) -> Any:
        try:
            return function(*args, **keywords)
        except Exception as error:
            call_handler("add advice", "figure", function, error, args, keywords, default=None)
            raise

    return draw


def __dir__() -> list[str]:
    return sorted([*_list(), *list_names("plot")])
