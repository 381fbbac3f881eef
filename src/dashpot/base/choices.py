"""The words that users choose among, each list stated once, as a type.

Signatures name the type; options, the app's buttons and the sentence that refuses another word take
its words. Nothing here needs NumPy, for ``--help`` does not.
"""

from __future__ import annotations

from typing import Any, Literal, TypeAlias, get_args

from dashpot.base.errors import DashpotError, DataError

Method: TypeAlias = Literal["full", "hold"]
RampLawAsked: TypeAlias = Literal["auto", "linear", "nonlinear"]
Family: TypeAlias = Literal["maxwell", "fractional"]
FamilyAsked: TypeAlias = Literal["auto", Family]
Estimate: TypeAlias = Literal["H1", "H2", "Hv", "Hs"]
OverBase: TypeAlias = Literal["absolute", "relative"]
ShiftLaw: TypeAlias = Literal["auto", "wlf", "arrhenius", "free"]
Vertical: TypeAlias = Literal["1", "T/T_r", "free"]
VerticalAsked: TypeAlias = Literal["auto", Vertical]
AmplitudeLaw: TypeAlias = Literal["factor", "additive", "cubic", "factor+cubic", "additive+cubic"]
AmplitudeLawAsked: TypeAlias = Literal["auto", AmplitudeLaw]
ElasticKind: TypeAlias = Literal["neo-hooke", "mooney-rivlin", "yeoh", "ogden", "hyperfoam"]
ElasticKindAsked: TypeAlias = Literal["auto", ElasticKind]
Measure: TypeAlias = Literal["auto", "nominal", "true"]
ImpactLaw: TypeAlias = Literal["kelvin-voigt", "hertz", "hertz-kelvin-voigt", "hertz-maxwell"]
ImpactLawAsked: TypeAlias = Literal["auto", ImpactLaw]
PartMode: TypeAlias = Literal[
    "compression", "shear", "axial", "torsion", "radial-short", "radial-long"
]  # fmt: skip
FrfKind: TypeAlias = Literal["receptance", "mobility", "accelerance", "dynamic_stiffness"]
Driver: TypeAlias = Literal["simulated", "serial", "replay"]
Rehearsed: TypeAlias = Literal["relaxation", "creep", "impact", "motion"]

Drawn: TypeAlias = Literal["pdf", "png", "svg"]
FigureSize: TypeAlias = Literal["column", "slide"]


def get_choice_values(choice: Any) -> tuple[str, ...]:
    """Return the words of such a type, or of an enumeration.

    >>> get_choice_values(FamilyAsked)
    ('auto', 'maxwell', 'fractional')
    """
    return get_args(choice) or tuple(choice)


def require_choice(
    name: str, value: object, choice: Any, error: type[DashpotError] = DataError
) -> None:
    """Refuse what is none of the words of a choice.

    Raises
    ------
    DataError
        Or another `error`, if it is none.
    """
    values = get_choice_values(choice)
    if value not in values:
        raise error(f"{name} = {value!r}; expected one of {', '.join(values)}")
