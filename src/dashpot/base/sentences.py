"""Sentences that people read: how they begin, end, follow each other, and how long they may be."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

_END = re.compile(r"(?<=[.?!])(?<!eq\.)(?<!e\.g\.) (?=[A-Z\d])")
# "eq. 5" ends nothing; "k_inf" and "seal.csv" are names, and keep their letters
_WORD = re.compile(r"(?!tau\b)(?:a|[a-z]{2,})(?=[\s,;:?!'-]|\.(?:\s|$)|$)")
_NAMES = re.compile(r"Maxwell|Poisson|Zener|Ogden|Mooney|Neo|Hertz|Prony|Arrhenius|Table|Cpk|Hz")
"""What is written with a capital within a sentence, too."""


def sentence(text: str) -> str:
    """Return a text that begins with a capital and ends with a stop.

    >>> sentence("the hold is too short"), sentence("k_inf is not known."), sentence("which file?")
    ('The hold is too short.', 'k_inf is not known.', 'Which file?')
    >>> sentence("a hold is needed"), sentence("c is not known")
    ('A hold is needed.', 'c is not known.')
    """
    if not text:
        return ""
    if _WORD.match(text):
        text = text[0].upper() + text[1:]
    return text if text.endswith((".", "?", "!")) else f"{text}."


def paragraph(*parts: str) -> str:
    """Return texts one after another, each as a sentence; those that are empty are left out."""
    return " ".join(sentence(part) for part in parts if part)


def decapitalise_sentence(text: str) -> str:
    """Return a sentence as it goes on after a colon or a comma.

    >>> decapitalise_sentence("The hold is too short."), decapitalise_sentence(
    ...     "FRF lines are missing."), decapitalise_sentence("Maxwell arm")
    ('the hold is too short.', 'FRF lines are missing.', 'Maxwell arm')
    """
    first = re.match(r"(?:A|[A-Z][a-z]+)(?=[\s,;:'-])", text)
    if first is None or _NAMES.match(text):
        return text
    return text[0].lower() + text[1:]


def sentences(text: str) -> list[str]:
    """Return the sentences of a text.

    >>> sentences("The hold is short. It lasts 3 s (eq. 5). 10 are needed.")
    ['The hold is short.', 'It lasts 3 s (eq. 5).', '10 are needed.']
    """
    return _END.split(text) if text else []


def count_words(text: str) -> int:
    """Return how many words a text has; a number and its unit are two."""
    return len(text.split())


def clip_sentences(most: int, lines: Sequence[str], after: Iterable[str] = ()) -> str:
    """Return as many sentences of `lines` as leave room for all of `after`, but one at least."""
    end = [name for name in after if name]
    retained = list(lines)
    while len(retained) > 1 and count_words(" ".join((*retained, *end))) > most:
        retained.pop()
    return " ".join((*retained, *end))
