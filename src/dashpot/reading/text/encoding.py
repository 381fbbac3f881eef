"""Which encoding a text is in: only the names and units depend on it, never the digits."""

from __future__ import annotations

import codecs
import re
from collections.abc import Callable, Iterable, Iterator

from dashpot.base.errors import ReadError
from dashpot.reading.columns import vocabulary

_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"), (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"),
)  # fmt: skip
_LONGEST = 1 << 23
_EIGHT_BIT = ("cp1252", "cp1250", "cp1254", "cp1251", "cp932", "cp949", "big5")


def find_encoding(head: bytes) -> str:
    """Return the codec for the first bytes of a text file.

    Byte-order marks, then UTF-16 by its zero bytes, then strict UTF-8, then the code page under
    which most of the words are words that a test machine says.
    """
    for mark, name in _MARKS:
        if head.startswith(mark):
            return name
    zeros = head.count(0) if 0 in head else 0
    if zeros > 0.2 * len(head):
        name = "utf-16-le" if head[1::2].count(0) >= head[0::2].count(0) else "utf-16-be"
        text = head[: len(head) // 2 * 2].decode(name, "replace")
        plain = sum(" " <= c < "\u02ff" or c in "\t\r\n" for c in text)
        return name if plain > 0.7 * len(text) else "utf-8"
    if head.isascii():
        return "utf-8"
    try:
        codecs.getincrementaldecoder("utf-8")().decode(head)
    except UnicodeDecodeError:
        return _code_page(head)
    return "utf-8"


def _code_page(head: bytes) -> str:
    # only lines with a letter beyond ASCII can tell, and the first few hundred are enough
    lines = head.splitlines()
    whole = lines[:-1] if len(lines) > 1 else lines  # the last may be cut within a character
    not_ascii = b"\n".join([line for line in whole if not line.isascii()][:200])
    scored = []
    for rank, name in enumerate(("gb18030", *_EIGHT_BIT)):
        try:
            text = not_ascii.decode(name)
        except UnicodeDecodeError:
            continue
        scored.append((_score_text(text, name), -rank, name))
    return max(scored)[2] if scored else "latin-1"


def _score_text(text: str, codec: str) -> float:
    """How much a decoded text reads like names and units of a lab."""
    words = (word for word in re.findall(r"[^\W\d_]+", text) if not word.isascii())
    score = sum((weight * count(word, codec) for word in words for weight, count in _WORDS), 0.0)
    return score + len(_UNITS.findall(text)) - 2.0 * len(_DEBRIS.findall(text))


def _eastern(word: str) -> int:
    return sum(c > "\u2e80" for c in word)


_WORDS: tuple[tuple[float, Callable[[str, str], float]], ...] = (
    (10.0, lambda word, _: word.casefold() in vocabulary.FIRST),
    # half a word in Chinese is a European word misread
    (-3.0, lambda word, _: 0 < _eastern(word) < max(2, len(word))),
    (1.0, lambda word, codec: codec == "gb18030" and _eastern(word) == len(word) > 1),
    (-0.5, lambda word, _: any(map(str.isupper, word[1:])) and any(map(str.islower, word))),
    (-0.2, lambda word, _: sum(c in "þðýÞÐÝ" for c in word)),
    (-0.3, lambda word, _: sum("\u0400" <= c <= "\u04ff" for c in word) * (len(word) < 3)),
)
"""What a word beyond ASCII tells of its code page, and how much."""
_UNITS = re.compile(r"(?:°[CF]?|[µμ][mNsV]|[ms][²³])(?![^\W\d_])")
_DEBRIS = re.compile(r"(?<=[^\W\d_])[³¹¿œŸž¡£¥]|[¤¦¨¸¯](?=\w)|[\x80-\x9f\ufffd\ue000-\uf8ff]")


def decode_blocks(
    blocks: Iterable[bytes], encoding: str, *, detected: bool = False
) -> Iterator[str]:
    """Decode blocks of bytes to text with one kind of line end, each ending with a line end.

    Where the encoding was `detected`, not given, a stray byte becomes a question mark: it stands in
    a word, never in a number.

    Raises
    ------
    ReadError
        If the bytes are not in it.
    """
    decoder = codecs.getincrementaldecoder(encoding)("replace" if detected else "strict")
    rest = ""
    try:
        for block in blocks:
            text = rest + decoder.decode(block)
            ended = text.rstrip("\r")  # what follows them tells what they end
            cut = max(ended.rfind("\n"), ended.rfind("\r")) + 1
            rest = text[cut:]
            if cut:
                yield _ends(text[:cut])
            elif len(rest) > _LONGEST:
                raise ReadError(
                    f"a line of more than {_LONGEST >> 20} million characters; this is no "
                    "text of rows, or its line ends were lost: export it again"
                )
        rest += decoder.decode(b"", final=True)
    except UnicodeDecodeError as error:
        raise ReadError(
            f"byte 0x{error.object[error.start]:02X} is not {encoding}; "
            "give the file's encoding with --text encoding=cp1252"
        ) from None
    except UnicodeError as error:  # such as UTF-16 without the mark that it begins with
        raise ReadError(
            f"the text is not {encoding} ({error}); give the file's encoding, for example "
            "--text encoding=cp1252, or leave it out"
        ) from None
    if rest:
        yield _ends(rest) + "\n"


def _ends(text: str) -> str:
    if "\u2212" in text:
        text = text.replace("\u2212", "-")  # a typeset minus
    if "\ufeff" in text:
        text = text.replace("\ufeff", "")  # where files were joined
    if "\r" not in text:
        return text
    text = text.replace("\r\n", "\n")
    return text if "\r" not in text else re.sub(r"(?<!\r)\r+\n", "\n", text).replace("\r", "\n")
