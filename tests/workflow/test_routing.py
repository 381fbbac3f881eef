"""Which fit a set of records means, and which sets are refused."""

from __future__ import annotations

import pytest

from dashpot.base.errors import ReadError
from dashpot.registry import KINDS
from dashpot.workflow.example_files import FILES
from dashpot.workflow.fit_routing import BENCH, VIBRATION, route

HITS, FRF, BASE = "impact", "frf", "transmissibility"


def meant(*kinds: str, **message: object) -> str:
    return route({f"{i}.csv": kind for i, kind in enumerate(kinds)}, **message)  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", [kind.name for kind in KINDS.values() if kind.fit_route])
def test_several_records_of_a_kind_mean_the_same_fit(kind: str) -> None:
    assert meant(kind) == meant(kind, kind) == KINDS[kind].fit_route


@pytest.mark.parametrize(
    ("kinds", "values", "word"),
    [
        (("relaxation", "dma"), {}, "bench"),
        (("relaxation", "relaxation"), {"masses": 1}, "bench"),
        (("strain-sweep", "cyclic"), {}, "level"),
        ((HITS,), {"masses": 1}, "joint"),
        ((HITS,), {"masses": 2}, "masses"),
        ((FRF, FRF), {"masses": 2}, "masses"),
        ((FRF, FRF), {"masses": 1, "selected": "level"}, "level"),
        ((HITS,), {"selected": "level"}, "level"),
        ((FRF,), {"selected": "rod"}, "rod"),
        ((BASE,), {"selected": "rod", "masses": 1}, "rod"),
        ((BASE,), {"masses": 1}, "joint"),
        (("relaxation", HITS), {"masses": 1}, "joint"),
        (("fit", FRF), {"masses": 1}, "joint"),
        (("relaxation", "dma", "fit", FRF), {"masses": 1}, "joint"),
        (("indentation",), {"masses": 1}, "indentation"),
    ],
)
def test_options_select_the_fit(
    kinds: tuple[str, ...], values: dict[str, object], word: str
) -> None:
    assert meant(*kinds, **values) == word


@pytest.mark.parametrize(
    ("kinds", "values", "message"),
    [
        (("relaxation", HITS), {}, "under a mass. Give the test mass, such as --mass 104g"),
        (("fit", FRF), {"selected": "level"}, "Give the test mass"),
        ((HITS, FRF), {}, "1.csv is an FRF. They are not fitted together. Fit them one by one"),
        ((HITS, FRF), {"masses": 1}, "They are not fitted together"),
        (tuple(sorted(VIBRATION)), {}, "They are not fitted together"),
        ((HITS, "relaxation"), {"masses": 1, "selected": "rod"}, "are of the vibration alone"),
        ((FRF, FRF), {"masses": 1}, "and one FRF is fitted under one mass. Give one of them"),
        ((BASE, HITS), {}, "1.csv is a hammer test. They are not fitted together"),
        (("cld", "relaxation"), {}, "not fitted together: 0.csv is a compression load deflection"),
        (("cld", HITS), {"masses": 1}, "not fitted together"),
        (("fit", "relaxation"), {}, "not fitted together: 0.csv is a fit; 1.csv is a relaxation"),
        ((HITS, "cld", "cld", "cld"), {}, "1.csv, 2.csv and 3.csv are each a compression load"),
        ((HITS, *4 * ("cld",)), {}, "1.csv, 2.csv and 2 more are each a compression load"),
        (("fit",), {}, "0.csv is a fit: use dashpot predict"),
        (("door",), {}, "0.csv is a door: use dashpot predict"),
        (("temperature-sweep",), {}, "it shows no relaxation times; sweep the frequency"),
        (("comparison",), {}, "0.csv is a stored comparison: it is not fitted"),
    ],
)
def test_unfit_records_are_refused_in_a_sentence(
    kinds: tuple[str, ...], values: dict[str, object], message: str
) -> None:
    with pytest.raises(ReadError) as caught:
        meant(*kinds, **values)
    assert message in str(caught.value)


def test_every_bench_kind_is_fitted_by_fit_files() -> None:
    assert not BENCH & VIBRATION
    assert {HITS, FRF, BASE} == VIBRATION
    assert {KINDS[kind].fit for kind in BENCH} == {"dashpot.workflow.bench_tests:fit_files"}


@pytest.mark.parametrize("name", FILES)
def test_every_example_is_fitted_or_refused_in_a_sentence(name: str) -> None:
    kind = FILES[name].kind
    if kind in KINDS and KINDS[kind].fit_route:
        assert route({name: kind}) == KINDS[kind].fit_route
        return
    with pytest.raises(ReadError) as caught:
        route({name: kind})
    assert str(caught.value).startswith(f"{name} is ")
