"""Write the files of this folder, and what asammdf reads of them, with asammdf 8.8.28.

    python write.py

``truth.json`` holds each channel as `MDF.get` returns it: its time stamps, and its samples, None
where their invalidation bit is set.
"""

import json
from pathlib import Path

import numpy as np
from asammdf import MDF, Signal

HERE = Path(__file__).parent
TIME = np.arange(42) * 0.05 - 0.5
COUNTS = np.arange(42) % 20

CONVERSIONS = {
    "linear": {"a": 0.25, "b": -3.0},
    "rational": {"P1": 0.0, "P2": 2.0, "P3": 1.0, "P4": 0.0, "P5": 0.1, "P6": 4.0},
    "table interpolated": {f"raw_{i}": float(4 * i) for i in range(5)}
    | {f"phys_{i}": float(i * i) for i in range(5)} | {"interpolation": True},
    "table": {f"raw_{i}": float(4 * i) for i in range(5)}
    | {f"phys_{i}": float(i * i) for i in range(5)} | {"interpolation": False},
    "ranges": {"lower_0": 0.0, "upper_0": 4.0, "phys_0": 7.0, "lower_1": 6.0, "upper_1": 11.0,
               "phys_1": 9.0, "default": -1.0},
}  # fmt: skip


def signals(version: str) -> list[Signal]:
    kinds = ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"]
    if version >= "4":
        kinds.append("f2")
    result = [
        Signal((COUNTS - (5 if kind[0] != "u" else 0)).astype(kind), TIME, unit="N", name=kind)
        for kind in kinds
    ]
    for name, conversion in CONVERSIONS.items():
        if version < "4" and name in {"ranges", "table"}:
            continue
        result.append(
            Signal(
                # of whole numbers asammdf takes the wrong range
                COUNTS.astype("f8" if name == "ranges" else "u2"),
                TIME,
                unit="µm",
                name=name,
                conversion=dict(conversion),
            )
        )
    if version >= "4":
        result.append(
            Signal(
                COUNTS.astype("f4"), TIME, unit="m/s²", name="invalid",
                invalidation_bits=COUNTS % 7 == 3,
            )
        )  # fmt: skip
        result.append(
            Signal(
                COUNTS.astype("u1"), TIME, name="states",
                conversion={f"val_{i}": float(i) for i in range(20)}
                | {f"text_{i}": f"state {i}".encode() for i in range(20)},
            )
        )  # fmt: skip
        result.append(Signal(np.array([b"a", b"bc"] * 21), TIME, name="text", encoding="utf-8"))
    return result


def truth(path: Path) -> dict[str, object]:
    channels = {}
    with MDF(path) as file:
        for i, group in enumerate(file.groups):
            for j, channel in enumerate(group.channels):
                if j == file.masters_db.get(i):
                    continue
                signal = file.get(group=i, index=j, ignore_invalidation_bits=True)
                if signal.samples.dtype.kind not in "iuf":
                    continue
                marks = signal.invalidation_bits
                bad = np.zeros(len(signal), bool) if marks is None else np.asarray(marks, bool)
                values = [None if b else float(v) for v, b in zip(signal.samples, bad, strict=True)]
                channels[channel.name] = [signal.unit, signal.timestamps.tolist(), values]
    return channels


def main() -> None:
    result = {}
    for version in ("2.14", "3.30", "4.00", "4.10"):
        for compression in (1, 2) if version > "4.05" else (0,):
            path = HERE / f"{version}-{compression}.{'mf4' if version > '4' else 'mdf'}"
            with MDF(version=version) as file:
                file.append(signals(version), common_timebase=True)
                later = TIME[::3] + 0.02
                file.append([Signal(later**2, later, unit="degC", name="slow")])
                file.save(path, overwrite=True, compression=compression)
            result[path.name] = truth(path)
    text = json.dumps(result, separators=(",", ":"), ensure_ascii=False)
    (HERE / "truth.json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
