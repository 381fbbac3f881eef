"""Functional mock-up unit (FMU) for Modelica tools, multibody codes and Simulink."""

from __future__ import annotations

from dashpot.base.errors import ExportError
from dashpot.base.units import Quantity, convert_to_si
from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import target

FORMS = ("fmi2", "fmi3")
SUFFIX = "fmu"


@target(*FORMS)
def fmu(
    deck: Deck,
    *,
    mass: Quantity | None = None,
) -> DeckText:
    r"""FMU of a mount or of a mass on it: Model Exchange and Co-Simulation of FMI 2.0 or 3.0.

    The inputs of a mount are displacement and velocity, its output is the force; with a mass the
    input is the force on it and the output its motion. A step of Co-Simulation is exact where the
    input is a straight line over the step, and its output belongs to the end of the step:

    .. math::

        F(t+h) = k_\infty x(t+h) + b u + \sum_j k_j \left[e_j(t) E_j + u \tau_j (1 - E_j)\right],
        \quad u = \frac{x(t+h) - x(t)}{h}, \quad E_j = e^{-h/\tau_j}

    The line starts at the end of the last one and ends at the input plus its rate times h. So set
    the displacement at the start of the step with the velocity, or the displacement at its end
    without a velocity: neither has a delay. The displacement at the start without a velocity delays
    the output by a step. A sine of frequency f sampled so has the amplitude
    :math:`\operatorname{sinc}^2 (f h)`.

    The returned text is ``sources/model.h``, and ``file_content`` the archive, with binaries where
    the package ziglang is installed (``pip install dashpot[fmu]``). Parameters have units and
    limits; their 95 % intervals are in their descriptions.

    Parameters
    ----------
    solid, units, specimen, allow
        As in :func:`dashpot.export.nastran`; FMI counts time in s.
    form : str
    mass : float, optional
        kg.
    """
    from dashpot.extensions.solver_inputs.fmi.archive import build_fmu

    mass = convert_to_si(mass, "mass")
    if mass is not None and not mass > 0:
        raise ExportError(f"mass = {mass!r} kg; expected a number > 0")
    if deck.units.time != 1:
        raise ExportError(
            f"FMI counts time in s, {deck.units.name} in {deck.units.words[2]}; add "
            "--unit-system SI or mm-t-s"
        )
    return build_fmu(deck, mass)
