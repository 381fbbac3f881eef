"""A study to one self-contained HTML file."""

from __future__ import annotations

import base64
import platform
from importlib import metadata
from typing import Any, NamedTuple

from dashpot.base import numbers
from dashpot.base.checks import Use
from dashpot.base.provenance import Step
from dashpot.base.version import __version__, byline
from dashpot.report import summary, tables
from dashpot.report.pictures import pictures
from dashpot.vibration.comparison.comparison import Comparison
from dashpot.workflow.archive import to_json
from dashpot.workflow.study import Study

__all__ = ["html"]

COLOURS: dict[Use, str] = {"use": "good", "use with care": "care", "do not use": "bad"}
"""The style of each verdict; its words stand beside the colour."""


def html(study: Study) -> str:
    """Return the report as one self-contained HTML file.

    No network, no script: pictures are inline SVG, and a strict content security policy says so.
    It prints on A4. Whatever came from a file is escaped. Parts that the study cannot fill, for
    want of a mass or a hammer test, are left out, and the page says so.

    Parameters
    ----------
    study : Study

    Returns
    -------
    str
        The text of the file; the same study gives the same text.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("dashpot.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(
        words=numbers.words,
        sentence=lambda text: text[:1].upper() + text[1:] + ("" if text.endswith(".") else "."),
        readable=numbers.readable,
        shorter=numbers.shorter,
        rounded=numbers.rounded,
        hertz=numbers.hertz,
    )
    return environment.get_template("report.html").render(_contents(study))


def _contents(study: Study) -> dict[str, Any]:
    length = study.prepared.specimen.length
    return {
        "study": study,
        "byline": byline("report"),
        "title": summary.title(study),
        "verdict": study.verdict,
        "colour": COLOURS[study.verdict.use],
        "sentences": summary.sentences(study),
        "simulated": summary.simulated(study),
        "straight": summary.straight(study),
        "inferred": summary.inferred_mass(study),
        "checks": tables.checks(summary.stages(study)),
        "pictures": pictures(study),
        "key": tables.key_numbers(study),
        "peaks": tables.peaks(study),
        "facts": tables.halves(tables.test_facts(study.prepared)),
        "coefficients": tables.coefficients(study.fit, length),
        "orders": tables.orders(study),
        "routes": tables.two_routes(study),
        "nuisances": tables.nuisances(study.fit),
        "frequency": tables.in_frequency(study),
        "arms": tables.arms_tested(study.comparison),
        "resonance": tables.resonance(study),
        "hits": tables.hits(study.measured),
        "explanations": tables.explanations(study.joint),
        "moved": tables.moved(study.joint),
        "joint_coefficients": tables.coefficients(study.joint, length),
        "joint_arms": tables.arms_tested(study.joint_comparison),
        "joint_nuisances": tables.nuisances(study.joint),
        "assumptions": tables.assumptions(study),
        "sources": summary.sources(study),
        "steps": _steps(study),
        "attachments": attachments(study),
        "versions": versions(),
    }


def _steps(study: Study) -> list[Step]:
    """Every step since the raw files, each once, in order."""
    groups = [study.fit.steps or study.prepared.steps]
    groups += [later.steps for later in (study.measured, study.joint) if later is not None]
    return list(dict.fromkeys(step for steps in groups for step in steps))


def versions() -> tuple[tuple[str, str], ...]:
    """What computed this page."""
    return (
        ("dashpot", __version__),
        *((name, metadata.version(name)) for name in ("numpy", "scipy", "matplotlib")),
        ("Python", platform.python_version()),
    )


# -- the numbers behind the page, to be saved from it ---------------------------------------------


class Attachment(NamedTuple):
    """A file inside the page.

    Attributes
    ----------
    name : str
        What it is saved as.
    about : str
        What is in it.
    link : str
        Its bytes as a data URI: no server, a link that holds its file.
    """

    name: str
    about: str
    link: str


def attachments(study: Study) -> tuple[Attachment, ...]:
    """The fits in full precision, and the lines of the FRFs if there are any."""
    json, csv = "application/json", "text/csv"
    files = [("fit.json", "the fit, SI units, full precision", json, to_json(study.fit))]
    if study.joint is not None:
        files.append(("joint.json", "the joint fit", json, to_json(study.joint)))
    if study.comparison is not None:
        lines = _lines(study.comparison, study.joint_comparison)
        files.append(("frf.csv", "measured and predicted accelerance", csv, lines))
    return tuple(
        Attachment(name, about, f"data:{kind};base64,{base64.b64encode(text.encode()).decode()}")
        for name, about, kind, text in files
    )


def _lines(c: Comparison, joint: Comparison | None) -> str:
    curves = {"measured": c.measured, "predicted": c.predicted}
    if joint is not None and len(joint.predicted.frequency) == len(c.measured.frequency):
        curves["joint"] = joint.predicted
    columns = {"frequency [Hz]": c.measured.frequency}
    for name, frf in curves.items():
        columns[f"{name} real [(m/s^2)/N]"] = frf.value.real
        columns[f"{name} imaginary [(m/s^2)/N]"] = frf.value.imag
    if c.measured.coherence is not None:
        columns["coherence [1]"] = c.measured.coherence
    rows = (",".join(f"{v:.7g}" for v in row) for row in zip(*columns.values(), strict=True))
    return "\n".join((",".join(columns), *rows, ""))
