"""``python -m dashpot``: the command line."""

import sys

from dashpot.cli import main

if getattr(sys, "frozen", False):
    from dashpot.reading.sandbox.parent_process import frozen_support

    frozen_support()
main(prog_name="dashpot")
