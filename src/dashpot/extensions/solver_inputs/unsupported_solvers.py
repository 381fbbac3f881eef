"""Advice for solvers without an export."""

UNCHECKED = (
    "Nothing is written for it, as nothing here could check it. --to csv writes the arms as a "
    "table (--form arms) to enter by hand."
)
KRATOS = (
    "Nothing is written for it: the stress of its viscoelastic laws depends on the number of "
    "steps, so no arms are right there. Use another solver, or --to fmu."
)
