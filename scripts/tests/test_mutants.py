import subprocess

import pytest

import mutants
from faults import Unplantable

TEXT = "fn one() -> u32 {\n    a + b\n}\n"
ENTRY = {"name": "a.rs:2:7: replace + with - in one", "package": "renderer", "file": "a.rs", "replacement": "-",
         "span": {"start": {"line": 2, "column": 7}, "end": {"line": 2, "column": 8}}}


class Shop:
    """A workshop in which the parts of a test that are named fail."""

    def __init__(self, copy, failing):
        self.copy, self.failing, self.asked = copy, failing, []
        (copy / "a.rs").write_text(TEXT, encoding="utf-8")

    def build(self):
        return "program"

    def verify(self, program, level, patterns, patience):
        self.asked += patterns
        if "an endless loop" in self.failing:
            raise subprocess.TimeoutExpired("lightproof", patience)
        assert (self.copy / "a.rs").read_text(encoding="utf-8") == TEXT.replace("+", "-")
        return [{"claim": "b/c/d"}] if patterns[0] in self.failing else []


def examined(monkeypatch, tmp_path, failing):
    shop = Shop(tmp_path, failing)
    monkeypatch.setattr(mutants, "passes", lambda shop, words: words[-1] not in failing)
    monkeypatch.setattr(mutants, "families", lambda shop, program: [] if "the list" in failing else ["a", "b", "c"])
    found = mutants.examine(shop, mutants.mutant_of(ENTRY))
    assert (tmp_path / "a.rs").read_text(encoding="utf-8") == TEXT
    return found, shop.asked


def test_a_mutant_replaces_its_span():
    assert mutants.mutated(TEXT, mutants.mutant_of(ENTRY)) == TEXT.replace("+", "-")


@pytest.mark.parametrize("failing, found, asked", [
    (["--lib", "a/*"], "unit tests", []), (["b/*", "c/*"], "b/c/d", ["a/*", "b/*"]),
    (["an endless loop"], "the program, which never ends", ["a/*"]),
    (["the list"], "the program, which cannot list its claims", []),
    (["*"], "tests of the crate", ["a/*", "b/*", "c/*"]), ([], None, ["a/*", "b/*", "c/*"])])
def test_the_first_that_fails_catches(monkeypatch, tmp_path, failing, found, asked):
    assert examined(monkeypatch, tmp_path, failing) == (found, asked)


def test_printing_is_left_out():
    assert mutants.is_printing({"function_name": "<impl Display for A>::fmt"})
    assert not mutants.is_printing({"function_name": "Display"}) and not mutants.is_printing(None)


def test_the_limit_is_clopper_and_pearsons():
    assert mutants.lower_limit(20, 20) == pytest.approx(0.05 ** (1 / 20), abs=1e-15)  # p^20 = 5 %; 60 halvings of [0, 1]
    assert mutants.lower_limit(0, 20) == 0.0
    p = mutants.lower_limit(19, 20)
    assert 20 * p**19 - 19 * p**20 == pytest.approx(0.05, abs=1e-14)  # 19 or 20 of 20; slope below 20


def test_mutants_that_do_not_build_are_replaced(monkeypatch, tmp_path):
    sample = [mutants.mutant_of({**ENTRY, "name": str(k)}) for k in range(9)]

    def examine(shop, mutant):
        if mutant.name in "024":
            raise Unplantable("it does not build")
        return None if mutant.name == "3" else "unit tests"

    monkeypatch.setattr(mutants, "examine", examine)
    monkeypatch.setattr(mutants, "workshops", lambda scratch, jobs: FakeQueue())
    options = type("Options", (), {"scratch": tmp_path, "jobs": 2, "count": 5, "seed": 0, "o": tmp_path / "m.json"})
    rows = mutants.try_all(sample, [], options)
    assert mutants.score(rows)["viable"] == 5 and mutants.score(rows)["caught"] == 4
    assert [row["name"] for row in rows] == list("01234567")


class FakeQueue:
    def get(self):
        return None

    def put(self, shop):
        pass
