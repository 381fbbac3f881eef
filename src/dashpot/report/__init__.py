"""A study to one self-contained HTML file."""

from dashpot.report.page import html

__all__ = ["html"]
