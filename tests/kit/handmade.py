"""A study made by hand: the broad seal of the demo, fitted with relaxation times given.

Figures and the report are tested on it without running a fit: stiffnesses are solved from a
simulated test at fixed relaxation times, the measured FRF is the true one with noise.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from dashpot.base.checks import Check
from dashpot.base.provenance import Source, Step
from dashpot.datamodel.bounds import FRFBounds, StiffnessBounds
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import Certificate, OrderScore
from dashpot.datamodel.frf import FRF, Hit
from dashpot.datamodel.parameter_estimate import Nuisance, Residual
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.specimen import Specimen
from dashpot.fitting.prediction_bounds import parameter_band
from dashpot.simulation.impact import Hammer, simulate_impact
from dashpot.solids.demo_seals import BROAD, BROAD_MASS
from dashpot.solids.maxwell import GeneralizedMaxwell, arm_response
from dashpot.vibration.comparison.compare import compare
from dashpot.vibration.mass_on_seals import MassOnSeals, predict_frf
from dashpot.vibration.modal.dynamic_stiffness import dynamic_stiffness
from dashpot.workflow.stiffness_under_mass import find_static_equilibrium
from dashpot.workflow.study import STIFFNESS_LINES, Study
from kit.fits import a_fit, replace_fields

BAND = (0.004, 0.32)
SHA = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"


@cache
def raw_test() -> RelaxationTest:
    """The broad seal under a 1 s ramp to 8 mm, held for 40 s, 5 mN noise, 200 Hz."""
    random = np.random.default_rng(7)
    time = np.arange(-0.5, 41.0, 0.005)
    position = 8e-3 * np.clip(time, 0.0, 1.0)
    force = BROAD.force(time + 1.0, position) + 0.005 * random.standard_normal(len(time))
    return RelaxationTest(
        time=time + 0.5,
        displacement=position,
        force=force,
        specimen=Specimen(length=0.1, height=0.02, temperature=296.15, notes="EPDM sponge"),
        source=Source("seal_8mm.csv", SHA, columns=("time: time [s]",), simulated=True),
        units="SI",
    )


@cache
def make_ramp_hold() -> RampHold:
    """The test with its segments known."""
    test = raw_test()
    return RampHold(
        time=test.time,
        displacement=test.displacement,
        force=test.force,
        onset=0.5,
        ramp_end=1.5,
        hold_end=41.495,
        depth=8e-3,
        force_noise=0.005,
        displacement_noise=1e-6,
        specimen=test.specimen,
        source=test.source,
        steps=(Step("tare", (("offset", "0.0012 N"),), "took 1.2 mN off the force"),),
        checks=(Check("sampling", True, "At 200 Hz the ramp is resolved.", 200.0, 50.0),),
    )


def fit_at(tau: tuple[float, ...]) -> Fit:
    """Stiffnesses by least squares at given relaxation times, with the force's offset."""
    record = make_ramp_hold()
    columns = [
        record.displacement,
        *(arm_response(record.time, record.displacement, t) for t in tau),
    ]
    design = np.column_stack([*columns, np.ones(len(record.time))])
    k, *_ = np.linalg.lstsq(design, record.force, rcond=None)
    residual = record.force - design @ k
    sse = float(residual @ residual)
    arms = len(tau)
    model = GeneralizedMaxwell(k[0], tuple(k[1 : 1 + arms]), tau)
    spread = np.diag([0.05**2, *[(2e-3 * v) ** 2 for v in model.k], *[0.004**2] * arms])
    checks = (
        Check(
            "residuals_white", arms > 1,
            "The residuals wander: neighbouring samples agree far more than noise would let them.",
            0.3, 1.5,
        ),
        Check("hold_long_enough", True, "The hold is 2.4 of the longest tau.", 2.4, 2.0),
    )  # fmt: skip
    return a_fit(
        model,
        residual=Residual(n=len(residual), sse=sse, rms=float(np.sqrt(sse / len(residual)))),
        covariance=spread,
        dof=500.0,
        band=BAND,
        certificate=Certificate(True, 0.0, None, "no further arm would lower the residual"),
        nuisance=(Nuisance("offset", float(k[-1]), 1e-4, "N"),),
        checks=checks,
        source=() if record.source is None else (record.source,),
        steps=(*record.steps, Step("fit", (("arms", str(arms)), ("method", "full")))),
    )


@cache
def make_single_arm_fit() -> Fit:
    """N = 1."""
    return fit_at((0.986,))


@cache
def two_arms() -> Fit:
    """N = 2, the chosen one, with the table of orders."""
    two, item = fit_at((0.46, 15.9)), make_single_arm_fit()
    orders = tuple(
        OrderScore(
            fit.model.arms,
            fit.estimate.residual.sse,
            8300 * np.log(fit.estimate.residual.sse),
            True,
            fit.model,
        )
        for fit in (item, two)
    )
    return replace_fields(two, orders=orders)


