"""Named checks with criteria and limits, and the verdict over several checks."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterable, Mapping
from types import EllipsisType
from typing import Generic, Literal, NamedTuple, ParamSpec, get_args

from dashpot.base import dataclass, field, replace
from dashpot.base.errors import Status
from dashpot.base.number_format import expand_powers
from dashpot.base.plain_text import (
    clip_sentences,
    decapitalise_sentence,
    paragraph,
    sentence,
    sentences,
)
from dashpot.base.serialisation import Key, Serialisable

P = ParamSpec("P")

#: meaning of a failed check: a remark, a limit of use, a result not to be used
Grade = Literal["note", "limit", "stop"]
GRADES: tuple[Grade, ...] = get_args(Grade)
#: what to make of a result
Use = Literal["use", "no test", "use with care", "do not use"]

#: comparison of a value with its limit; ``"|x| <="``: of its magnitude, ``"x/"``: of its ratio
#: to one
RULES: dict[str, Callable[[float, float], bool]] = {
    "<=": operator.le,
    "<": operator.lt,
    ">=": operator.ge,
    ">": operator.gt,
    "==": operator.eq,
    "|x| <=": lambda value, limit: abs(value) <= limit,
    "x/": lambda value, limit: 1 / limit <= value <= limit,
}


MAX_WORDS = 35
"""Longest verdict, in words, with its *use*."""
MAX_MESSAGE_WORDS = MAX_WORDS - 3
"""Longest message after *do not use*, in words."""


@dataclass(frozen=True)
class Remedy(Serialisable):
    """Remedy of a failed check, as text and as an option.

    Attributes
    ----------
    words : str
        Sentences that begin with the verb: ``"Hold longer, or ramp faster."``
    option : str
        The long option of the command line that does it, without its dashes: ``"band"``; empty
        where only another test helps. A page names its own control instead.
    value : str
        What to give the option, where that is known.
    """

    _keys = ("words", "option", "value")

    words: str
    option: str = ""
    value: str = ""

    @property
    def command_option(self) -> str:
        """The option as it is typed: ``"--band 1:25Hz"``; empty if there is none."""
        return f"--{self.option} {self.value}".rstrip() if self.option else ""


@dataclass(frozen=True)
class Check(Serialisable):
    """Named question about a record or result, with its answer as text.

    Attributes
    ----------
    name : str
        Stable identifier, ``snake_case``.
    passed : bool or None
        The answer; None if the record gives none: not checked.
    value, limit : float or None
        The measured value and its limit (None where there is no number).
    message : str
        The sentences the user reads: what was found and what it means. They name no option, so that
        terminal, page and app show the same text.
    grade : str
        What a failure means: ``"note"``, it does not matter to the result; ``"limit"``, use it
        with care; ``"stop"``, do not use it.
    remedy : Remedy or None
        Remedy of a failure.
    fit_status : Status or None
        Status of a fit that fails it; neither saved nor compared.

    Examples
    --------
    >>> import dashpot as dp
    >>> check = dp.Check("hold", False, "The hold is short.", value=2.0, limit=10.0)
    >>> check.failed, check.grade
    (True, 'limit')
    """

    _keys = ("name", "passed", "grade", "value", "limit", "message", "remedy")

    name: str
    passed: bool | None
    message: str
    value: float | None = None
    limit: float | None = None
    grade: Grade = "limit"
    remedy: Remedy | None = None
    fit_status: Status | None = field(default=None, repr=False, compare=False)

    @property
    def failed(self) -> bool:
        """True if it was judged and did not pass."""
        return self.passed is False

    @property
    def message_with_remedy(self) -> str:
        """Finding of the check, and its remedy."""
        return paragraph(self.message, self.remedy.words if self.remedy else "")

    @property
    def message_with_option(self) -> str:
        """`message_with_remedy`, and the option that does it as a command line takes it."""
        option = self.remedy.command_option if self.remedy else ""
        return f"{self.message_with_remedy} ({option})" if option else self.message_with_remedy

    def with_location(self, location: str) -> Check:
        """Return the check with a location, such as "in test 2", before its message."""
        return replace(
            self, message=f"{sentence(location)[:-1]}, {decapitalise_sentence(self.message)}"
        )


@dataclass(frozen=True)
class Verdict(Serialisable):
    """Verdict on a result: whether and how to use it.

    Attributes
    ----------
    use : str
        ``"use"``, ``"use with care"``, ``"do not use"``, or ``"no test"`` where nothing was tested.
    message : str
        The sentences that lead every report of the result: the number its reader came for and
        where it holds; or why not, and what to do.
    failed_checks : tuple of Check
        The failed checks that decided, the gravest first.

    Examples
    --------
    >>> import dashpot as dp
    >>> dp.Verdict("use", "from 0.004 to 25 Hz").use
    'use'
    """

    _keys = (Key("verdict_grade", "use"), "message", Key("failed_checks", "reasons"))

    use: Use
    message: str
    failed_checks: tuple[Check, ...] = ()

    @property
    def reasons(self) -> tuple[str, ...]:
        """The names of the checks that decided."""
        return tuple(check.name for check in self.failed_checks)

    def __str__(self) -> str:
        return f"{self.use.capitalize()}: {decapitalise_sentence(self.message)}"


def format_check_tally(checks: Iterable[Check]) -> str:
    """Return how many of some checks passed and failed, in a sentence; empty if none was judged."""
    checks_with_result = [check for check in dict.fromkeys(checks) if check.passed is not None]
    passed_count = sum(bool(check.passed) for check in checks_with_result)
    notes = sum(check.failed and check.grade == "note" for check in checks_with_result)
    failed = len(checks_with_result) - passed_count - notes
    if not checks_with_result:
        return ""
    if passed_count == len(checks_with_result) > 1:
        return f"All {passed_count} checks passed."
    noun = f" check{'s' * ((passed_count or failed) > 1)}"
    parts = [f"{passed_count}{noun} passed"] if passed_count else []
    parts += [f"{failed}{'' if passed_count else noun} failed"] if failed else []
    parts += [f"{notes} note{'s' * (notes > 1)}"] if notes else []
    return f"{', '.join(parts)}."


def verdict(checks: Iterable[Check], *, headline: str = "") -> Verdict:
    """Return the verdict of some checks: of the gravest that failed.

    Parameters
    ----------
    checks : iterable of Check
    headline : str
        Sentence for a result without a failed limit or stop: the main number, and the range in
        which it is valid. How many checks passed follows, and is all where nothing is given.
    """
    all_checks = tuple(checks)
    failed = [check for check in all_checks if check.failed]
    stop_checks = tuple(check for check in failed if check.grade == "stop")
    limits = tuple(check for check in failed if check.grade == "limit")
    failed_checks = stop_checks + limits
    if not failed_checks:
        lines = [*sentences(sentence(headline)), format_check_tally(all_checks)]
        return Verdict("use", clip_sentences(MAX_WORDS - 1, [line for line in lines if line]))
    use: Use = "do not use" if stop_checks else "use with care"
    other_count = len(failed_checks) - 1
    other_text = f"{other_count} more check{'s' * (other_count > 1)} failed." if other_count else ""
    message = format_short_message(failed_checks[0], MAX_MESSAGE_WORDS, other_text)
    if stop_checks or re.search(r"\d", message):
        return Verdict(use, message, failed_checks)
    # the number is shown to a reader who may use it
    first_sentence = sentences(sentence(headline))[:1]
    return Verdict(
        use,
        clip_sentences(MAX_MESSAGE_WORDS, [*first_sentence, *sentences(message)]),
        failed_checks,
    )


def format_short_message(
    check: Check, max_words: int = MAX_MESSAGE_WORDS, closing: str = ""
) -> str:
    """Return the message of a check and its remedy in at most `max_words` words.

    The explanation, and all but the first sentence of the remedy, are left out first.
    """
    remedy = sentences(check.remedy.words) if check.remedy else []
    short = clip_sentences(max_words, sentences(sentence(check.message)), (*remedy[:1], closing))
    clipped = clip_sentences(max_words, sentences(sentence(check.message)), (*remedy, closing))
    return clipped if len(clipped.split()) <= max_words else short


class HasChecks:
    """Base class of results with `checks`."""

    checks: tuple[Check, ...]

    @property
    def _headline(self) -> str:
        """The number that its reader came for and where it holds, in a sentence."""
        raise NotImplementedError

    @property
    def verdict(self) -> Verdict:
        """The verdict over `checks`."""
        return verdict(self.checks, headline=self._headline)


def select_fit_status(
    checks: Iterable[Check], optimum_statuses: Mapping[Status, bool] | None = None
) -> Status:
    """Return the status of a fit: the worst that its failed checks and its optimum set.

    Parameters
    ----------
    checks : iterable of Check
        Their criteria may set a status.
    optimum_statuses : mapping of Status to bool, optional
        Whether the optimum itself sets a status.
    """
    statuses = {check.fit_status for check in checks if check.failed}
    statuses |= {status for status, applies in (optimum_statuses or {}).items() if applies}
    return next((status for status in reversed(Status) if status in statuses), Status.CONVERGED)


def select_gravest_check(checks: Iterable[Check]) -> Check:
    """Return one check of one question to several tests: the gravest, with its test's number."""
    all_checks = tuple(checks)
    failed = [
        (GRADES.index(check.grade), -number, check)
        for number, check in enumerate(all_checks, start=1)
        if check.failed
    ]
    if not failed or len(all_checks) == 1:
        return next((check for check in all_checks if check.passed is not None), all_checks[0])
    _, number, check = max(failed, key=lambda pair: pair[:2])
    return check.with_location(f"in test {-number} of {len(all_checks)}")


