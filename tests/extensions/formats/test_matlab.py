"""A damaged MAT file is refused before it could end the process."""

from __future__ import annotations

import contextlib
import random
import struct
import warnings
from io import BytesIO

import numpy as np
import pytest
from scipy.io import loadmat, savemat
from scipy.sparse import csc_matrix

from dashpot.base.errors import ReadError
from dashpot.extensions.formats.matlab import check_elements

CONTENT = {
    "numbers": np.random.default_rng(0).standard_normal((3000, 3)),
    "struct": {"x": np.arange(5), "name": "seal", "deep": {"y": [1.0, 2.0]}},
    "complex": np.array([1 + 2j, 3]),
    "cell": np.array(["abc", np.arange(3)], dtype=object),
    "flags": np.array([True, False]),
    "nothing": np.zeros((0, 0)),
    "text": "x" * 1000,
    "sparse": csc_matrix(np.eye(4)),
}


def save_matlab(content: dict[str, object] = CONTENT, **options: object) -> BytesIO:
    stream = BytesIO()
    savemat(stream, content, **options)  # type: ignore[arg-type]
    stream.seek(0)
    return stream


@pytest.mark.parametrize("compressed", [False, True])
def test_check_elements_accepts_valid_files(compressed: bool) -> None:
    stream = save_matlab(do_compression=compressed)
    check_elements(stream)
    assert stream.tell() == 0


def test_other_versions_and_files_are_passed_over() -> None:
    for stream in (
        save_matlab({"a": np.eye(3)}, format="4"),
        BytesIO(b"time,force\n1,2\n"),
        BytesIO(),
    ):
        check_elements(stream)
        assert stream.tell() == 0


def test_both_byte_orders_are_walked() -> None:
    for order, mark, wrong in ((">", b"MI", b"IM"), ("<", b"IM", b"MI")):
        header = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack(order + "H", 0x0100) + mark
        array = struct.pack(order + "2I", 14, 56)
        array += struct.pack(order + "4I", 6, 8, 6, 0) + struct.pack(order + "2I2i", 5, 8, 1, 1)
        array += struct.pack(order + "I", 1 << 16 | 1) + b"a\0\0\0"
        array += struct.pack(order + "2Id", 9, 8, 1.0)
        check_elements(BytesIO(header + array))
        assert loadmat(BytesIO(header + array))["a"] == 1.0
        with pytest.raises(ReadError, match="damaged"):
            check_elements(BytesIO(header[:126] + wrong + array))


@pytest.mark.parametrize(
    ("at", "put", "why"),
    [
        (128, 99, "an element of type 99"),
        (132, 10**6, "bytes, .* are left"),
        (144, 77, "an array of class 77"),
        (168, 0x40000014, "an element of type 20 with 16384 bytes in its tag"),
    ],
)
def test_check_elements_reports_a_wrong_tag(at: int, put: int, why: str) -> None:
    content = bytearray(save_matlab({"a_long_name": np.arange(9.0)}).getvalue())
    content[at : at + 4] = struct.pack("<I", put)
    with pytest.raises(ReadError, match=f"the MAT file is damaged near byte.*{why}"):
        check_elements(BytesIO(content))


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("left", [140, 200, 5000])
def test_check_elements_reports_a_truncated_file(compressed: bool, left: int) -> None:
    content = save_matlab(do_compression=compressed).getvalue()[:left]
    with pytest.raises(ReadError, match="the MAT file is damaged near byte"):
        check_elements(BytesIO(content))


def test_check_elements_reports_inconsistent_counts() -> None:
    good = save_matlab({"a_long_name": np.arange(9.0)}).getvalue()
    for at, put, why in (
        (144, 0x806, "an element where 0 bytes are left"),  # complex, but nothing imaginary
        (160, 10**6, "an array of 9000000 values in"),
        (152, 0x10005, "an array with 1 bytes of dimensions"),
    ):
        content = bytearray(good)
        content[at : at + 4] = struct.pack("<I", put)
        with pytest.raises(ReadError, match=why):
            check_elements(BytesIO(content))


@pytest.mark.parametrize("seed", range(4))
def test_what_passes_does_not_end_the_process(seed: int) -> None:
    """Thousands of damaged files: SciPy may refuse what is left, and lives to say so."""
    draw = random.Random(seed)  # noqa: S311
    small = {name: value for name, value in CONTENT.items() if name != "numbers"}
    files = [save_matlab(small).getvalue(), save_matlab(small, do_compression=True).getvalue()]
    refused = 0
    for _ in range(800):
        content = bytearray(draw.choice(files))
        for _ in range(draw.randint(1, 4)):
            at = draw.randrange(124, len(content))
            content[at : at + draw.randint(0, 2)] = draw.randbytes(draw.randint(0, 2))
        try:
            check_elements(BytesIO(content))
        except ReadError:
            refused += 1
            continue
        with contextlib.suppress(Exception), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            loadmat(BytesIO(content), simplify_cells=True)
    assert 100 < refused < 800


@pytest.mark.parametrize(
    ("name", "at", "put"),
    [("indices", 1, 9), ("indices", 0, -1), ("indptr", 0, 1), ("indptr", 1, 3), ("indptr", 3, 9)],
)
def test_the_indices_of_a_sparse_array_lie_inside_it(name: str, at: int, put: int) -> None:
    array = csc_matrix(np.array([[1.0, 0.0, 2.0], [0.0, 3.0, 0.0]]))
    check_elements(save_matlab({"numbers": array}))
    getattr(array, name)[at] = put
    with pytest.raises(ReadError, match="indices lie outside"):
        check_elements(save_matlab({"numbers": array}))
