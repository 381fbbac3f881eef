"""A spectrum wider than the arms that are tried is said so, and no rig is blamed for it."""

from __future__ import annotations

import pytest
from kit.foreign.wide_spectra import record_wide_spectrum

import dashpot as dp

#: hold first, with at most 5 arms; ramp and hold at once, with at most 6
WIDE = {
    "hold first": {
        "slope": 0.1, "shortest": 1e-2, "longest": 1e3, "noise": 1e-4, "hold": 100.0,
        "rate": 100.0,
    },
    "hold first, slow": {
        "slope": 0.0, "shortest": 1e-2, "longest": 1e3, "noise": 4e-4, "hold": 1000.0,
        "rate": 20.0,
    },
    "at once": {
        "slope": 0.0, "shortest": 1e-3, "longest": 1e3, "noise": 2e-4, "hold": 100.0,
        "rate": 100.0,
    },
}  # fmt: skip


def read_record(**how: float) -> dp.RelaxationTest:
    return dp.RelaxationTest(*record_wide_spectrum(**how), units="SI")  # type: ignore[arg-type]


@pytest.mark.parametrize("name", WIDE)
def test_spectrum_wider_than_the_arms_leads_the_verdict(name: str) -> None:
    test = read_record(**WIDE[name])
    fit = dp.fit(test)
    check = {check.name: check for check in fit.checks}["arms_enough"]
    assert check.failed
    assert f"{fit.model.arms} arms leave" in str(fit.verdict)
    assert "clocks" not in str(fit.verdict)
    # more arms are what helps
    more = dp.fit(test, arms=fit.model.arms + 2)
    assert more.estimate.residual.variance_inflation < fit.estimate.residual.variance_inflation
    assert not {c.name: c for c in more.checks}["force_residual_small"].failed


@pytest.mark.parametrize("seed", range(3))
def test_few_arms_are_enough_of_a_narrow_spectrum(seed: int) -> None:
    """Of arms that are tried in full, however the noise falls."""
    test = dp.simulate("relaxation", seal="broad", hold="40s", rate="100Hz", seed=seed)
    checks = {check.name: check for check in dp.fit(test).checks}
    assert "arms_enough" not in checks or not checks["arms_enough"].failed
