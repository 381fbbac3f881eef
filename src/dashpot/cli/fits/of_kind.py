"""A kind whose fit takes what its row of the register says, and no more."""

from __future__ import annotations

import click

from dashpot.cli import _options as options
from dashpot.cli._grammar import Verb
from dashpot.cli._shell import Outcome, typed
from dashpot.cli.fits._given import Given
from dashpot.kinds import KINDS, KindOfTest, load


def run(given: Given) -> Outcome:
    """Fit the files as the row of their kind says."""
    row = KINDS[given.kinds[given.files[0]]]
    _refuse_others(row, given)
    given.kept_as(".json", what="this fit")
    found = load(row.fit)(given.files, options=given.reading, **given.some(*row.takes))
    given.draw(found.plot)
    given.keep(found)
    follow = (given.kept if one == "FILE" else one for one in row.follow.split())
    return Outcome.of(found, follow=typed(*follow) if given.kept and row.follow else "")


def _refuse_others(row: KindOfTest, given: Given) -> None:
    """Refuse an option of all kinds that this fit does not take."""
    from dashpot.io.readers.recognise import called

    context = click.get_current_context()
    assert isinstance(context.command, Verb)  # noqa: S101
    for one in context.command.options:
        names = {one.name} if one.fills is None else {each.name for each in one.fills.fields}
        names |= {one.fills.receives} if one.fills else set()
        heard = one.group in {options.READING, options.RESULT} or names & set(row.takes)
        if not heard and one.typed(context):
            what = called(given.kinds[given.files[0]])
            raise click.UsageError(f"{one.flag} does not suit {what}. Leave it out.")
