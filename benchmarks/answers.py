"""Compare the answers of dashpot before and after a change of its source.

    PYTHONPATH=src python benchmarks/answers.py run [AFTER.json] [--only REGEX]
    python benchmarks/answers.py compare BEFORE.json AFTER.json [--only REGEX]

Runs the commands of benchmarks/answers.txt in a scratch folder with the example files and a few
more; PYTHONPATH says by which dashpot. Kept of each: exit code, JSON document, and what it wrote.
Two such files agree where words are the same and a number has moved by less than 0.01 of its own
standard error, as the document before tells it (a field of its name with `se` or beside
`standard_error`, or half of the half width of its 95 % interval); a standard error by less than
1 %, a covariance by 2 % of the largest of its row, a BIC by 0.1; a number without one by less than
--relative of itself, or of the largest of its list; one in a text by that or by its last digit.
Two threads in place of one move the same answers by up to 4e-4 relative. Exit status 1 where two
files do not agree. Without a file, `run` tells what each command costs.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import json
import math
import os
import re
import shlex
import sys
import tempfile
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

COMMANDS = Path(__file__).with_suffix(".txt")
IGNORED = {("certificate", "gap")}
"""Rounding: whether a certificate's gap is none stands beside it."""
HASH = re.compile(r"(?<![\w.])(?=\d*[a-f])[0-9a-f]{16}(?:[0-9a-f]{48})?\b")
"""Of files that bear the version or the hour, or of all digits of an answer."""
MOST, MOST_BIC, ROUNDING = 0.01, 0.1, 1e-14
"""Of a standard error, or of one by itself; of a BIC; of what is rounding and no number."""
TABLES = ("standard_error", "intervals", "interval_95")
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
WRITING = {"-o", "--project", "--setpoints", "--save-shifts"}
Place = tuple[Any, ...]
Found = tuple[float, float, str]


def lines() -> list[str]:
    return [line for line in COMMANDS.read_text("utf-8").splitlines() if line[:8] == "dashpot "]


def select_lines(pattern: str) -> list[str]:
    """The lines that match, and those above that write what they read."""
    result: list[str] = []
    read: set[str] = set()
    for line in reversed(lines()):
        words = shlex.split(line)
        if re.search(pattern, line) or read & {b for a, b in pairwise(words) if a in WRITING}:
            result.insert(0, line)
            read |= set(words)
    return result


def tables() -> Iterator[tuple[str, str, tuple[Any, ...]]]:
    """What the example files lack: name, head and columns of seven small tests."""
    import numpy as np

    draw = np.random.default_rng(1).standard_normal
    strain = np.geomspace(0.01, 20, 25)
    softer, noise = 1 / (1 + (strain / 1.2) ** 1.2), 1 + 0.003 * draw((2, 25))
    lost = 0.12 + 0.5 * softer * (1 - softer)
    columns = "frequency [Hz],strain [%],storage modulus [MPa],loss modulus [MPa]"
    moduli = (1.2 + 0.9 * softer) * noise[0], lost * noise[1]
    yield "strain.csv", columns, (np.full(25, 10.0), strain, *moduli)
    since = np.geomspace(0.01, 1e3, 60)
    crept = 0.25 + 0.15 * (1 - np.exp(-since / 0.8)) + 0.1 * (1 - np.exp(-since / 60))
    crept *= 1 + 0.002 * draw(60)
    yield "compliance.csv", "time [s],creep compliance [1/MPa]", (since, crept)
    x, pressed = np.linspace(1.0, 1.8, 60), np.linspace(0, 50, 60)
    planar = 0.4 * (x - x**-3) + 0.003 * draw(60)
    yield "planar.csv", "strain [%],nominal stress [MPa]", (100 * (x - 1), planar)
    foam = pressed / (1 + 0.08 * pressed) + 1e-6 * pressed**4 + 0.15 * draw(60)
    yield "foam.csv", "strain [%],nominal stress [kPa]", (pressed, foam)
    ratio = np.linspace(1.0, 0.97, 30)
    volumetric = 2000 * (1 - ratio) + 0.1 * draw(30)
    yield "volumetric.csv", "volume ratio,pressure [MPa]", (ratio, volumetric)
    time = np.arange(0, 9, 0.02)
    past = np.clip(time - 3, 0, 3.2)
    velocity = np.exp(-0.08 * past) * np.cos(past) + 0.002 * draw(len(time))
    yield "ball.csv", "time [ms],velocity [m/s]", (time, velocity)
    base = 5 * draw(1 << 14)
    k = 400e3 * (1 + 0.15j) * math.pi * 1e-4 / 20e-3
    omega = 2 * math.pi * np.fft.rfftfreq(len(base), 5e-4)
    mass = np.fft.irfft(np.fft.rfft(base) * k / (k - 33e-3 * omega**2), len(base))
    sensed = np.stack((base, mass)) + 0.01 * draw((2, len(base)))
    yield "shaken.csv", "time [s],base [m/s^2],mass [m/s^2]", (5e-4 * np.arange(len(base)), *sensed)


