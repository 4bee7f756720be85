"""Mutate the sources one place at a time, and see which mutants the tests and claims catch: the mutation score.

    python scripts/mutants.py                          # 200 viable mutants drawn with seed 0; adds to references/mutants.json
    python scripts/mutants.py --count 40 --seed 7 -o target/some.json

cargo-mutants lists the mutants of the renderer's sampling, materials, lights, camera, film and shapes and of verify (all but
those of Debug and Display); a seeded sample is planted, each into a copy of the last commit, and held against the unit tests
of its crate, the claims at the quick level, and the crate's other tests, until one of them fails. A mutant that does not
build is not viable, and another one takes its place. Mutants that the table has for this commit
are not tried again. Status: 0 the lower 95 % limit of the caught share is at least 85 %; 1 it is not; 2 could not run.
"""

import argparse
import json
import random
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from math import comb
from pathlib import Path

from faults import Unplantable, limit_memory, workshops
from tables import ROOT, commit, of_this_commit, write

TABLE = ROOT / "references" / "mutants.json"
SOURCES = [*(f"renderer/src/{part}/**/*.rs" for part in ("sampling", "materials", "lights", "camera", "film", "shapes")),
           "verify/src/**/*.rs"]
GOAL = 0.85
# Seconds after which a mutant's tests or claims are taken for endless: 10 times what they take when nothing is wrong.
PATIENCE = 300


@dataclass(frozen=True)
class Mutant:
    """A replacement of a span of one file."""
    name: str
    package: str
    file: str
    # Line and column of its first character, and of the one behind its last; both from 1.
    start: tuple
    end: tuple
    replacement: str


def is_printing(function):
    """Whether a function belongs to Debug or Display."""
    name = (function or {}).get("function_name", "")
    return "Debug for" in name or "Display for" in name


def listed():
    """Every mutant that cargo-mutants names, in its order."""
    patterns = [word for source in SOURCES for word in ("--file", source)]
    command = ["cargo", "mutants", "--list", "--json", "--package", "renderer", "--package", "verify", *patterns]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        raise Unplantable(f"{' '.join(command)}: {done.stderr.strip()}")
    return [mutant_of(entry) for entry in json.loads(done.stdout) if not is_printing(entry.get("function"))]


def mutant_of(entry):
    """One entry of the list."""
    start, end = ((entry["span"][edge]["line"], entry["span"][edge]["column"]) for edge in ("start", "end"))
    return Mutant(entry["name"], entry["package"], entry["file"], start, end, entry["replacement"])


def offset(text, place):
    """Where a line and column are in a text."""
    line, column = place
    lines = text.splitlines(keepends=True)
    return sum(len(one) for one in lines[:line - 1]) + column - 1


def mutated(text, mutant):
    """The text with the mutant's span replaced."""
    return text[:offset(text, mutant.start)] + mutant.replacement + text[offset(text, mutant.end):]


def passes(workshop, words):
    """Whether `cargo test` with these words passes; raises Unplantable where it doesn't build."""
    command = workshop.cargo("test", *words)
    built = subprocess.run([*command, "--no-run"], cwd=workshop.copy, capture_output=True, text=True)
    if built.returncode:
        raise Unplantable(built.stderr)
    # `timeout` ends what cargo has started too.
    return subprocess.run(["timeout", str(PATIENCE), *command], cwd=workshop.copy, capture_output=True,
                          preexec_fn=limit_memory).returncode == 0


def families(workshop, program):
    """The first parts of the claims' names, in the program's order."""
    done = subprocess.run([str(program), "verify", "--list"], cwd=workshop.copy, capture_output=True, text=True,
                          timeout=PATIENCE, preexec_fn=limit_memory)
    return list(dict.fromkeys(line.split("/")[0] for line in done.stdout.splitlines()))


