"""Public Python functions: read, inspect, fit, predict, compare, report, export, plan, batch.

Each verb takes records and results of any kind; which work they mean is decided where the command
line asks, too (`dashpot.reading.readers.detect_kind`, `dashpot.workflow.fit_routing`). The public
names stand in ``dashpot/__init__.pyi``.
"""
