"""Print what ansys-dyna-core finds in a deck; run by an environment that has it."""

from __future__ import annotations

import json
import sys


def main() -> None:
    from ansys.dyna.core import Deck

    deck = Deck()
    deck.loads(sys.stdin.read())
    materials = []
    for keyword in deck.get_kwds_by_type("MAT"):
        values = {name: getattr(keyword, name, None) for name in ("k", "dc", "k0", "ki", "beta")}
        materials.append([keyword.get_title(), values])
    elements = [
        [int(getattr(row, name)) for name in ("n1", "n2", "vid")]
        for keyword in deck.get_kwds_by_type("ELEMENT")
        for row in keyword.elements.itertuples()
    ]
    print(json.dumps({"materials": materials, "elements": elements}))


if __name__ == "__main__":
    main()
