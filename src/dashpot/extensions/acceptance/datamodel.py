"""Limits held against a result: each met, missed or open, and the word for the seal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

from dashpot.base import dataclass
from dashpot.base.checks import Use
from dashpot.base.number_format import MINUS, format_count, round_to_error
from dashpot.base.plain_text import sentence
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import Printable
from dashpot.base.serialisation import DIGEST, Key, Serialisable, compute_document_digest
from dashpot.extensions.acceptance.judgement import Outcome
from dashpot.extensions.acceptance.result_values import Spread

SealWord = Literal["meets", "misses", "open"]

_REPEATING = "Repeating the test does not decide it"
_OF_RIG = (
    "what remains is uncertainty of the rig, the same in every such test. Measure its delay, gain "
    "and drift with blank tests."
)
_MAX_DIGITS = 9


@dataclass(frozen=True)
class LimitAssessment(Serialisable):
    """Limits of one quantity, its value, and whether the 95 % interval keeps to them.

    Attributes
    ----------
    name : str
        As a lot calls it: ``"damping_ratio"``, ``"stiffness_at_40s"``.
    value : ReportedValue
    lower, upper : float or None
        SI.
    outcome : str
        ``"met"``, ``"missed"``, or ``"open"`` where the interval holds a limit.
    spread : str
        What the interval is of: ``"random"``, ``"bound"`` or ``"unknown"``.
    additional_tests, additional_tests_90 : int or None
        How many more tests like this one would decide it: if their mean lies where this value
        does, and with a chance of 90 % if this value is true. None where it is decided, and where
        no number of such tests does.
    remedy : str
        Test that would narrow a bound; empty where that is not known.
    is_usable : bool
        Whether the model may be used at all.
    stated : tuple of (str, str)
        Both limits with the unit in which they were stated; empty if there is none.
    """

    _keys = (
        "name",
        Key("unit", "value.unit"),
        "lower",
        "upper",
        Key("value", "value.value", nonfinite_as_null=True),
        Key("low", "value.low", nonfinite_as_null=True),
        Key("high", "value.high", nonfinite_as_null=True),
        "outcome",
        "spread",
        "additional_tests",
        "additional_tests_90",
        Key("message", "explanation"),
    )

    name: str
    value: ReportedValue
    lower: float | None
    upper: float | None
    outcome: Outcome
    spread: Spread
    additional_tests: int | None = None
    additional_tests_90: int | None = None
    remedy: str = ""
    is_usable: bool = True
    stated: tuple[str, str] = ("", "")

    @property
    def request(self) -> str:
        """Requested limit as text, such as 'damping ratio at least 3 %'."""
        return f"{self.value.label} {self.limit_text}"

    @property
    def limit_text(self) -> str:
        """The limits in the unit of their statement: 'at least 10 years', '0.18 to 0.22 N/mm'."""
        limit_texts = [
            text or f"{self.value.to_display_unit(end):.10g} {self.value.word}".rstrip()
            for end, text in zip((self.lower, self.upper), self.stated, strict=True)
            if end is not None
        ]
        words = "" if len(limit_texts) == 2 else "at most " if self.lower is None else "at least "
        if len({text.partition(" ")[2] for text in limit_texts}) == 1:
            limit_texts[0] = (
                limit_texts[0].partition(" ")[0] if len(limit_texts) == 2 else limit_texts[0]
            )
        return f"{words}{' to '.join(limit_texts)}"

    @property
    def cell_texts(self) -> tuple[str, str, str]:
        """Value and interval as cells, no end of which is rounded to the other side of a limit.

        An end of 291,000 h that is shown as 300,000 h would contradict "open" at 295,000 h.
        """
        reported_value = self.value
        texts = zip(
            reported_value.cell_texts,
            (reported_value.value, reported_value.low, reported_value.high),
            strict=True,
        )
        value, low, high = (self._round_to_side(text, number) for text, number in texts)
        return value, low, high

    def _round_to_side(self, text: str, number: float) -> str:
        """Return a rounded number with as many digits as show on which side of the limits it is."""
        limits = [end for end in (self.lower, self.upper) if end is not None]
        display_value = self.value.to_display_unit(number)
        edges = [self.value.to_display_unit(end) for end in limits]

        def is_on_its_side(text: str) -> bool:
            try:
                rounded_value = float(text.replace(MINUS, "-").replace(",", ""))
            except ValueError:  # no number, such as "no limit"
                return True
            return all(
                (rounded_value > edge) == (display_value > edge)
                for edge in edges
                if edge != display_value
            )

        digits = 3
        while not is_on_its_side(text) and digits < _MAX_DIGITS:
            text, digits = round_to_error(display_value, digits=digits), digits + 1
        return text

    @property
    def explanation(self) -> str:
        """Sentence on the test that would decide an open limit; empty if it is decided."""
        if self.outcome != "open":
            return ""
        if not self.is_usable:
            return "The model is not to be used, so its values decide nothing."
        if self.spread == "bound":
            return f"{_REPEATING}: its interval is a bound, not scatter. {self.remedy}".rstrip()
        if self.spread == "unknown":
            return "How many tests decide it is not known: the value has no standard error."
        if self.additional_tests is None:
            if self.remedy:
                return f"{_REPEATING}. {self.remedy}"
            return f"{_REPEATING}: {_OF_RIG}"
        count = format_count(self.additional_tests, "further test")
        text = f"{sentence(count)[:-1]} would decide it if the mean stays here"
        if self.additional_tests_90 is None:
            return f"{text}. {self.remedy or sentence(_OF_RIG)}"
        return f"{text}, {self.additional_tests_90} with a chance of 90 %."


@dataclass(frozen=True)
class Acceptance(Printable, Serialisable):
    """Limits compared with one result: the decision on the seal, not on the model.

    Attributes
    ----------
    result : Study, Fit or another result
        Result that was compared with the limits.
    use : str
        The verdict on the model.
    limits : tuple of LimitAssessment
    """

    schema = "dashpot/acceptance@1"
    _keys = (
        Key("model", "use"),
        Key("seal", "word"),
        Key("message", "headline"),
        "limits",
    )
    _is_loadable = False

    result: Any
    use: Use
    limits: tuple[LimitAssessment, ...]

    @property
    def word(self) -> SealWord:
        """Decision on the seal: missed if one limit is missed, met if all are met, else open."""
        outcomes = self._outcomes
        if "missed" in outcomes:
            return "misses"
        return "open" if "open" in outcomes else "meets"

    @property
    def _outcomes(self) -> Sequence[Outcome]:
        return [limit.outcome for limit in self.limits]

    @property
    def explanations(self) -> dict[str, str]:
        """Sentences on what would decide the open limits, each with the names of its values."""
        names: dict[str, list[str]] = {}
        for limit in self.limits:
            if limit.explanation:
                names.setdefault(limit.explanation, []).append(limit.value.label)
        return {text: ", ".join(labels) for text, labels in names.items()}

    @property
    def checks(self) -> tuple[()]:
        """None: a limit is no check of the model."""
        return ()

    @property
    def headline(self) -> str:
        """The seal's word in a sentence, with how many limits are missed and open."""
        limit_count, missed_count, still_open = (
            len(self.limits), self._outcomes.count("missed"), self._outcomes.count("open")
        )  # fmt: skip
        limits = "the limit" if limit_count == 1 else f"all {limit_count} limits"
        if self.word == "meets":
            return f"meets {limits}"
        limits_text = "the limit" if limit_count == 1 else f"{missed_count} of {limit_count} limits"
        text = [f"misses {limits_text}"] if missed_count else []
        if still_open:
            count = "the limit" if limit_count == 1 else f"{still_open} of {limit_count} limits"
            verb = "is" if still_open == 1 else "are"
            text.append(f"{still_open} {verb} open" if missed_count else f"open at {count}")
        return ", ".join(text)

    @property
    def title(self) -> str:
        """Both verdicts in one sentence: that of the model and that of the seal."""
        model = {
            "use": "The model holds",
            "use with care": "The model holds with care",
            "do not use": "The model is not to be used",
        }[self.use]
        seal = {
            "meets": "the seal meets what was asked",
            "misses": "the seal does not meet what was asked",
            "open": "whether the seal meets what was asked is open",
        }[self.word]
        conjunction = "and" if (self.use == "do not use") == (self.word != "meets") else "; "
        return f"{model}{f' {conjunction} ' if conjunction == 'and' else conjunction}{seal}"


@dataclass(frozen=True)
class AcceptanceResult(Serialisable):
    """Result with its acceptance, as one document.

    Attributes
    ----------
    result : Serialisable
    acceptance : Acceptance
    """

    result: Serialisable
    acceptance: Acceptance

    def to_dict(self) -> dict[str, Any]:
        """Return the document of the result, with the key ``"acceptance"``."""
        entries = self.result.to_dict()
        has_digest = entries.pop(DIGEST, None) is not None
        entries["acceptance"] = self.acceptance.to_dict()
        return {**entries, DIGEST: compute_document_digest(entries)} if has_digest else entries
