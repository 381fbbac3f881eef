"""Truths, rigs and records made wholly apart from dashpot: what its answers are judged on.

    from kit.foreign.catalogue import relaxation_records, verdict_records
    from kit.foreign.rigs import RIGS, Protocol, read
    from kit.foreign.truths import TRUTHS, Seal

`truths` are solids and seals with their stiffness and force, `rigs` what a machine does to a sound
record, `kinds` the other tests that a lab brings, `catalogue` named sets of all. Nothing here
imports dashpot, and the same seed gives the same bytes. SI units.
"""
