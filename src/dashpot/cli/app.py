"""dashpot app: the page."""

from __future__ import annotations

import click

from dashpot.cli._shell import File


@click.command("app")
@click.argument("files", type=File(), nargs=-1, metavar="[FILE]...")
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="[default: a free one]")
@click.option("--no-browser", is_flag=True, help="Print the address, open nothing.")
def command(*, files: tuple[str, ...], port: int, no_browser: bool) -> None:
    """Open the app in a browser, with FILE in it: the same work, by hand and eye.

    A folder is opened as the project or the lot that it is.

    Only this machine can reach the page, and only by the address printed, which holds a token.
    From elsewhere: ssh -L PORT:127.0.0.1:PORT. Files never leave the machine. Ctrl-C ends it.

    \b
    dashpot app
    dashpot app seal_8mm.csv hammer.csv
    dashpot app lot
    """
    from dashpot.web.server import serve

    serve(files, port=port, browser=not no_browser)
