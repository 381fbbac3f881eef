#!/usr/bin/env bash
# ansys-dyna-core: of the terms of *MAT_GENERAL_VISCOELASTIC it reads the first, and writes no other.
#
# Expected: the material holds up to 18 terms of shear modulus and decay constant, a card each, until
#   the next keyword. A library for keyword files reads and writes them all, or says that it cannot.
# Happens: the keyword has one GI and one BETAI. The terms behind the first are neither read nor
#   kept: a deck that is read and written again has lost them. No exception, no warning, the import
#   has nothing to say, and the check of the deck finds no fault.
# Matters: a rubber of three terms comes out with .30 of .45 MPa of its instantaneous modulus, and
#   relaxes within a second instead of hours. The next program reads a valid card. Count the cards
#   of the material after any tool that writes keyword files.
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "ansys-dyna-core==0.12.1"
cd "$folder"
venv/bin/python -W error - <<'PYTHON'
from importlib.metadata import version

from ansys.dyna.core import Deck

TERMS = [(0.30, 0.1), (0.10, 10.0), (0.05, 1000.0)]  # MPa, 1/s
FIELDS = "{:>10}{:>10}"
text = "\n".join(
    [
        "*KEYWORD",
        "*MAT_GENERAL_VISCOELASTIC",
        "{:>10}{:>10}{:>10}".format(1, 1.2e-09, 2000.0),
        "{:>10}".format(0),
        *(FIELDS.format(*term) for term in TERMS),
        "*END",
    ]
)


def terms_of(deck_text):
    """The cards behind the second of the material: modulus and decay constant."""
    lines = [line for line in deck_text.splitlines() if not line.startswith("$")]
    at = lines.index("*MAT_GENERAL_VISCOELASTIC")
    rows = []
    for line in lines[at + 3 :]:
        if line.startswith("*"):
            break
        rows.append((float(line[:10]), float(line[10:20])))
    return rows


deck = Deck()
deck.loads(text)
written = terms_of(deck.write())
print("ansys-dyna-core", version("ansys-dyna-core"))
print("terms in the file     ", terms_of(text))
print("read: GI, BETAI       ", deck.keywords[0].gi, deck.keywords[0].betai)
print("terms after writing it", written)
print("instantaneous modulus ", sum(g for g, _ in TERMS), "->", sum(g for g, _ in written), "MPa")
assert terms_of(text) == TERMS
assert (deck.keywords[0].gi, deck.keywords[0].betai) == TERMS[0]
assert written == TERMS[:1], "it keeps the terms now"
PYTHON
echo "as described: all terms but the first are gone"
