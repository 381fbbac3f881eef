"""Texts of results for the page: controls in place of command-line options."""

from __future__ import annotations

import re

_OPTION = re.compile(r"(?<![\w-])--[a-z]|\bPython\b|\bdashpot\.|\bpip install\b")
_WORD = re.compile(r"""\s*(?<![\w-])--[a-z][\w-]*(?:[ =](?:"[^"]*"|[^\s,;.()]*=[^\s;()]*))?""")
_PARENTHESES = re.compile(r"\s*\([^()]*\)")
_PARTS = re.compile(r"(; |: |\. )")


def format_for_page(sentence: str) -> str:
    """Return a refusal without advice for the command line or Python.

    >>> format_for_page("no unit of force; add --units force=N, or write it into the header")
    'no unit of force'
    >>> format_for_page("two tests; choose one (--file-part), or --rate 1Hz: dashpot batch FILE")
    'two tests'
    >>> format_for_page("widen --band")
    'widen the choice on this page'
    """
    if not _OPTION.search(sentence):
        return sentence
    without_brackets = _PARENTHESES.sub(
        lambda match: "" if _OPTION.search(match[0]) else match[0], sentence
    )
    parts = _PARTS.split(without_brackets)
    kept_parts, is_left_out = [parts[0]], False
    for sign, part in zip(parts[1::2], parts[2::2], strict=True):
        # what follows a colon is of what stands before it
        is_left_out = bool(_OPTION.search(part)) or (is_left_out and sign == ": ")
        if not is_left_out:
            kept_parts += [sign, part]
    if _OPTION.search(kept_parts[0]):
        kept_parts = kept_parts[2:] or kept_parts
    return _WORD.sub(" the choice on this page", "".join(kept_parts)).strip()
