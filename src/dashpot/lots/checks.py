"""What a batch of tests says of itself, as criteria with a sentence."""

from __future__ import annotations

from dashpot.base.checks import Finding, criterion


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