def run(place: Path | None, pattern: str) -> None:
    # before NumPy is there: the order of sums, and so the last digits, are those of one thread
    os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    from click.testing import CliRunner

    import dashpot
    from dashpot.cli import main

    def read(text: str) -> Any:
        text = HASH.sub("HASH", text.replace(dashpot.__version__, "VERSION"))
        return json.loads(text) if text.startswith("{") else text

    retained: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        CliRunner().invoke(main, ["demo", "--files", "--all", "-o", "."])
        for name, head, columns in tables():
            rows = (",".join(f"{v:.8g}" for v in row) for row in zip(*columns, strict=True))
            Path(name).write_text("\n".join([head, *rows, ""]), encoding="utf-8")
        Path("limits.toml").write_text('[k_end]\nlower = "150N/m"\nupper = "260N/m"\n', "utf-8")
        records = {file.name: read(file.read_text("utf-8")) for file in sorted(Path().iterdir())}
        digest = {name: hashlib.sha256(str(t).encode()).hexdigest() for name, t in records.items()}
        CliRunner().invoke(main, ["fit", "seal_8mm.csv", "-o", "fit.json"])  # the door's seal
        for line in select_lines(pattern):
            before = {file: file.stat().st_mtime_ns for file in Path().iterdir()}
            start = time.process_time()
            result = CliRunner().invoke(main, shlex.split(line)[1:])
            cpu = time.process_time() - start
            print(f"{cpu:6.2f} s  {result.exit_code}  {line}", file=sys.stderr)
            record = read(result.stdout)
            wrote = {
                file.name: text
                for file in sorted(Path().iterdir())
                if file.suffix not in {"", ".html"} and file.stat().st_mtime_ns != before.get(file)
                if (text := read(file.read_text("utf-8"))) != record
            }
            retained[line] = {
                "exit": result.exit_code,
                "cpu": cpu,
                "document": record,
                "files": wrote,
            }
    retained = {line: message for line, message in retained.items() if re.search(pattern, line)}
    if place:
        place.write_text(json.dumps({"inputs": digest, "answers": retained}), encoding="utf-8")


def differences(
    a: Any, b: Any, relative: float, path: Place = (), nest: Place = ()
) -> Iterator[Found]:
    """How far two documents differ in each place, over what it may, in its unit, and in words.

    `nest` holds what the path leads through in the first.
    """
    where = "/".join(map(str, path))
    if type(a) is type(b) and isinstance(a, (dict, list)):
        here, there = (dict(enumerate(x)) if isinstance(x, list) else x for x in (a, b))
        for key in sorted(set(here) ^ set(there), key=str):
            yield math.inf, 0.0, f"{where}/{key}: {'gone' if key in here else 'new'}"
        for key in here:
            if key in there and (*path[-1:], key) not in IGNORED:
                yield from differences(here[key], there[key], relative, (*path, key), (*nest, a))
    elif number(a) and number(b):
        if not math.isclose(a, b, rel_tol=0.0, abs_tol=ROUNDING):
            size, most, unit = measure(a, path, nest) or (_find_largest(a, nest[-1]), relative, "")
            magnitude = abs(a - b) / size if size else math.inf
            yield (
                magnitude / most,
                magnitude,
                f"{where}: {a:.8g} -> {b:.8g} ({magnitude:.2g} {unit})",
            )
    elif isinstance(a, str) and isinstance(b, str) and "\n" in a and a != b:
        yield from differences(a.splitlines(), b.splitlines(), relative, path, nest)
    elif isinstance(a, str) and isinstance(b, str) and _words(a) == _words(b):
        for match, other in zip(NUMBER.findall(a), NUMBER.findall(b), strict=True):
            mantissa, _, power = match.lower().partition("e")
            last = 1.01 * 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))
            magnitude = abs(float(match) - float(other))
            if magnitude > max(relative * abs(float(match)), last, ROUNDING):
                yield math.inf, 0.0, f"{where}: {match} -> {other} in its text"
    elif a != b:
        yield math.inf, 0.0, f"{where}: {a!s:.60} -> {b!s:.60}"


def _words(text: str) -> list[str]:
    return NUMBER.sub(" # ", text).split()


def number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _find_largest(value: float, home: Any) -> float:
    return max(map(abs, filter(number, home))) if isinstance(home, list) else abs(value)


