"""The file modelDescription.xml of FMI 2.0 and 3.0: variables, units, limits and structure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from xml.sax.saxutils import quoteattr

from dashpot.base import dataclass
from dashpot.base.version import __version__
from dashpot.export.unit_systems import UnitSystem

TIME, INPUT, RATE, OUTPUT, FIRST_PARAMETER = 0, 1, 2, 3, 10
"""Value references, as sources/solid.h counts them."""


@dataclass(frozen=True)
class Variable:
    """Variable of an FMU.

    Attributes
    ----------
    name, unit, description : str
    reference : int
        Its value reference.
    causality, variability, initial : str
    start, least : float, optional
        Its value at first, and the least that it may have.
    derivative_of : int, optional
        Value reference of the state whose derivative it is.
    depends_on : tuple of int
        Value references that it follows from, of an output or a derivative.
    """

    name: str
    reference: int
    unit: str
    description: str
    causality: str = "local"
    variability: str = "continuous"
    initial: str = ""
    start: float | None = None
    least: float | None = None
    derivative_of: int | None = None
    depends_on: tuple[int, ...] = ()


@dataclass(frozen=True)
class ModelDescription:
    """All that modelDescription.xml says.

    Attributes
    ----------
    identifier, name, summary : str
    variables : tuple of Variable
    units : UnitSystem
    """

    identifier: str
    name: str
    summary: str
    variables: tuple[Variable, ...]
    units: UnitSystem

    @property
    def outputs(self) -> list[Variable]:
        """Variables that are read after a step."""
        return [each for each in self.variables if each.causality == "output"]

    @property
    def derivatives(self) -> list[Variable]:
        """Derivatives of the states, in the order of these."""
        found = [each for each in self.variables if each.derivative_of is not None]
        return [each for each in found if each.reference != RATE]

    @property
    def initial_unknowns(self) -> list[Variable]:
        """What is computed at the start."""
        wanted = {each.reference: each for each in (*self.outputs, *self.derivatives)}
        return [each for each in wanted.values() if each.initial == "calculated"]

    def format_xml(self, form: str, token: str) -> str:
        """Return the file of a form, ``"fmi2"`` or ``"fmi3"``; `token` ties it to its binary."""
        lines = list((self._fmi2 if form == "fmi2" else self._fmi3)(token))
        return "\n".join(['<?xml version="1.0" encoding="UTF-8"?>', *lines, ""])

    def _fmi2(self, token: str) -> Iterator[str]:
        head = _format_attributes(
            fmiVersion="2.0", modelName=self.name, guid=token, description=self.summary,
            generationTool=f"dashpot {__version__}", variableNamingConvention="structured",
            numberOfEventIndicators="0",
        )  # fmt: skip
        yield f"<fmiModelDescription{head}>"
        able = {"canGetAndSetFMUstate": "true", "canSerializeFMUstate": "true"}
        for kind, more in (
            ("ModelExchange", {}),
            ("CoSimulation", {
                "canHandleVariableCommunicationStepSize": "true", "canInterpolateInputs": "true",
            }),
        ):  # fmt: skip
            yield f"  <{kind}{_format_attributes(modelIdentifier=self.identifier, **more, **able)}>"
            yield '    <SourceFiles><File name="fmi2.c"/></SourceFiles>'
            yield f"  </{kind}>"
        yield from self._units("Unit")
        yield "  <ModelVariables>"
        place = {each.reference: str(i) for i, each in enumerate(self.variables, start=1)}
        for each in self.variables:
            start = None if each.start is None else repr(each.start)
            of = None if each.derivative_of is None else place[each.derivative_of]
            least = None if each.least is None else repr(each.least)
            yield f"    <ScalarVariable{_format_attributes(**_common(each))}>"
            numbers = _format_attributes(unit=each.unit, derivative=of, min=least, start=start)
            yield f"      <Real{numbers}/>"
            yield "    </ScalarVariable>"
        yield "  </ModelVariables>"
        yield "  <ModelStructure>"
        for group, those in (
            ("Outputs", self.outputs), ("Derivatives", self.derivatives),
            ("InitialUnknowns", self.initial_unknowns),
        ):  # fmt: skip
            if not those:
                continue
            yield f"    <{group}>"
            for each in those:
                unknown = {"index": place[each.reference]}
                if group != "InitialUnknowns":
                    unknown["dependencies"] = " ".join(
                        sorted((place[i] for i in each.depends_on), key=int)
                    )
                yield f"      <Unknown{_format_attributes(**unknown)}/>"
            yield f"    </{group}>"
        yield "  </ModelStructure>"
        yield "</fmiModelDescription>"

    def _fmi3(self, token: str) -> Iterator[str]:
        head = _format_attributes(
            fmiVersion="3.0", modelName=self.name, instantiationToken=token,
            description=self.summary, generationTool=f"dashpot {__version__}",
            variableNamingConvention="structured",
        )  # fmt: skip
        yield f"<fmiModelDescription{head}>"
        able = {"canGetAndSetFMUState": "true", "canSerializeFMUState": "true"}
        for kind, more in (
            ("ModelExchange", {}),
            ("CoSimulation", {"canHandleVariableCommunicationStepSize": "true"}),
        ):
            own = _format_attributes(modelIdentifier=self.identifier, **able, **more)
            yield f"  <{kind}{own}/>"
        yield from self._units("Unit")
        yield "  <ModelVariables>"
        for each in self.variables:
            start = None if each.start is None else repr(each.start)
            least = None if each.least is None else repr(each.least)
            of = None if each.derivative_of is None else str(each.derivative_of)
            numbers = {"unit": each.unit, "derivative": of, "min": least, "start": start}
            yield f"    <Float64{_format_attributes(**_common(each), **numbers)}/>"
        yield "  </ModelVariables>"
        yield "  <ModelStructure>"
        for kind, those in (
            ("Output", self.outputs), ("ContinuousStateDerivative", self.derivatives),
            ("InitialUnknown", self.initial_unknowns),
        ):  # fmt: skip
            for each in those:
                unknown = {"valueReference": str(each.reference)}
                if kind != "InitialUnknown":
                    unknown["dependencies"] = " ".join(map(str, sorted(each.depends_on)))
                yield f"    <{kind}{_format_attributes(**unknown)}/>"
        yield "  </ModelStructure>"
        yield "</fmiModelDescription>"

    def _units(self, tag: str) -> Iterator[str]:
        """Every unit by its factor to SI."""
        units = self.units
        stiffness, length, force = units.force / units.length, units.length, units.force
        known: dict[str, tuple[dict[str, int], float]] = {
            "s": ({"s": 1}, 1.0),
            units.words[0]: ({"m": 1}, length),
            f"{units.words[0]}/s": ({"m": 1, "s": -1}, length),
            f"{units.words[0]}/s2": ({"m": 1, "s": -2}, length),
            units.words[1]: ({"kg": 1}, units.mass),
            units.words[3]: ({"kg": 1, "m": 1, "s": -2}, force),
            f"{units.words[3]}/s": ({"kg": 1, "m": 1, "s": -3}, force),
            f"{units.words[3]}/{units.words[0]}": ({"kg": 1, "s": -2}, stiffness),
            f"{units.words[3]}.s/{units.words[0]}": ({"kg": 1, "s": -1}, stiffness),
        }
        used = {each.unit for each in self.variables}
        yield "  <UnitDefinitions>"
        for name, (powers, factor) in known.items():
            if name in used:
                base = {"factor": repr(round(factor, 15))} if factor != 1 else {}
                words = _format_attributes(**{k: str(v) for k, v in powers.items()}, **base)
                yield f"    <{tag}{_format_attributes(name=name)}><BaseUnit{words}/></{tag}>"
        yield "  </UnitDefinitions>"


def _common(each: Variable) -> dict[str, str | None]:
    return {
        "name": each.name, "valueReference": str(each.reference), "causality": each.causality,
        "variability": each.variability, "initial": each.initial or None,
        "description": each.description,
    }  # fmt: skip


def _format_attributes(**values: str | None) -> str:
    return "".join(
        f" {name}={quoteattr(value)}" for name, value in values.items() if value is not None
    )


def format_c_array(name: str, values: Sequence[str]) -> list[str]:
    """Return a constant array of C, one number a line."""
    return [
        f"static const double {name}[] = {{",
        *(f"    {value}," for value in values),
        "};",
    ]
