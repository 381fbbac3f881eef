"""Print what pyNastran finds in a deck; run by an environment that has pyNastran."""

from __future__ import annotations

import sys


def main(deck: str) -> None:
    from pyNastran.bdf.bdf import read_bdf

    model = read_bdf(deck, punch=True, xref=False, debug=None)
    for number, table in model.tables_d.items():
        for x, y in zip(table.x.tolist(), table.y.tolist(), strict=True):
            print("TABLE", number, repr(x), repr(y))
    for number, prop in model.pbusht.items():
        tables = [("K", prop.k_tables), ("GE", prop.ge_tables)]
        print("PBUSHT", number, " ".join(f"{label} {result[0]}" for label, result in tables))
    print("CBUSH", sum(element.type == "CBUSH" for element in model.elements.values()))


if __name__ == "__main__":
    main(sys.argv[1])
