"""dashpot app: the local web app."""

from __future__ import annotations

import click

from dashpot.cli import _options as options
from dashpot.cli._command import group, opt, verb


@verb(
    "app",
    """Do the same work in a browser, on this computer only.

  dashpot app
  dashpot app seal_8mm.csv hammer.csv
  dashpot app lot

A folder is opened as the project or the lot that it is. Only this machine can
reach the page, and only by the address printed. From elsewhere:
ssh -L PORT:127.0.0.1:PORT. Files never leave the machine. Ctrl-C ends it.""",
    options.file_argument("[FILE...]", min_count=0),
    group(
        "Server",
        opt("--port", type=click.IntRange(0, 65535), default=0, metavar="N",
            help="TCP port (a free one)."),
        opt("--no-browser", help="Print the address, open nothing."),
    ),
)  # fmt: skip
def command(*, files: tuple[str, ...], port: int, no_browser: bool) -> None:
    """Serve the page until Ctrl-C."""
    from dashpot.extensions.app.server import serve

    serve(files, port=port, browser=not no_browser)
