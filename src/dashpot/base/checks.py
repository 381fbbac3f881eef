"""Named checks: the register of criteria, each answer in words, and the verdict of them all."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from types import EllipsisType
from typing import Generic, Literal, NamedTuple, ParamSpec, get_args

from dashpot.base.documents import Documented
from dashpot.base.numbers import spelled
from dashpot.base.status import Status

P = ParamSpec("P")

#: what a failed check means: no matter, a limit of the result, a result not to be used
Grade = Literal["note", "limit", "stop"]
GRADES: tuple[Grade, ...] = get_args(Grade)
#: what to make of a result
Use = Literal["use", "use with care", "do not use"]

#: how a value is held against a limit; ``"|x| <="`` asks for its size, ``"x/"`` for a factor
RULES: dict[str, Callable[[float, float], bool]] = {
    "<=": operator.le,
    "<": operator.lt,
    ">=": operator.ge,
    ">": operator.gt,
    "==": operator.eq,
    "|x| <=": lambda value, limit: abs(value) <= limit,
    "x/": lambda value, limit: 1 / limit <= value <= limit,
}


@dataclass(frozen=True)
class Check(Documented):
    """One named question put to a record or a result, and its answer in words.

    Attributes
    ----------
    name : str
        Stable identifier, ``snake_case``.
    passed : bool or None
        The answer; None if the record gives none: not judged.
    value, limit : float or None
        What was measured and what it was held against (None where there is no number).
    says : str
        The sentence the user reads: what was found, what it means, what to do.
    grade : str
        What a failure means: ``"note"``, it does not matter to the result; ``"limit"``, use it
        with care; ``"stop"``, do not use it.
    ends : Status or None
        How a fit that fails it ended, as its criterion says; no document holds it, and no
        comparison of two checks.
    """

    keys = ("name", "passed", "says", "value", "limit", "grade")

    name: str
    passed: bool | None
    says: str
    value: float | None = None
    limit: float | None = None
    grade: Grade = "limit"
    ends: Status | None = field(default=None, repr=False, compare=False)

    @property
    def failed(self) -> bool:
        """True if it was judged and did not pass."""
        return self.passed is False


@dataclass(frozen=True)
class Verdict(Documented):
    """What to make of a result.

    Attributes
    ----------
    use : str
        ``"use"``, ``"use with care"`` or ``"do not use"``.
    says : str
        The sentence that leads every report of the result: why, and what would change it.
    because : tuple of Check
        The failed checks that decided, the gravest first.
    """

    keys = ("use", "says", "because=reasons")

    use: Use
    says: str
    because: tuple[Check, ...] = ()

    @property
    def reasons(self) -> tuple[str, ...]:
        """The names of the checks that decided."""
        return tuple(check.name for check in self.because)


def _others(count: int) -> str:
    return "" if count < 1 else f"; {count} more check{'s' * (count > 1)} failed"


def verdict(
    checks: Iterable[Check], *, sound: str = "nothing that was judged limits the use"
) -> Verdict:
    """Return the verdict of some checks: of the gravest that failed.

    Parameters
    ----------
    checks : iterable of Check
    sound : str
        What to say where nothing of weight failed.
    """
    failed = [check for check in checks if check.failed]
    stops = tuple(check for check in failed if check.grade == "stop")
    limits = tuple(check for check in failed if check.grade == "limit")
    use: Use = "do not use" if stops else "use with care" if limits else "use"
    because = stops + limits
    more = _others(len(because) - 1)
    return Verdict(use, because[0].says + more if because else sound, because)


class Checked:
    """A result that was asked whether it can be trusted: it has `checks`."""

    checks: tuple[Check, ...]

    @property
    def verdict(self) -> Verdict:
        """What to make of it."""
        return verdict(self.checks)


def status_of(checks: Iterable[Check], found: Mapping[Status, bool] | None = None) -> Status:
    """Return how a fit ended: the gravest of what its checks and its optimum say.

    Parameters
    ----------
    checks : iterable of Check
        Each that failed says how such a fit ends, if its criterion does.
    found : mapping of Status to bool, optional
        What the optimum itself shows, and no check asks.
    """
    said = {check.ends for check in checks if check.failed}
    said |= {status for status, shown in (found or {}).items() if shown}
    return next((status for status in reversed(Status) if status in said), Status.CONVERGED)


def worst(checks: Iterable[Check]) -> Check:
    """Return one check of one question to several tests: the gravest, with its test's number."""
    asked = tuple(checks)
    failed = [
        (GRADES.index(check.grade), -number, check)
        for number, check in enumerate(asked, start=1)
        if check.failed
    ]
    if not failed or len(asked) == 1:
        return next((check for check in asked if check.passed is not None), asked[0])
    _, number, check = max(failed, key=lambda one: one[:2])
    return replace(check, says=f"test {-number} of {len(asked)}: {check.says}")


