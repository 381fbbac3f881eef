"""What ``dashpot fit`` does with each kind of records: one file a fit.

Each has a function `run`, which receives what the user said and returns what is told.
"""
