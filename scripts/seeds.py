"""Run the quick level with many seeds and count each claim's verdicts: how often the suite cries wolf.

    python scripts/seeds.py                          # seeds 0 to 199; adds to references/seeds.json
    python scripts/seeds.py --seeds 17 101 180 --check   # these again: the same verdicts as in the table

The table holds commit, command, and for each claim how many seeds gave which verdict; seeds that it has for this commit
are not run again. Status: 0 every claim held with every seed (--check: as the table says); 1 not; 2 could not run.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from tables import ROOT, commit, of_this_commit, write

TABLE = ROOT / "references" / "seeds.json"
PROGRAM = ROOT / "target" / "release" / "lightproof"


def verdicts(program, seed):
    """Every claim's verdict with this seed; raises RuntimeError where the program could not run."""
    with tempfile.TemporaryDirectory() as folder:
        command = [str(program), "verify", "--seed", str(seed), "--report", folder]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode not in (0, 1):
            raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()}")
        report = json.loads((Path(folder) / "report.json").read_text(encoding="utf-8"))
    return {claim["id"]: claim["verdict"] for claim in report["claims"]}


def fresh():
    """A table without seeds."""
    return {"commit": commit(), "command": "lightproof verify --seed N", "seeds": [], "claims": 0, "exceptions": []}


def add(table, seed, found):
    """Enters the verdicts of one seed: how many claims there were, and each that did not hold."""
    table["seeds"] = sorted({*table["seeds"], seed})
    table["claims"] = len(found)
    wrong = [{"seed": seed, "claim": claim, "verdict": word} for claim, word in found.items() if word != "holds"]
    table["exceptions"] = [one for one in table["exceptions"] if one["seed"] != seed] + wrong


def differing(table, seed, found):
    """The claims whose verdict isn't the table's."""
    known = {one["claim"]: one["verdict"] for one in table["exceptions"] if one["seed"] == seed}
    return [claim for claim, word in found.items() if word != known.get(claim, "holds")]


def check(table, seeds, program):
    """Whether seeds of the table give the same verdicts again."""
    same = True
    for seed in seeds:
        wrong = differing(table, seed, verdicts(program, seed))
        print(f"seed {seed}: " + (", ".join(wrong) + " differ" if wrong else "the same verdicts"))
        same &= not wrong
    return same


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=list(range(200)), metavar="N")
    parser.add_argument("--check", action="store_true", help="compare with the table instead of adding to it")
    parser.add_argument("--program", type=Path, default=PROGRAM, help="default: target/release/lightproof")
    parser.add_argument("-o", type=Path, default=TABLE, metavar="FILE", help="default: references/seeds.json")
    options = parser.parse_args()
    try:
        if options.check:
            table = json.loads(options.o.read_text(encoding="utf-8")) if options.o.exists() else fresh()
            return 0 if check(table, options.seeds, options.program) else 1
        table = of_this_commit(options.o) or fresh()
        for seed in [seed for seed in options.seeds if seed not in table["seeds"]]:
            add(table, seed, verdicts(options.program, seed))
            write(options.o, table)
            print(f"seed {seed}: {len(table['exceptions'])} exceptions so far", file=sys.stderr, flush=True)
    except (OSError, RuntimeError, json.JSONDecodeError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(f"{len(table['seeds'])} seeds, {table['claims']} claims each, {len(table['exceptions'])} exceptions")
    return 1 if table["exceptions"] else 0


if __name__ == "__main__":
    sys.exit(main())