class Finding(NamedTuple):
    """What a criterion found, before its limit decides.

    Attributes
    ----------
    says : str
        What was found.
    value : float or None
        What is held against the limit; None if nothing was measured: a criterion that has a
        measure then judges nothing.
    but : str
        What follows `says` if the check fails.
    instead : str
        What replaces `says` if it fails.
    limit : float or None
        The limit where the record sets it; by default that of the criterion.
    excused : bool
        Passes whatever the value: another condition answers the question.
    faulted : bool
        Fails whatever the value: a second condition is broken.
    grade : str or None
        What a failure means where the record decides it; by default that of the criterion.
    """

    says: str
    value: float | None = None
    but: str = ""
    instead: str = ""
    limit: float | EllipsisType | None = ...
    excused: bool = False
    faulted: bool = False
    grade: Grade | None = None


@dataclass(frozen=True, eq=False)
class Criterion(Generic[P]):
    """A question with the limit that decides it: called like the function that measures.

    Attributes
    ----------
    name : str
        Of the checks that it makes.
    stage : str
        Which part of the work asks.
    question : str
        What holds if the check passes.
    measure : str
        What the value is.
    rule : str
        A key of `RULES`: how the value is held against the limit; none for a question of more
        than one number, whose finding passes unless it is faulted.
    limit : float or None
        None if the record sets it.
    source : str
        Where the limit comes from.
    grade : str
        What a failure means, as in `Check`.
    otherwise : str
        Where a failure means another, in words: ``"stop beyond 10"``.
    ends : Status or None
        How a fit that fails it ended, whatever the grade; None if the optimum is none the worse.
    judge : callable
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
    otherwise: str
    ends: Status | None
    judge: Callable[P, Finding]

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> Check:
        """Return the answer; here alone a value meets its limit."""
        found = self.judge(*args, **kwargs)
        limit = self.limit if isinstance(found.limit, EllipsisType) else found.limit
        passed = self._passed(found, limit)
        says = (found.instead or found.says) + found.but if passed is False else found.says
        return Check(
            self.name, passed, spelled(says), found.value, limit, found.grade or self.grade,
            self.ends,
        )  # fmt: skip

    def _passed(self, found: Finding, limit: float | None) -> bool | None:
        if found.faulted or found.excused:
            return not found.faulted
        if not self.rule:
            return None if self.measure and found.value is None else True
        if found.value is None or limit is None:
            return None
        return bool(RULES[self.rule](found.value, limit))


#: every criterion whose `checks` file has been imported, by stage and name
REGISTER: dict[tuple[str, str], Criterion[...]] = {}


def criterion(
    measure: str = "",
    rule: str = "",
    limit: float | None = None,
    source: str = "our choice",
    *,
    grade: Grade = "limit",
    otherwise: str = "",
    ends: Status | None = None,
    name: str = "",
    question: str = "",
) -> Callable[[Callable[P, Finding]], Criterion[P]]:
    """Enter a judging function into the register, as a decorator.

    Parameters
    ----------
    measure, rule, limit, source, grade, otherwise, ends
        As in `Criterion`.
    name, question : str
        By default the function's name and the first line of its docstring.
    """

    def enter(judge: Callable[P, Finding]) -> Criterion[P]:
        stage = judge.__module__.removeprefix("dashpot.").partition(".checks")[0].replace(".", "/")
        asks = question or (judge.__doc__ or "").strip().partition("\n")[0]
        title = name or judge.__name__
        made = Criterion(
            title, stage, asks, measure, rule, limit, source, grade, otherwise, ends, judge
        )
        if (stage, made.name) in REGISTER:
            raise ValueError(f"{stage} has two criteria {made.name}; expected one of each name")
        REGISTER[stage, made.name] = made
        return made

    return enter
