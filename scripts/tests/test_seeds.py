import json
import stat

import pytest

import seeds


@pytest.fixture
def program(tmp_path):
    """A stand-in for the program: the claim b/b/b fails with seed 2."""
    path = tmp_path / "lightproof"
    path.write_text("""#!/usr/bin/env python3
import json, pathlib, sys
seed, folder = sys.argv[3], sys.argv[5]
wrong = seed == "2"
claims = [{"id": "a/a/a", "verdict": "holds"}, {"id": "b/b/b", "verdict": "fails" if wrong else "holds"}]
pathlib.Path(folder, "report.json").write_text(json.dumps({"claims": claims}))
sys.exit(2 if seed == "9" else int(wrong))
""", encoding="utf-8")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


def run(monkeypatch, *words):
    monkeypatch.setattr("sys.argv", ["seeds.py", *map(str, words)])
    return seeds.main()


def test_every_verdict_that_is_not_holds_is_an_exception(monkeypatch, tmp_path, program):
    table = tmp_path / "seeds.json"
    assert run(monkeypatch, "--seeds", 0, 1, "--program", program, "-o", table) == 0
    assert run(monkeypatch, "--seeds", 1, 2, "--program", program, "-o", table) == 1
    found = json.loads(table.read_text(encoding="utf-8"))
    assert (found["seeds"], found["claims"]) == ([0, 1, 2], 2)
    assert found["exceptions"] == [{"seed": 2, "claim": "b/b/b", "verdict": "fails"}]


def test_seeds_are_checked_against_the_table(monkeypatch, tmp_path, program):
    table = tmp_path / "seeds.json"
    run(monkeypatch, "--seeds", 0, 2, "--program", program, "-o", table)
    assert run(monkeypatch, "--check", "--seeds", 0, 2, "--program", program, "-o", table) == 0
    table.write_text(table.read_text(encoding="utf-8").replace("b/b/b", "c/c/c"), encoding="utf-8")
    assert run(monkeypatch, "--check", "--seeds", 2, "--program", program, "-o", table) == 1


def test_a_program_that_cannot_run_is_an_error(monkeypatch, tmp_path, program):
    assert run(monkeypatch, "--seeds", 9, "--program", program, "-o", tmp_path / "seeds.json") == 2
