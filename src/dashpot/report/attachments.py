"""The numbers behind the page, to be saved from it: no server, a link that holds its file."""

from __future__ import annotations

import base64
from dataclasses import dataclass

from dashpot.workflow.study import Study


@dataclass(frozen=True)
class Attachment:
    """A file inside the page.

    Attributes
    ----------
    name : str
        What it is saved as.
    about : str
        What is in it.
    link : str
        Its bytes as a data URI.
    """

    name: str
    about: str
    link: str


def attachments(study: Study) -> tuple[Attachment, ...]:
    """The fits in full precision, and the lines of the FRFs if there are any."""
    from dashpot.workflow.archive import to_json

    files = [_json("fit.json", "the fit, SI units, full precision", to_json(study.fit))]
    if study.joint is not None:
        files.append(_json("joint.json", "the joint fit", to_json(study.joint)))
    if study.comparison is not None:
        files.append(_csv("frf.csv", "measured and predicted accelerance", _lines(study)))
    return tuple(files)


def _json(name: str, about: str, text: str) -> Attachment:
    return Attachment(name, about, _uri("application/json", text))


def _csv(name: str, about: str, text: str) -> Attachment:
    return Attachment(name, about, _uri("text/csv", text))


def _uri(kind: str, text: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(text.encode()).decode('ascii')}"


def _lines(study: Study) -> str:
    c, joint = study.comparison, study.joint_comparison
    if c is None:
        return ""
    curves = [("measured", c.measured), ("predicted", c.predicted)]
    if joint is not None and len(joint.predicted.frequency) == len(c.measured.frequency):
        curves.append(("joint", joint.predicted))
    head = ["frequency [Hz]"]
    columns = [c.measured.frequency]
    for name, frf in curves:
        head += [f"{name} real [(m/s^2)/N]", f"{name} imaginary [(m/s^2)/N]"]
        columns += [frf.value.real, frf.value.imag]
    if c.measured.coherence is not None:
        head.append("coherence [1]")
        columns.append(c.measured.coherence)
    rows = (",".join(f"{value:.7g}" for value in row) for row in zip(*columns, strict=True))
    return "\n".join((",".join(head), *rows, ""))
