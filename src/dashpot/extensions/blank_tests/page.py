"""Page of a testing machine by its blank tests."""

from __future__ import annotations

from dashpot.extensions.blank_tests.datamodel import ROLE_LABELS, MachineFit
from dashpot.report.result_page import KindPage, Topic, group, make_indicators


def page(fit: MachineFit) -> KindPage:
    """Return the page of a testing machine."""
    strip = tuple(
        (ROLE_LABELS[record.role].capitalize(), f"{record.file}, {record.reason}")
        for record in fit.records
    )
    return KindPage(
        subject="blank tests of a testing machine",
        summary_line=strip,
        indicators=make_indicators(
            fit.checks,
            Topic("Stop", {"stop_rigid", "stop_force_straight", "stop_force_returns",
                "stop_follows_machine", "crosshead_creep_plausible"}),
            Topic("Spring", {"spring_force_straight", "spring_force_returns",
                "spring_follows_machine", "delay_determined", "gain_plausible"}),
            Topic("Together", {"stop_and_spring_creep_agree", "stop_and_spring_delay_agree"}),
            Topic("Empty run", {"empty_run_force_free_of_motion", "empty_run_plate_steady",
                "empty_run_force_steady"}),
        ),
        figure_title="What the machine adds to a test",
        picture=fit.plot(),
        table_title="The machine",
        groups=(group("", fit.facts),),
        sources=fit.sources,
        note=f"{KindPage.note} Write the machine file with -o rig.toml, and fit every seal that is "
        "tested on this machine with --machine rig.toml.",
    )  # fmt: skip