def claims_that_fail(workshop):
    """The claims of the quick level that notice something, at most three by name; a program that never ends too.

    Family after family, up to the first in which one is: a claim that fails has tried again with 21 times the work.
    """
    program = workshop.build()
    try:
        found = families(workshop, program)
        if not found:
            return "the program, which cannot list its claims"
        for family in found:
            failing = workshop.verify(program, "quick", [f"{family}/*"], PATIENCE)
            if failing:
                return ", ".join(one["claim"] for one in failing[:3])
    except subprocess.TimeoutExpired:
        return "the program, which never ends"
    return None


def examine(workshop, mutant):
    """What catches a mutant: words, or None where nothing does; raises Unplantable where it is not viable."""
    path = workshop.copy / mutant.file
    text = path.read_text(encoding="utf-8")
    path.write_text(mutated(text, mutant), encoding="utf-8")
    try:
        if not passes(workshop, ["--package", mutant.package, "--lib"]):
            return "unit tests"
        return (claims_that_fail(workshop)
                or (None if passes(workshop, ["--package", mutant.package, "--test", "*"]) else "tests of the crate"))
    finally:
        path.write_text(text, encoding="utf-8")


def lower_limit(caught, count):
    """The share of which `caught` or more of `count` would be seen with probability 5 % (Clopper and Pearson)."""
    def tail(p):
        return sum(comb(count, k) * p**k * (1 - p)**(count - k) for k in range(caught, count + 1))
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if tail(middle) < 0.05 else (low, middle)
    return low if caught else 0.0


def score(rows):
    """Caught, missed and their share's limit."""
    viable = [row for row in rows if row["viable"]]
    caught = sum(row["caught_by"] is not None for row in viable)
    return {"viable": len(viable), "caught": caught,
            "lower_limit": round(lower_limit(caught, len(viable)), 4) if viable else 0.0}


def try_all(sample, rows, options):
    """Adds rows, in the order of the sample, until so many are viable; the table is written after each."""
    done = {row["name"] for row in rows}
    wanted = [mutant for mutant in sample if mutant.name not in done]
    shops = workshops(options.scratch, options.jobs)

    def one(mutant):
        shop = shops.get()
        try:
            return {"name": mutant.name, "viable": True, "caught_by": examine(shop, mutant)}
        except Unplantable:
            return {"name": mutant.name, "viable": False, "caught_by": None}
        finally:
            shops.put(shop)

    table = {"commit": commit(), "command": f"python scripts/mutants.py --count {options.count} --seed {options.seed}"}
    with ThreadPoolExecutor(options.jobs) as pool:
        while wanted and (missing := options.count - score(rows)["viable"]) > 0:
            for row in pool.map(one, [wanted.pop(0) for _ in range(min(missing, len(wanted), 12 * options.jobs))]):
                rows.append(row)
                print(f'{row["name"]}: ' + ((row["caught_by"] or "MISSED") if row["viable"] else "not viable"),
                      file=sys.stderr, flush=True)
                write(options.o, {**table, **score(rows), "mutants": rows})
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200, help="viable mutants (default: 200)")
    parser.add_argument("--seed", type=int, default=0, help="of the sample (default: 0)")
    parser.add_argument("-o", type=Path, default=TABLE, metavar="FILE", help="default: references/mutants.json")
    parser.add_argument("--scratch", type=Path, default=ROOT / "target" / "mutants", metavar="DIR",
                        help="for the copies and what is built (default: target/mutants)")
    parser.add_argument("--jobs", type=int, default=2, help="mutants at a time (default: 2)")
    options = parser.parse_args()
    try:
        table = of_this_commit(options.o)
        rows = table["mutants"] if table else []
        mutants = listed()
        rows = try_all(random.Random(options.seed).sample(mutants, len(mutants)), rows, options)
    except (OSError, Unplantable, json.JSONDecodeError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    found = score(rows)
    print(f'{found["caught"]} of {found["viable"]} viable mutants caught; at least {100 * found["lower_limit"]:.1f} %')
    for row in rows:
        if row["viable"] and row["caught_by"] is None:
            print(f'missed: {row["name"]}')
    return 0 if found["lower_limit"] >= GOAL else 1


if __name__ == "__main__":
    sys.exit(main())
