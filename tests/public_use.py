"""Eleven calls whose results a type checker knows; the last four it refuses.

Read by `tests/test_public_face.py`; it is not run.
"""

from typing import reveal_type

import dashpot as dp

test = dp.read("a.csv", kind="relaxation")
hits = dp.read("h.csv", kind="impact")
specimen = dp.read("c.csv", kind="cld")
reveal_type(dp.fit(test))  # Fit
reveal_type(dp.fit(test, test))  # Fit
reveal_type(dp.fit(hits))  # Modes
reveal_type(dp.fit(hits, mass="114.8g"))  # Fit
reveal_type(dp.fit(test, hits, mass="114.8g", seals=2))  # Fit
reveal_type(dp.fit(hits, hits, levels=["0.02N", "0.5N"], mass="1g"))  # AmplitudeResult
reveal_type(dp.fit(hits, mass="1g", density=1000.0, shape="disc:20mm,20mm"))  # Fit
reveal_type(dp.fit(specimen, compression="6mm"))  # CLDResult
reveal_type(dp.fit(dp.read("s.csv", kind="stress-strain")))  # HyperelasticFit
reveal_type(dp.compare(dp.fit(test), hits))  # FRFComparison
reveal_type(dp.simulate("impact"))  # ImpactTest
dp.fit(test, specimen)  # refused: a bench test and load deflection
dp.fit(test, hits)  # refused: a mass is missing
dp.fit(test).model.loss_factor(12.71)  # refused: Hz or rad/s
dp.fit(specimen, arms=3)  # refused: load deflection has no arms
