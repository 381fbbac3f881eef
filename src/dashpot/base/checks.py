"""Named pass/fail checks: the register of criteria, and the answer to one of them in words."""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import dataclass
from types import EllipsisType
from typing import Generic, NamedTuple, ParamSpec

P = ParamSpec("P")

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
class Check:
    """One named question put to a record or a result, and its answer in words.

    Attributes
    ----------
    name : str
        Stable identifier, ``snake_case``.
    passed : bool
        The answer.
    value, limit : float or None
        What was measured and what it was held against (None where there is no number).
    says : str
        The sentence the user reads: what was found, what it means, what to do.
    """

    name: str
    passed: bool
    says: str
    value: float | None = None
    limit: float | None = None


class Finding(NamedTuple):
    """What a criterion found, before its limit decides.

    Attributes
    ----------
    says : str
        What was found.
    value : float or None
        What is held against the limit; None, which passes, if nothing was measured.
    but : str
        What follows `says` if the check fails.
    instead : str
        What replaces `says` if it fails.
    limit : float or None
        The limit where the record sets it; by default that of the criterion.
    excused : bool
        Passes whatever the value: the question matters to this record or method no more.
    faulted : bool
        Fails whatever the value: a second condition is broken.
    """

    says: str
    value: float | None = None
    but: str = ""
    instead: str = ""
    limit: float | EllipsisType | None = ...
    excused: bool = False
    faulted: bool = False


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
        than one number, whose finding is excused or fails.
    limit : float or None
        None if the record sets it.
    source : str
        Where the limit comes from.
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
    judge: Callable[P, Finding]

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> Check:
        """Return the answer; here alone a value meets its limit."""
        found = self.judge(*args, **kwargs)
        limit = self.limit if isinstance(found.limit, EllipsisType) else found.limit
        passed = not found.faulted and (found.excused or self._holds(found.value, limit))
        says = found.says if passed else (found.instead or found.says) + found.but
        return Check(self.name, passed, says, found.value, limit)

    def _holds(self, value: float | None, limit: float | None) -> bool:
        if value is None or limit is None:
            return True
        return self.rule in RULES and bool(RULES[self.rule](value, limit))


#: every criterion whose `checks` file has been imported, by stage and name
REGISTER: dict[tuple[str, str], Criterion[...]] = {}


def criterion(
    measure: str = "",
    rule: str = "",
    limit: float | None = None,
    source: str = "our choice",
    *,
    name: str = "",
    question: str = "",
) -> Callable[[Callable[P, Finding]], Criterion[P]]:
    """Enter a judging function into the register, as a decorator.

    Parameters
    ----------
    measure, rule, limit, source
        As in `Criterion`.
    name, question : str
        By default the function's name and the first line of its docstring.
    """

    def enter(judge: Callable[P, Finding]) -> Criterion[P]:
        stage = judge.__module__.removeprefix("dashpot.").removesuffix(".checks").replace(".", "/")
        asks = question or (judge.__doc__ or "").strip().partition("\n")[0]
        made = Criterion(name or judge.__name__, stage, asks, measure, rule, limit, source, judge)
        if (stage, made.name) in REGISTER:
            raise ValueError(f"{stage} has two criteria {made.name}; expected one of each name")
        REGISTER[stage, made.name] = made
        return made

    return enter
