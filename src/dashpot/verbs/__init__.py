"""What a user of Python does: read, inspect, fit, predict, compare, report, export, plan, batch.

Each verb takes records and results of any kind; which work they mean is decided where the command
line asks, too (`dashpot.io.readers.recognise`, `dashpot.workflow.routing`). The public names stand
in ``dashpot/__init__.pyi``.
"""