@cache
def joint() -> Fit:
    """What the joint fit would find: the truth, less its fastest arm, mass as nuisance."""
    model = GeneralizedMaxwell(196.4, (117.0, 17.9, 20.6, 24.0), (0.5, 16.4, 0.077, 0.0117))
    return a_fit(
        model, method="joint", residual=Residual(n=8300, sse=8300.0, rms=0.005),
        covariance=np.diag([0.05**2, *[0.3**2] * 4, *[0.02**2] * 4]), dof=900.0, band=(0.004, 40.0),
        nuisance=(Nuisance("mass", 0.1149, 1e-4, "kg"), Nuisance("delay", 2e-5, 1e-5, "s")),
        checks=(Check("mass_prior", True, "The mass moved by 0.3 standard errors.", 0.3, 2.0),),
    )  # fmt: skip


@cache
def make_measured_frf() -> FRF:
    """The true FRF of the block on two broad seals with 1 % noise and ten hits, one rejected."""
    random = np.random.default_rng(3)
    frequency = np.arange(2.0, 50.0, 0.125)
    true = predict_frf(2 * BROAD, mass=BROAD_MASS, frequency=frequency)
    size = np.abs(true.value)
    sd = 0.01 * size + 0.02
    noise = random.standard_normal(len(size)) + 1j * random.standard_normal(len(size))
    return FRF(
        frequency=frequency,
        value=true.value + sd * noise,
        coherence=1 / (1 + 10 * (sd / size) ** 2),
        sd=sd,
        averages=4,
        hits=tuple(
            Hit(
                str(i), 0.1 + 8.0 * (i - 1), i != 3,
                ("a second hit of 40 % struck 60 ms after the first",) if i == 3 else (),
                3.0, 0.014,
            )
            for i in range(1, 6)
        ),
        checks=(Check("coherence", True, "Coherence is above 0.9 from 4 to 45 Hz.", 0.97, 0.9),),
        source=(Source("impact.csv", SHA[::-1], simulated=True),),
        steps=(Step("average", (("estimator", "H1"), ("hits", "4"))),), units="SI",
    )  # fmt: skip


@cache
def unresolved_arm_band() -> StiffnessBounds:
    """Limits as wide as arms that a 1 s ramp hardly excites."""
    frequency = np.geomspace(1e-3, 100.0, 120)
    omega = 2 * np.pi * frequency
    model = two_arms().model
    reach = 1 / (1 + (0.5 / frequency) ** 2)
    storage, loss = model.storage(omega=omega), model.loss(omega=omega)
    return StiffnessBounds(
        frequency=frequency,
        storage=np.array([storage - 0.5 * reach, storage + 90 * reach]),
        loss=np.array([loss * (1 - 0.5 * reach), loss + 45 * reach]),
        loss_factor=np.array([loss / storage * (1 - 0.5 * reach), loss / storage + 0.12 * reach]),
        message="every non-negative spectrum that this test cannot reject lies between the limits",
    )


@cache
def frf_limits() -> FRFBounds:
    """Limits of the accelerance, narrow by the standard errors and wide by unseen arms."""
    frequency = make_measured_frf().frequency
    size = np.abs(predict_frf(2 * two_arms().model, mass=BROAD_MASS, frequency=frequency).value)
    near = np.abs(predict_frf(2 * BROAD, mass=BROAD_MASS, frequency=frequency).value)
    return FRFBounds(
        frequency=frequency,
        magnitude=size,
        parameter=np.array([0.97 * size, 1.03 * size]),
        unmeasured=np.array([0.6 * np.minimum(size, near), 1.5 * np.maximum(size, near)]),
        message="every spectrum that the relaxation test does not reject",
    )


@cache
def study() -> Study:
    """The whole story of the broad seal."""
    fit, target = two_arms(), make_measured_frf()
    predicted = predict_frf(2 * fit.model, mass=BROAD_MASS, frequency=target.frequency)
    after = predict_frf(2 * joint().model, mass=BROAD_MASS, frequency=target.frequency)
    return Study(
        test=raw_test(),
        prepared=make_ramp_hold(),
        fit=fit,
        alternatives=(make_single_arm_fit(), fit),
        hold_fit=replace_fields(fit, method="hold", nuisance=()),
        seals=2.0,
        mass=BROAD_MASS,
        mass_inferred=False,
        prediction=predicted,
        impact=simulate_impact(
            BROAD, mass=BROAD_MASS, hits=5, seed=2, rig=Hammer(double_hits=(2,))
        ).test,
        measured=target,
        comparison=compare(predicted, target, fit=fit, mass=BROAD_MASS, seals=2.0),
        joint=joint(),
        joint_prediction=after,
        joint_comparison=compare(after, target, fit=joint(), mass=BROAD_MASS, seals=2.0),
        parameters=parameter_band(fit, STIFFNESS_LINES),
        unmeasured=unresolved_arm_band(),
        frf_band=frf_limits(),
        static_equilibrium=find_static_equilibrium(fit, MassOnSeals(BROAD_MASS, 2.0)),
        direct=dynamic_stiffness(target, BROAD_MASS, seals=2.0),
        checks=(Check("operating_point", False, "The mass sags 2.9 mm; the test held 8 mm.", 2.9),),
    )


@cache
def bench_only() -> Study:
    """The same without hammer, mass or joint fit."""
    return replace(
        study(), mass=None, prediction=None, impact=None, measured=None, comparison=None,
        joint=None, joint_prediction=None, joint_comparison=None, parameters=None, unmeasured=None,
        frf_band=None, direct=None, checks=(), hold_fit=None,
    )  # fmt: skip
