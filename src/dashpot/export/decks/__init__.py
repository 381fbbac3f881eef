"""Writers of decks, one module for each solver.

``FORMS``, the forms that it writes, the usual one first; ``SUFFIX``, of its files; ``NEEDS``, the
arguments that a form cannot do without.
"""
