"""From a study to one HTML page."""

from __future__ import annotations

import platform
from importlib import metadata
from typing import Any

from dashpot.base import numbers
from dashpot.report import relaxation as bench
from dashpot.report import summary as words
from dashpot.report import vibration as hammer
from dashpot.report.attachments import attachments
from dashpot.report.pictures import pictures
from dashpot.report.tables import checks, halves
from dashpot.workflow.study import Study


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
        words=numbers.words, readable=numbers.readable, shorter=numbers.shorter
    )
    return environment.get_template("report.html").render(_contents(study))


def _contents(study: Study) -> dict[str, Any]:
    found = checks(words.stages(study))
    c = study.comparison
    return {
        "study": study,
        "title": words.title(study),
        "verdict": words.sentences(study),
        "simulated": words.simulated(study),
        "straight": words.straight(study),
        "inferred": words.inferred_mass(study),
        "failed": sum(mark == "bad" for mark in found.marks),
        "checks": found,
        "pictures": pictures(study),
        "key": bench.key_numbers(study),
        "peaks": hammer.peaks(study),
        "facts": halves(bench.test_facts(study.prepared)),
        "coefficients": bench.coefficients(study.fit, study.prepared.specimen.length),
        "orders": bench.orders(study),
        "routes": None if study.hold_fit is None else bench.two_routes(study.fit, study.hold_fit),
        "nuisances": bench.nuisances(study.fit),
        "frequency": bench.in_frequency(
            study.fit, study.unseen, None if c is None else c.measured_hz
        ),
        "arms": None if c is None else hammer.arms_tested(c),
        "resonance": hammer.resonance(study),
        "hits": None if study.measured is None else hammer.hits(study.measured),
        "moved": None if study.joint is None else hammer.moved(study.joint),
        "joint_coefficients": None
        if study.joint is None
        else bench.coefficients(study.joint, study.prepared.specimen.length),
        "joint_arms": None
        if study.joint_comparison is None
        else hammer.arms_tested(study.joint_comparison),
        "joint_nuisances": None if study.joint is None else bench.nuisances(study.joint),
        "sources": words.sources(study),
        "steps": _steps(study),
        "attachments": attachments(study),
        "versions": versions(),
        "identity": study.fit.identity,
        "joint_identity": "" if study.joint is None else study.joint.identity,
        "band": numbers.hertz(study.fit.band),
        "mass": None if study.mass is None else numbers.rounded(1e3 * study.mass, digits=4),
        "rms": numbers.rounded(1e3 * study.fit.residual.rms),
        "kappa": numbers.rounded(study.fit.residual.kappa),
        "watson": numbers.rounded(study.fit.residual.durbin_watson),
    }


def _steps(study: Study) -> list[Any]:
    """Every step since the raw files, each once, in order."""
    groups = [study.fit.steps or study.prepared.steps]
    for later in (study.measured, study.joint):
        groups.append(() if later is None else later.steps)
    return list(dict.fromkeys(step for steps in groups for step in steps))


def versions() -> tuple[tuple[str, str], ...]:
    """What computed this page."""
    return (
        *((name, metadata.version(name)) for name in ("dashpot", "numpy", "scipy", "matplotlib")),
        ("Python", platform.python_version()),
    )
