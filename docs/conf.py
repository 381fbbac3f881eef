"""How the documentation is built."""

from dashpot import __version__

project = "dashpot"
author = "the dashpot developers"
copyright = "2026, the dashpot developers"
release = __version__
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx_click",
]
myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = "dashpot"
exclude_patterns = ["_build"]
autodoc_typehints = "none"
napoleon_use_rtype = False
