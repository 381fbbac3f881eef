"""A logo: an image of a known kind, small, as a link that holds it."""

from __future__ import annotations

import base64

import pytest

from dashpot.base.errors import ReadError
from dashpot.workflow.study import read_logo

PNG = b"\x89PNG\r\n\x1a\n"


@pytest.mark.parametrize(
    ("content", "kind"),
    [(PNG + bytes(100_000 - len(PNG)), "image/png"), (b"\xff\xd8\xff\xe0", "image/jpeg"),
     (b"<svg xmlns='http://www.w3.org/2000/svg'/>", "image/svg+xml"),
     (b"\xef\xbb\xbf <?xml version='1.0'?><!-- a --><svg/>", "image/svg+xml")],
)  # fmt: skip
def test_read_logo_embeds_an_image_of_a_supported_kind(tmp_path, content, kind):
    (tmp_path / "logo").write_bytes(content)
    head, _, data = read_logo(tmp_path / "logo").partition(",")
    assert head == f"data:{kind};base64"
    assert base64.b64decode(data) == content


@pytest.mark.parametrize(
    ("content", "message"),
    [(PNG + bytes(100_001 - len(PNG)), "logo is larger than 100000 bytes"),
     (b"GIF89a", "expected PNG, JPEG or SVG"), (b"<html><svg/></html>", "expected PNG"),
     (b"", "expected PNG"), (b"<!-- no image -->", "expected PNG")],
)  # fmt: skip
def test_anything_else_is_no_logo(tmp_path, content, message):
    (tmp_path / "logo").write_bytes(content)
    with pytest.raises(ReadError, match=message):
        read_logo(tmp_path / "logo")
