"""dashpot: from the relaxation test of a seal to a validated vibration model.

>>> import dashpot as dp
>>> test, hits = dp.read("seal_8mm.csv"), dp.read("hammer.csv")
>>> fit = dp.fit(test, hits, mass="114.8g", seals=2)
>>> fit.verdict.use
'use'
>>> deck = dp.export(
...     fit, to="nastran", unit_system="mm-t-s", temperature="23degC", length="50mm"
... )

A quantity is a number with its unit (``"114.8g"``, ``"8mm"``, ``"12.71Hz"``). A bare number is in
SI. Arrays say their units, in their order: ``dp.RelaxationTest(..., units="s, mm, N")``.
Frequencies are named: ``solid.loss_factor(frequency="12.71Hz")``, or ``omega=``.

The public names are listed in ``__init__.pyi``; each is imported when it is first used, so that
``import dashpot`` and ``dashpot --help`` cost next to nothing.
"""

from dashpot.base.lazy import build_lazy_exports, set_package_functions

__getattr__, __dir__ = build_lazy_exports(__name__, __file__)
set_package_functions(__name__, "report", "export")