class Finding(NamedTuple):
    """Measured value and text of a criterion, before its limit is applied.

    Attributes
    ----------
    message : str
        Finding, in a sentence.
    value : float or None
        Compared with the limit; None if nothing was measured: a criterion with a measure is then
        not checked.
    reason : str
        What it means, if the check fails: sentences that follow `message`.
    remedy : Remedy or str
        What to do then.
    failure : str
        Replaces `message` if the check fails.
    limit : float or None
        The limit where it depends on the record; by default the limit of the criterion.
    always_passes : bool
        Passes whatever the value: another condition answers the question.
    always_fails : bool
        Fails whatever the value: a second condition is broken.
    grade : str or None
        Grade of a failure where it depends on the record; by default the grade of the criterion.
    """

    message: str
    value: float | None = None
    reason: str = ""
    remedy: Remedy | str = ""
    failure: str = ""
    limit: float | EllipsisType | None = ...
    always_passes: bool = False
    always_fails: bool = False
    grade: Grade | None = None

    @property
    def advice(self) -> Remedy | None:
        """The remedy, its words as sentences; None if there is none."""
        remedy = Remedy(self.remedy) if isinstance(self.remedy, str) else self.remedy
        return (
            replace(remedy, words=sentence(expand_powers(remedy.words))) if remedy.words else None
        )


