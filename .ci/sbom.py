"""Give each part of a software bill of materials (SBOM) the SHA-256 of the file that was installed.

``python .ci/sbom.py SBOM.cdx.json REPORT.json``: the SBOM of ``cyclonedx-py environment``, and the
report of ``pip install --report`` into that environment. A part that the report does not know is an
error: an SBOM with holes proves nothing.
"""

from __future__ import annotations

import hashlib
import json
import re
import sys
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit
from urllib.request import url2pathname


def key(name: str, version: str) -> tuple[str, str]:
    """Name, as PyPI normalises it, and version."""
    return re.sub(r"[-_.]+", "-", name).lower(), version


def add_hashes(sbom: dict[str, Any], report: dict[str, Any]) -> dict[str, Any]:
    """Return the SBOM with hashes."""
    files = {
        key(entry["metadata"]["name"], entry["metadata"]["version"]): entry["download_info"]
        for entry in report["install"]
    }
    parts = [sbom["metadata"]["component"], *sbom["components"]]
    for part in parts:
        file = files[key(part["name"], part["version"])]
        part["hashes"] = [{"alg": "SHA-256", "content": _sha256(file)}]
    return sbom


def _sha256(file: dict[str, Any]) -> str:
    """Return the hash that the index states; of a local file, of which pip states none, its own."""
    stated = file["archive_info"].get("hashes", {}).get("sha256")
    if stated is not None:
        return str(stated)
    place = url2pathname(urlsplit(file["url"]).path)
    return hashlib.sha256(Path(place).read_bytes()).hexdigest()


def main() -> None:
    """Write the SBOM with hashes."""
    path, report = map(Path, sys.argv[1:])
    sbom = add_hashes(json.loads(path.read_text("utf-8")), json.loads(report.read_text("utf-8")))
    path.write_text(json.dumps(sbom, indent=2, sort_keys=True) + "\n", "utf-8")


if __name__ == "__main__":
    main()
