"""WAV files against SciPy, their full scale asked; formats that are named and not read."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from kit.foreign.files import press_and_hold
from scipy.io import wavfile

from dashpot.base.errors import ReadError
from dashpot.reading.formats import read_table
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.relaxation import read_relaxation

RATE = 20
TIME, DISPLACEMENT, FORCE = press_and_hold(RATE)
PARTS = np.column_stack([DISPLACEMENT / 10, FORCE / 50])


@pytest.mark.parametrize("kind", ["i2", "i4", "f4", "f8"])
def test_samples_are_parts_of_full_scale(tmp_path: Path, kind: str) -> None:
    size = 8 * np.dtype(kind).itemsize
    stored = PARTS * 2 ** (size - 1) if kind[0] == "i" else PARTS
    wavfile.write(tmp_path / "a.wav", RATE, stored.astype(kind))
    options = ReadOptions(
        displacement="2", force="3", units={"displacement": "10mm", "force": "50N"}
    )
    test = read_relaxation(tmp_path / "a.wav", options=options)
    np.testing.assert_allclose(test.force, FORCE, atol=50 / 2**15)
    np.testing.assert_allclose(test.displacement, DISPLACEMENT * 1e-3, atol=0.01 / 2**15)
    np.testing.assert_allclose(test.time, TIME, atol=1e-12)


def test_wav_asks_for_its_full_scale(tmp_path: Path) -> None:
    wavfile.write(tmp_path / "a.wav", RATE, PARTS)
    with pytest.raises(ReadError, match='--units "displacement=50mm,force=50N"'):
        read_relaxation(tmp_path / "a.wav", options=ReadOptions(displacement="2", force="3"))
    message = ReadOptions(displacement="2", force="3", units={"displacement": "10mm"})
    with pytest.raises(ReadError, match='1 = full scale; add --units "force=50N"'):
        read_relaxation(tmp_path / "a.wav", options=message)


def wav(data: bytes, *, bits: int = 24, kind: int = 1, size: int | None = None) -> bytes:
    form = struct.pack("<HHIIHH", kind, 1, 100, 100 * bits // 8, bits // 8, bits)
    size = len(data) if size is None else size
    body = b"WAVEfmt " + struct.pack("<I", 16) + form + b"data" + struct.pack("<I", size) + data
    return b"RIFF" + struct.pack("<I", len(body)) + body


def extend_samples(data: bytes, bits: int, valid: int) -> bytes:
    """Samples of `valid` bits, each stored in `bits`."""
    size = bits // 8
    form = struct.pack("<HHIIHHHHIH", 0xFFFE, 1, 100, 100 * size, size, bits, 22, valid, 4, 1)
    form += bytes.fromhex("000000001000800000aa00389b71")
    body = b"WAVEfmt " + struct.pack("<I", len(form)) + form
    body += b"data" + struct.pack("<I", len(data)) + data
    return b"RIFF" + struct.pack("<I", len(body)) + body


def swap_bytes(data: bytes, bits: int) -> bytes:
    """The same file with its most significant bytes first."""
    size = bits // 8
    form = struct.pack(">HHIIHH", 1, 1, 100, 100 * size, size, bits)
    body = b"WAVEfmt " + struct.pack(">I", 16) + form + b"data" + struct.pack(">I", len(data))
    return b"RIFX" + struct.pack(">I", len(body) + len(data)) + body + data


def long(data: bytes) -> bytes:
    """The same file as recorders write it that count beyond 4 GiB."""
    sizes = struct.pack("<QQQI", 80 + len(data), len(data), len(data) // 2, 0)
    body = b"WAVEds64" + struct.pack("<I", len(sizes)) + sizes
    body += b"fmt " + struct.pack("<IHHIIHH", 16, 1, 1, 100, 200, 2, 16)
    return b"RF64\xff\xff\xff\xff" + body + b"data\xff\xff\xff\xff" + data


def numbers(data: bytes) -> np.ndarray:
    return read_table(RawFile("a.wav", None, data), ReadOptions()).load([1]).values[:, 0]


def test_24_bits_and_8_bits() -> None:
    packed = b"".join(value.to_bytes(3, "little", signed=True) for value in (0, 1 << 22, -1 << 23))
    np.testing.assert_array_equal(numbers(wav(packed)), [0, 0.5, -1])
    np.testing.assert_array_equal(numbers(wav(bytes([128, 192, 0]), bits=8)), [0, 0.5, -1])


def test_samples_stand_in_the_upper_bits_of_a_wider_word() -> None:
    values = np.array([0, 1 << 22, -1 << 23, 5])
    upper = (values.astype("<i4") << 8).tobytes()
    np.testing.assert_array_equal(numbers(extend_samples(upper, 32, 24)), values / 2**23)
    with pytest.raises(ReadError, match="24 bits in 32 whose samples do not stand in the upper"):
        numbers(extend_samples(values.astype("<i4").tobytes(), 32, 24))


@pytest.mark.parametrize("bits", [16, 24, 32])
def test_most_significant_bytes_first(bits: int) -> None:
    values = [0, 1 << (bits - 2), -1 << (bits - 1)]
    data = b"".join(value.to_bytes(bits // 8, "big", signed=True) for value in values)
    np.testing.assert_array_equal(numbers(swap_bytes(data, bits)), [0, 0.5, -1])


@pytest.mark.parametrize("mark", [b"RF64", b"BW64"])
def test_rf64_sizes_are_read(mark: bytes) -> None:
    data = np.array([0, 1 << 14, -1 << 15], "<i2").tobytes()
    np.testing.assert_array_equal(numbers(mark + long(data)[4:]), [0, 0.5, -1])


REFUSED = {
    "cut": (wav(bytes(30), size=300), "says 300 bytes of samples and holds 30"),
    "never finished": (wav(bytes(30), size=0xFFFFFFFF), "never wrote its length"),
    "packed": (wav(bytes(30), kind=2), "coding 2"),
    "another RIFF": (b"RIFF\x10\0\0\0AVI " + bytes(16), "RIFF file of the kind b'AVI '"),
    "no samples": (wav(b"")[:36], "without samples"),
}  # fmt: skip


@pytest.mark.parametrize(("data", "message"), REFUSED.values(), ids=REFUSED)
def test_a_wav_that_cannot_be_read_is_refused(data: bytes, message: str) -> None:
    with pytest.raises(ReadError, match=message):
        read_table(RawFile("a", None, data), ReadOptions())
