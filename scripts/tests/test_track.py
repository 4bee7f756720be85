import json
import os
import xml.etree.ElementTree as ElementTree

import pytest

import track


def measured(folder, name, mean, half):
    """What criterion leaves of a benchmark."""
    place = folder / name / "new"
    place.mkdir(parents=True)
    interval = {"lower_bound": mean - half, "upper_bound": mean + half, "confidence_level": 0.95}
    estimate = {"mean": {"point_estimate": mean, "confidence_interval": interval}}
    (place / "estimates.json").write_text(json.dumps(estimate), encoding="utf-8")
    (place / "benchmark.json").write_text(json.dumps({"full_id": name}), encoding="utf-8")


def run(folder, at, time, half=1.0):
    measured(folder, track.CALIBRATION, 200.0, 2.0)
    measured(folder, "warp/disk", time, half)
    return list(track.rows(track.estimates(folder), at))


def test_times_are_ratios_to_the_calibration(tmp_path):
    [row] = run(tmp_path, "a", 100.0)
    assert (row.bench, row.ratio) == ("warp/disk", 0.5)
    # Half intervals of 1 % and 1 %: √2 % together.
    assert row.high / row.ratio == pytest.approx(1.0142, abs=1e-4)


def test_a_run_without_the_calibration_is_an_error(tmp_path):
    measured(tmp_path, "warp/disk", 100.0, 1.0)
    with pytest.raises(track.NothingToRead):
        list(track.rows(track.estimates(tmp_path), "a"))


# Two ratios known within √2 % each differ within 2 % by chance.
@pytest.mark.parametrize("time, flagged", [(101.5, False), (98.5, False), (102.5, True), (97.5, True)])
def test_a_change_beyond_both_intervals_is_flagged(tmp_path, time, flagged):
    before, after = run(tmp_path / "1", "a", 100.0), run(tmp_path / "2", "b", time)
    [(bench, factor, found)] = track.compare(before, after)
    assert (bench, found) == ("warp/disk", flagged) and factor == pytest.approx(time / 100.0)


def test_the_history_is_read_as_it_was_written_and_drawn(tmp_path):
    history = run(tmp_path / "1", "a", 100.0) + run(tmp_path / "2", "b", 120.0)
    track.write(tmp_path / "bench" / "history.csv", history)
    again = track.read(tmp_path / "bench" / "history.csv")
    assert [(row.commit, row.bench, row.ratio) for row in again] == [("a", "warp/disk", 0.5), ("b", "warp/disk", 0.6)]
    picture = ElementTree.fromstring(track.svg(again))
    assert len(list(picture.iter("{http://www.w3.org/2000/svg}circle"))) == 2


def test_what_an_earlier_run_left_is_not_of_this_one(tmp_path):
    run(tmp_path, "a", 100.0)
    left = tmp_path / "warp/disk/new/estimates.json"
    before = left.stat().st_mtime - 2 * track.STALE
    os.utime(left, (before, before))
    assert list(track.estimates(tmp_path)) == [track.CALIBRATION]