def measure(value: float, path: Place, nest: Place) -> tuple[float, float, str] | None:
    """The standard error of the number at a path, what it may move by in it, and its name."""
    home, names = nest[-1], [str(name) for name in path if isinstance(name, str)]
    if "covariance" in names:
        return _find_largest(value, home), 2 * MOST, "of its row"
    if names[-1] in {"bic", "orders"} or path[-2:-1] == ("orders",):
        return max(1.0, 1e-3 * abs(value)), MOST_BIC, "of BIC"
    if "standard_error" in names or {"se", "sd"} & set(names[-1].split("_")):
        return abs(value), MOST, "of it"
    if any("interval" in name for name in names) and (error := _error(home, ())):
        return error, MOST, "SE"
    for depth in reversed(range(len(nest))):
        if not isinstance(node := nest[depth], dict):
            continue
        key, tail = str(path[depth]), path[depth + 1 :]
        message = [(node.get(table), path[depth:]) for table in TABLES]
        message += [(node.get(table), tail) for table in TABLES if tail or key == "value"]
        bare = {key, key.removesuffix("_real").removesuffix("_imag")}
        message += [(error, tail) for name, error in node.items() if _find_quantity(name) in bare]
        if {"low", "high"} <= set(node) and key in {"value", "low", "high"}:
            message.append(([node["low"], node["high"]], ()))
        for table, inside in message:
            if error := _error(table, inside):
                return error, MOST, "SE"
    return None


def _find_quantity(name: str) -> str | None:
    """Of `storage_se` and `storage_interval`, `storage`; of `frequency_se_hz`, `frequency_hz`."""
    words = name.split("_")
    base_words = [word for word in words if word not in {"se", "sd", "interval"}]
    return "_".join(base_words) if len(base_words) < len(words) else None


def _error(table: Any, tail: Place) -> float | None:
    """A standard error as it stands there, or half of the half width of a 95 % interval."""
    for key in tail:
        if isinstance(table, list):
            table = dict(enumerate(table))
        table = table.get(key) if isinstance(table, dict) else None
    if isinstance(table, list) and len(table) == 2 and all(map(number, table)):
        return abs(table[1] - table[0]) / 4 or None
    return table or None if number(table) else None


def _leave_out_digest(entries: dict[str, Any]) -> dict[str, Any]:
    return {key: item for key, item in entries.items() if key != "digest"}


def compare(before: Path, after: Path, pattern: str, relative: float, worst: int) -> bool:
    from dashpot.extensions.projects.document_versions import convert_document

    def read(text: str) -> Any:
        """Answers under the present keys, without what a digest of former ones would be."""
        return convert_document(json.loads(text, object_hook=_leave_out_digest))

    a, b = (read(place.read_text("utf-8")) for place in (before, after))
    same = a["inputs"] == b["inputs"]
    if not same:
        names = [name for name, message in a["inputs"].items() if b["inputs"].get(name) != message]
        print(f"the files given to the commands differ: {', '.join(names)}")
    spent = [0.0, 0.0]
    either = {line for line in {**a["answers"], **b["answers"]} if re.search(pattern, line)}
    if not either:  # nothing agrees with nothing
        print(f"no command of both files matches {pattern!r}")
        return False
    for line in (line for line in lines() if line in either):
        both = [entry["answers"].get(line, {"cpu": 0.0}) for entry in (a, b)]
        spent = [
            sum(pair) for pair in zip(spent, (message.pop("cpu") for message in both), strict=True)
        ]
        result = sorted(differences(*both, relative), key=lambda item: -item[0])
        excess = [item for item in result if item[0] > 1]
        same = same and not excess
        word = "DIFFERS" if excess else "within" if result else "identical"
        print(f"{word:10} {line}")
        for _, _, message in (excess or result[:1])[:worst]:
            print(f"           {message}")
        if len(excess) > worst:
            print(f"           and {len(excess) - worst} more")
    print(f"CPU {spent[0]:.1f} s before, {spent[1]:.1f} s after")
    return same


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("what", choices=("run", "compare"), nargs="?", default="run")
    parser.add_argument("files", type=lambda name: Path(name).resolve(), nargs="*")
    parser.add_argument("--only", default="", help="lines that match this regular expression")
    parser.add_argument("--relative", type=float, default=1e-3)
    parser.add_argument("--worst", type=int, default=6, help="differences shown of each line")
    options = parser.parse_args()
    if options.what == "run":
        run(*options.files or [None], options.only)
        return 0
    return int(not compare(*options.files, options.only, options.relative, options.worst))


if __name__ == "__main__":
    sys.exit(main())
