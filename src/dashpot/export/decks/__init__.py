"""One target, one file: a function of its name, and what it declares beside it.

``FORMS``, the forms that it writes, the usual one first; ``SUFFIX``, of its files; ``NEEDS``, the
arguments that a form cannot do without.
"""
