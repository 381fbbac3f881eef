"""What a batch of tests says of itself, as criteria with a sentence."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.capability import Capability
from dashpot.base.checks import Finding, criterion
from dashpot.base.numbers import counted


@criterion("files without a fit", "<=", 0, "by definition")
def files_fitted(without: int, files: int) -> Finding:
    """Every file of a batch is a test that was fitted."""
    return Finding(
        f"{files - without} of {files} files are tests that were fitted",
        without,
        ": the table has the reason of each other one, or the command that wants it",
    )


@criterion("fits not to be used", "<=", 0, "by definition")
def fits_usable(unusable: int, fitted: int) -> Finding:
    """No fit of a batch has the verdict "do not use"."""
    return Finding(
        f"{unusable} of {fitted} fits have the verdict 'do not use'",
        unusable,
        ": the table has the reason, and the checks that failed, of each",
    )


@criterion("hammers not compared", "<=", 0, "by definition")
def hammers_compared(without: int, paired: int) -> Finding:
    """Every hammer of a batch was held against the test that it is paired with."""
    return Finding(
        f"{paired - without} of {paired} hammers were held against their tests",
        without,
        ": the table has the reason of each other one",
    )


@criterion("tests made otherwise", "<=", 0, "by definition")
def tests_alike(unlike: int, tests: int) -> Finding:
    """Tests of a lot have one hold and depth, within 5 %, and one temperature, within 3 K."""
    return Finding(
        f"{tests - unlike} of {tests} fits are of tests that were made alike",
        unlike,
        ": the others, which the page names, are left out of the lot's statistics",
    )


@criterion("records given again", "<=", 0, "by definition")
def records_distinct(again: int, tests: int) -> Finding:
    """Every test that is used is a record of its own: a copy says nothing that it did not say."""
    return Finding(
        f"{tests - again} of {tests} fits are of records of their own",
        again,
        ": the others are copies of these, which makes scatter and intervals too small; leave them "
        "out",
    )


@criterion("seals that do not pass", "<=", 0, "ISO 14253-1:2017, simple acceptance is not enough")
def seals_within_limits(words: str, limits: str, decisions: Sequence[str]) -> Finding:
    """Every seal is inside the limits that are asked for by more than its guard band."""
    counts = {one: decisions.count(one) for one in ("fail", "not proven", "no result")}
    said = {
        "fail": "outside", "not proven": "inside by less than the guard band",
        "no result": "without a value that is used",
    }  # fmt: skip
    broken = ", ".join(f"{count} {said[one]}" for one, count in counts.items() if count)
    passed, every = decisions.count("pass"), len(decisions)
    return Finding(
        f"{passed} of {every} seals pass: {words} {limits}",
        every - passed,
        f"; {broken}",
    )


@criterion("Cpk", ">=", None, "asked for with the limits")
def capability_as_asked(
    words: str, lowest: tuple[str, Capability] | None, unknown: int, asked: float
) -> Finding:
    """The Cpk of every lot is known, and the lowest is as high as is asked for."""
    if lowest is None or unknown:
        return Finding(
            "",
            instead=f"Cpk of {words}, where {asked:.2f} is asked, is not known of "
            f"{counted(unknown, 'lot')}: test two seals of each, at least, that differ",
            limit=asked,
            faulted=True,
        )
    lot, of = lowest
    low, high = of.cpk_interval or (0.0, 0.0)
    where = f" of lot {lot}" if lot else ""
    return Finding(
        f"Cpk of {words}{where} is {of.cpk:.2f} ({low:.2f} to {high:.2f}, {of.count} seals) "
        f"where {asked:.2f} is asked",
        of.cpk,
        ": test more seals" if high >= asked else ": the seals scatter too much, or lie off centre",
        limit=asked,
    )


@criterion("seals and tests", "<=", 0, "Iglewicz and Hoaglin (1993), for few values wider",
           grade="note")  # fmt: skip
def stands_out_of_lot(out: int, seals: int) -> Finding:
    """No seal of a lot, and no test of a seal, stands out of the others."""
    return Finding(f"{out} of {seals} seals or their tests stand out", out, ": look at them")


@criterion("tests beyond their band", "<=", 0, "by definition")
def asked_in_band(frequencies: Sequence[float], tests: int) -> Finding:
    """The frequencies at which stiffness and loss are asked for are those that the tests inform."""
    where = ", ".join(f"{one:g}" for one in frequencies)
    return Finding(
        "the tests inform the frequencies that are asked for",
        tests,
        instead=f"{where} Hz lies beyond the band of {tests} tests: stiffness and loss there are "
        "extrapolated; a faster ramp or a hammer test would tell",
    )


@criterion("conditions that differ", "<=", 0, "by definition")
def lots_tested_alike(otherwise: Sequence[str]) -> Finding:
    """Two lots were tested alike: hold, depth and ramp within 5 %, temperature within 3 K."""
    return Finding(
        "the lots were tested alike",
        len(otherwise),
        instead=f"the lots were not tested alike ({'; '.join(otherwise)}): what differs may be the "
        "testing",
    )


@criterion("tests without a seal", "<=", 0, "by definition")
def seals_named(unnamed: int, tests: int) -> Finding:
    """Of every test it is known which seal it is of: repeats of one do not count as seals."""
    return Finding(
        f"{tests - unnamed} of {tests} tests name their seal",
        unnamed,
        ": each other one counts as a seal, which makes intervals too short if any were repeats; "
        "name them (--by or --manifest)",
    )
