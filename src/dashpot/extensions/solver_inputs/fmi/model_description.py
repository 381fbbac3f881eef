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
    start, minimum : float, optional
        Initial value, and smallest permitted value.
    derivative_of : int, optional
        Value reference of the state whose derivative it is.
    depends_on : tuple of int
        Value references of the variables that an output or a derivative depends on.
    """

    name: str
    reference: int
    unit: str
    description: str
    causality: str = "local"
    variability: str = "continuous"
    initial: str = ""
    start: float | None = None
    minimum: float | None = None
    derivative_of: int | None = None
    depends_on: tuple[int, ...] = ()


@dataclass(frozen=True)
class ModelDescription:
    """Contents of modelDescription.xml.

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
        return [variable for variable in self.variables if variable.causality == "output"]

    @property
    def derivatives(self) -> list[Variable]:
        """Derivatives of the states, in the order of the states."""
        all_derivatives = [
            variable for variable in self.variables if variable.derivative_of is not None
        ]
        return [variable for variable in all_derivatives if variable.reference != RATE]

    @property
    def initial_unknowns(self) -> list[Variable]:
        """Variables that are computed at the start."""
        unknowns = {variable.reference: variable for variable in (*self.outputs, *self.derivatives)}
        return [variable for variable in unknowns.values() if variable.initial == "calculated"]

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
        capabilities = {"canGetAndSetFMUstate": "true", "canSerializeFMUstate": "true"}
        for kind, kind_attributes in (
            ("ModelExchange", {}),
            ("CoSimulation", {
                "canHandleVariableCommunicationStepSize": "true", "canInterpolateInputs": "true",
            }),
        ):  # fmt: skip
            attributes = _format_attributes(
                modelIdentifier=self.identifier, **kind_attributes, **capabilities
            )
            yield f"  <{kind}{attributes}>"
            yield '    <SourceFiles><File name="fmi2.c"/></SourceFiles>'
            yield f"  </{kind}>"
        yield from self._units("Unit")
        yield "  <ModelVariables>"
        index_by_reference = {
            variable.reference: str(i) for i, variable in enumerate(self.variables, start=1)
        }
        for variable in self.variables:
            start = None if variable.start is None else repr(variable.start)
            of = (
                None
                if variable.derivative_of is None
                else index_by_reference[variable.derivative_of]
            )
            minimum_text = None if variable.minimum is None else repr(variable.minimum)
            yield f"    <ScalarVariable{_format_attributes(**_get_attributes(variable))}>"
            numbers = _format_attributes(
                unit=variable.unit, derivative=of, min=minimum_text, start=start
            )
            yield f"      <Real{numbers}/>"
            yield "    </ScalarVariable>"
        yield "  </ModelVariables>"
        yield "  <ModelStructure>"
        for group, variables in (
            ("Outputs", self.outputs), ("Derivatives", self.derivatives),
            ("InitialUnknowns", self.initial_unknowns),
        ):  # fmt: skip
            if not variables:
                continue
            yield f"    <{group}>"
            for variable in variables:
                unknown = {"index": index_by_reference[variable.reference]}
                if group != "InitialUnknowns":
                    unknown["dependencies"] = " ".join(
                        sorted((index_by_reference[i] for i in variable.depends_on), key=int)
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
        capabilities = {"canGetAndSetFMUState": "true", "canSerializeFMUState": "true"}
        for kind, kind_attributes in (
            ("ModelExchange", {}),
            ("CoSimulation", {"canHandleVariableCommunicationStepSize": "true"}),
        ):
            attributes = _format_attributes(
                modelIdentifier=self.identifier, **capabilities, **kind_attributes
            )
            yield f"  <{kind}{attributes}/>"
        yield from self._units("Unit")
        yield "  <ModelVariables>"
        for variable in self.variables:
            start = None if variable.start is None else repr(variable.start)
            minimum_text = None if variable.minimum is None else repr(variable.minimum)
            of = None if variable.derivative_of is None else str(variable.derivative_of)
            numbers = {"unit": variable.unit, "derivative": of, "min": minimum_text, "start": start}
            yield f"    <Float64{_format_attributes(**_get_attributes(variable), **numbers)}/>"
        yield "  </ModelVariables>"
        yield "  <ModelStructure>"
        for kind, variables in (
            ("Output", self.outputs), ("ContinuousStateDerivative", self.derivatives),
            ("InitialUnknown", self.initial_unknowns),
        ):  # fmt: skip
            for variable in variables:
                unknown = {"valueReference": str(variable.reference)}
                if kind != "InitialUnknown":
                    unknown["dependencies"] = " ".join(map(str, sorted(variable.depends_on)))
                yield f"    <{kind}{_format_attributes(**unknown)}/>"
        yield "  </ModelStructure>"
        yield "</fmiModelDescription>"

    def _units(self, tag: str) -> Iterator[str]:
        """Iterate over the lines of the unit definitions, each unit by its factor to SI."""
        units = self.units
        stiffness, length, force = units.force / units.length, units.length, units.force
        unit_exponents: dict[str, tuple[dict[str, int], float]] = {
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
        used_units = {variable.unit for variable in self.variables}
        yield "  <UnitDefinitions>"
        for name, (powers, factor) in unit_exponents.items():
            if name in used_units:
                base = {"factor": repr(round(factor, 15))} if factor != 1 else {}
                words = _format_attributes(**{k: str(v) for k, v in powers.items()}, **base)
                yield f"    <{tag}{_format_attributes(name=name)}><BaseUnit{words}/></{tag}>"
        yield "  </UnitDefinitions>"


def _get_attributes(variable: Variable) -> dict[str, str | None]:
    return {
        "name": variable.name, "valueReference": str(variable.reference),
        "causality": variable.causality,
        "variability": variable.variability, "initial": variable.initial or None,
        "description": variable.description,
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
