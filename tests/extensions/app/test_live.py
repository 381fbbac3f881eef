"""Live view of a running recording."""

import os

import numpy as np
import pytest

from dashpot.base.errors import DataError, ReadError
from dashpot.extensions.app.live_recording import MAX_CURVE_POINTS, Live, Trace
from dashpot.extensions.app.upload_store import Store

pytestmark = pytest.mark.once


@pytest.fixture
def live(tmp_path):
    (tmp_path / "store").mkdir()
    made = Live(Store(tmp_path / "store"))
    yield made
    made.stop()


@pytest.mark.parametrize("block", [1, 7, 1000, 60_000])
def test_a_curve_is_thinned_evenly_and_keeps_every_peak(block: int):
    time = np.arange(60_000 if block > 1 else 6_000) / 1000.0
    value = np.sin(time)
    value[4321], value[1234] = 9.0, -9.0
    trace = Trace()
    for i in range(0, len(time), block):
        trace.add(time[i : i + block], value[i : i + block])
    x, y = trace.curve()
    assert len(x) <= 2 * MAX_CURVE_POINTS + 3
    assert (x[0], x[-1]) == (pytest.approx(0.0, abs=0.05), time[-1])
    assert (y.max(), y.min()) == (9.0, -9.0)
    assert (np.diff(x) > 0).all()
    # no stretch is coarser than two of the others
    assert np.diff(x).max() <= 4 * len(time) / MAX_CURVE_POINTS / 1000.0


def test_a_record_goes_from_start_to_a_file_that_can_be_fitted(live, tmp_path):
    assert live.describe_state(0, 0)["saved_file"] is None
    live.start({"driver": "simulated", "speed": "1e9", "folder": str(tmp_path)})
    live._thread.join()
    seen = live.describe_state(1e9, -1)
    assert (seen["running"], seen["rows"], seen["failed"]) == (False, 42501, "")
    (selected,) = tmp_path.glob("record-*.csv")
    assert seen["message"].endswith(f"kept in {selected}")
    assert [item["name"] for item in seen["drawn"]] == ["displacement [mm]", "force [N]"]
    assert "2000" in seen["drawn"][0]["svg"][:80]  # as wide as a page may ask
    again = {"driver": "replay", "file": seen["saved_file"]["id"], "speed": 1e9}
    live.start(again)
    live._thread.join()
    played = live.describe_state(400, 200)
    assert played["rows"] == 42501
    assert "simulated; replayed from record-" in played["message"]
    assert "it goes with the app" in played["message"]


def test_live_record_runs_singly_and_stops_on_request(live):
    live.start({"driver": "simulated", "speed": 1e-3})
    with pytest.raises(DataError, match="a record is running; stop it first"):
        live.start({"driver": "simulated"})
    assert live.describe_state(400, 200)["running"]
    live.stop()
    assert not live.describe_state(400, 200)["running"]


def test_a_page_reads_no_file_through_it(live, tmp_path):
    (tmp_path / "secret.csv").write_text("1,2,3\n")
    there = {"folder": str(tmp_path)}
    columns = "time [s], force [N]"
    for requested, error, message in [
        ({"driver": "serial", "port": str(tmp_path / "secret.csv"), "columns": columns} | there,
         ReadError, "is no serial line"),
        ({"driver": "serial", "port": os.devnull, "columns": columns} | there,
         ReadError, "is no serial line"),
        ({"driver": "serial", "port": "", "columns": columns}, DataError, "say in which folder"),
        ({"driver": "replay", "file": "../secret.csv"}, ReadError, "no longer here"),
        ({"driver": "replay", "file": str(tmp_path / "secret.csv")}, ReadError, "no longer here"),
        ({"driver": "simulated", "folder": str(tmp_path / "none")}, DataError, "is no folder"),
        ({"driver": "simulated", "speed": "fast"}, DataError, "speed: 'fast' is no number"),
        ({"driver": "simulated", "speed": "-1"}, DataError, "expected a number > 0"),
        ({"driver": "move"}, DataError, "driver = 'move'; expected one of simulated"),
        ({}, DataError, "driver = ''; expected one of simulated"),
    ]:  # fmt: skip
        with pytest.raises(error, match=message):
            live.start(requested)
    assert not live.running
    assert live.describe_state(0, 0)["rows"] == 0


def test_live_record_reports_a_failing_driver(live, monkeypatch):
    class Broken:
        def describe(self):
            from dashpot.extensions.acquisition.recorder import Description

            return Description("a card", ("force [N]",))

        def blocks(self):
            yield np.array([0.0, 1.0]), np.zeros((2, 1))
            raise RuntimeError("boom")

        def stop(self):
            pass

    monkeypatch.setattr(live, "_device", lambda *_: Broken())
    live.start({"driver": "simulated"})
    live._thread.join()
    seen = live.describe_state(400, 200)
    assert seen["failed"] == "a fault in the driver: RuntimeError: boom"
    assert (seen["rows"], seen["saved_file"]) == (2, None)
