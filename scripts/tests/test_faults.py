import json
import xml.etree.ElementTree as ElementTree

import pytest

import faults

ENTRY = """
[[fault]]
id = "one"
class = "wrong measure"
bug = "somebody's"
file = "a.rs"
find = "right"
replace = "wrong"
subject = ["warp/*"]
"""


def catalogue(tmp_path, text):
    path = tmp_path / "faults.toml"
    path.write_text(text, encoding="utf-8")
    return faults.read_catalogue([path])


def test_the_catalogue_plants_exactly_once_and_covers_every_class():
    own = faults.read_catalogue(sorted(faults.CATALOGUE.glob("*.toml")))
    for fault in own:
        assert faults.source(faults.ROOT, fault)
        assert fault.find != fault.replace and fault.bug, fault.id
    kinds = [fault.kind for fault in own]
    assert len(own) >= 60 and all(kinds.count(kind) >= 3 for kind in faults.CLASSES)
    assert sum(fault.percent is not None and fault.percent < 5 for fault in own) >= 20


def test_a_fault_is_planted_and_its_file_can_be_put_back(tmp_path):
    (tmp_path / "a.rs").write_text("all is right here", encoding="utf-8")
    [fault] = catalogue(tmp_path, ENTRY)
    assert faults.plant(tmp_path, fault) == "all is right here"
    assert (tmp_path / "a.rs").read_text(encoding="utf-8") == "all is wrong here"


@pytest.mark.parametrize("text, count", [("nothing", 0), ("right and right", 2)])
def test_a_text_that_is_not_there_once_is_an_error(tmp_path, text, count):
    (tmp_path / "a.rs").write_text(text, encoding="utf-8")
    [fault] = catalogue(tmp_path, ENTRY)
    with pytest.raises(faults.Unplantable, match=f"there {count} times"):
        faults.plant(tmp_path, fault)


@pytest.mark.parametrize("change", [('class = "wrong measure"', 'class = "odd"'), ('find = "right"', ""),
                                    ('bug = "somebody\'s"', 'bug = "x"\ncolour = "red"')])
def test_an_entry_that_is_not_a_fault_is_an_error(tmp_path, change):
    with pytest.raises(faults.Unplantable, match="'one'"):
        catalogue(tmp_path, ENTRY.replace(*change))


def test_ids_are_there_once(tmp_path):
    with pytest.raises(faults.Unplantable, match="2 times"):
        catalogue(tmp_path, ENTRY + ENTRY)


def test_everything_that_does_not_hold_is_a_detection():
    report = {"claims": [{"id": "a/b/c", "verdict": "fails", "n": 5, "seconds": 0.5},
                         {"id": "a/b/d", "verdict": "undecided", "n": 6, "seconds": 0.2},
                         {"id": "a/b/e", "verdict": "holds", "n": 7, "seconds": 0.1}],
              "errors": [{"id": "a/b/f", "message": "panicked"}]}
    assert [one["claim"] for one in faults.detections(report, "quick")] == ["a/b/c", "a/b/d", "a/b/f"]


@pytest.mark.parametrize("keep, kept", [(True, {"one", "two"}), (False, {"one"})])
def test_rows_of_earlier_commits_are_kept_where_asked_for(tmp_path, keep, kept):
    path = tmp_path / "matrix.json"
    rows = [{"id": "one", "commit": faults.commit()}, {"id": "two", "commit": "0123"}]
    path.write_text(json.dumps({"commit": "0123", "faults": rows}), encoding="utf-8")
    options = type("Options", (), {"json": path, "keep": keep})
    assert set(faults.known(options)) == kept
    options.json = tmp_path / "none.json"
    assert faults.known(options) == {}


@pytest.mark.parametrize("script", ["kill -ABRT $$", "exit 101", "python3 -c 'bytearray(7 << 30)' || kill -ABRT $$"])
def test_a_program_that_breaks_off_is_noticed(tmp_path, script):
    program = tmp_path / "program"
    program.write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
    program.chmod(0o755)
    [found] = faults.Workshop(tmp_path, tmp_path).verify(program, "quick", [])
    assert found["claim"] == faults.BROKEN_OFF


def test_the_matrix_has_a_mark_for_each_detection(tmp_path):
    [fault] = catalogue(tmp_path, ENTRY)
    found = [{"claim": "warp/a/b", "level": "quick", "n": 10, "seconds": 0.05},
             {"claim": "warp/c/d", "level": "standard", "n": 20, "seconds": 3.0}]
    matrix = {"commit": "0123456789abcdef", "faults": [{**faults.row(fault, found), "commit": "0123456789abcdef"}]}
    assert (matrix["faults"][0]["n"], matrix["faults"][0]["seconds"]) == (10, 0.05)
    picture = ElementTree.fromstring(faults.svg(json.loads(json.dumps(matrix))))
    titles = [node.text for node in picture.iter("{http://www.w3.org/2000/svg}title")]
    assert titles == ["one: warp/a/b, n = 10, 0.05 s, quick", "one: warp/c/d, n = 20, 3.00 s, standard"]
