"""``python -m dashpot``: the command line."""

from dashpot.cli import main

main(prog_name="dashpot")