@dataclass(frozen=True, eq=False)
class Criterion(Generic[P]):
    """Criterion: a question with its limit, called like the function that measures.

    Attributes
    ----------
    name : str
        Name of the checks that it makes.
    stage : str
        Stage of the work to which the criterion belongs.
    question : str
        What holds if the check passes.
    measure : str
        What the value is.
    rule : str
        A key of `RULES`: how the value is held against the limit; none for a question of more
        than one number, whose finding passes unless `always_fails`.
    limit : float or None
        None if the limit depends on the record.
    source : str
        Where the limit comes from.
    grade : str
        What a failure means, as in `Check`.
    other_grade : str
        Where a failure means another, in words: ``"stop beyond 10"``.
    fit_status : Status or None
        Status of a fit that fails it; None if the optimum is valid all the same.
    evaluate : callable
        Returns a `Finding`.
    """

    name: str
    stage: str
    question: str
    measure: str
    rule: str
    limit: float | None
    source: str
    grade: Grade
    other_grade: str
    fit_status: Status | None
    evaluate: Callable[P, Finding]

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> Check:
        """Return the answer; here alone a value meets its limit."""
        finding = self.evaluate(*args, **kwargs)
        limit = self.limit if isinstance(finding.limit, EllipsisType) else finding.limit
        passed = self._evaluate_rule(finding, limit)
        text, remedy = finding.message, None
        if passed is False:
            text = paragraph(finding.failure or finding.message, finding.reason)
            remedy = finding.advice
        return Check(
            self.name, passed, expand_powers(sentence(text)), finding.value, limit,
            finding.grade or self.grade, remedy, self.fit_status,
        )  # fmt: skip

    def _evaluate_rule(self, finding: Finding, limit: float | None) -> bool | None:
        if finding.always_fails or finding.always_passes:
            return not finding.always_fails
        if not self.rule:
            return None if self.measure and finding.value is None else True
        if finding.value is None or limit is None:
            return None
        return bool(RULES[self.rule](finding.value, limit))


#: every criterion whose `checks` file has been imported, by stage and name
REGISTER: dict[tuple[str, str], Criterion[...]] = {}


def criterion(
    measure: str = "",
    rule: str = "",
    limit: float | None = None,
    source: str = "our choice",
    *,
    grade: Grade = "limit",
    other_grade: str = "",
    fit_status: Status | None = None,
    name: str = "",
    question: str = "",
) -> Callable[[Callable[P, Finding]], Criterion[P]]:
    """Enter a judging function into the register, as a decorator.

    Parameters
    ----------
    measure, rule, limit, source, grade, other_grade, fit_status
        As in `Criterion`.
    name, question : str
        By default the function's name and the first line of its docstring.
    """

    def register(evaluate: Callable[P, Finding]) -> Criterion[P]:
        stage = _stage(evaluate.__module__)
        text = question or (evaluate.__doc__ or "").strip().partition("\n")[0]
        check_name = name or evaluate.__name__
        new_criterion = Criterion(
            check_name,
            stage,
            text,
            measure,
            rule,
            limit,
            source,
            grade,
            other_grade,
            fit_status,
            evaluate,
        )
        if (stage, new_criterion.name) in REGISTER:
            raise ValueError(
                f"{stage} has two criteria {new_criterion.name}; expected one of each name"
            )
        REGISTER[stage, new_criterion.name] = new_criterion
        return new_criterion

    return register


def _stage(module: str) -> str:
    """Return the package that a module of checks belongs to, as a path under dashpot."""
    package = re.sub(r"\.(\w+_)?checks\b.*", "", module.removeprefix("dashpot."))
    return package.replace(".", "/")
