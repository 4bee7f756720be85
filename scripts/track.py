"""Keep the history of the benchmarks: what criterion measured, as ratios to a calibration loop of the same run.

    cargo bench -p benches && python scripts/track.py        # adds a row a benchmark, says what changed
    python scripts/track.py --svg history.svg                # and draws it

A ratio's interval combines criterion's 95 % intervals of the benchmark and of the calibration; a change since the last
commit in the history is flagged where the difference of the logarithms lies outside the combined interval. Criterion's
intervals are those of one run: on a machine with other work, flags come without a change, too. Status: 0 nothing grew;
1 a benchmark is flagged as slower; 2 there is nothing to read.
"""

import argparse
import csv
import json
import math
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from xml.sax.saxutils import escape

from tables import ROOT, commit

HISTORY = ROOT / "references" / "bench" / "history.csv"
CALIBRATION = "calibration/loop"
# Estimates that are so many seconds older than the newest are of an earlier run, or of a benchmark that is no more.
STALE = 6 * 3600


class NothingToRead(Exception):
    """No estimates, or none of the calibration."""


@dataclass(frozen=True)
class Row:
    """A benchmark's time over the calibration's in one run, with its 95 % interval."""
    commit: str
    bench: str
    ratio: float
    low: float
    high: float


def estimates(folder):
    """Criterion's mean times under a folder, each with half its interval as a share of it: {id: (ns, share)}."""
    found = {}
    written = {path: path.stat().st_mtime for path in sorted(folder.glob("**/new/estimates.json"))}
    newest = max(written.values(), default=0.0)
    for path in (path for path, time in written.items() if time > newest - STALE):
        mean = json.loads(path.read_text(encoding="utf-8"))["mean"]
        name = json.loads((path.parent / "benchmark.json").read_text(encoding="utf-8"))["full_id"]
        interval = mean["confidence_interval"]
        half = (interval["upper_bound"] - interval["lower_bound"]) / 2
        found[name] = (mean["point_estimate"], half / mean["point_estimate"])
    return found


def rows(found, at):
    """The estimates of the commit `at` over the calibration; raises where that is missing."""
    if CALIBRATION not in found:
        raise NothingToRead(f"no estimate of {CALIBRATION}; `cargo bench -p benches` makes it")
    unit, unit_share = found.pop(CALIBRATION)
    for name, (time, share) in sorted(found.items()):
        ratio, spread = time / unit, math.exp(math.hypot(share, unit_share))
        yield Row(at, name, ratio, ratio / spread, ratio * spread)


def read(path):
    """The history's rows, the oldest first; none where there is no file."""
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return [Row(row["commit"], row["bench"], *(float(row[key]) for key in ("ratio", "low", "high")))
                for row in csv.DictReader(file)]


def write(path, history):
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, ["commit", "bench", "ratio", "low", "high"])
        table.writeheader()
        for row in history:
            table.writerow({**asdict(row), **{key: f"{getattr(row, key):.6g}" for key in ("ratio", "low", "high")}})


def change(before, after):
    """How many times as long it takes, and whether the interval of that excludes 1."""
    factor = after.ratio / before.ratio
    spread = math.hypot(math.log(before.high / before.ratio), math.log(after.high / after.ratio))
    return factor, abs(math.log(factor)) > spread


def compare(history, added):
    """(benchmark, factor, flagged) for each added row whose benchmark has an earlier commit in the history."""
    last = {row.bench: row for row in history}
    return [(row.bench, *change(last[row.bench], row)) for row in added if row.bench in last]


def svg(history):
    """The history as a picture: a strip a benchmark, its ratios with their intervals over those of its first commit."""
    benches = sorted({row.bench for row in history})
    commits = list(dict.fromkeys(row.commit for row in history))
    left = 16 + 6 * max((len(bench) for bench in benches), default=0)
    step, height = max(24, 480 // max(1, len(commits))), 34
    width = left + step * len(commits) + 20
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{40 + height * len(benches)}" '
             f'font-family="sans-serif" font-size="11"><rect width="100%" height="100%" fill="white"/>',
             f'<text x="8" y="18">time over the first commit\'s, 0.5 to 2; {len(commits)} commits</text>']
    for k, bench in enumerate(benches):
        own = [row for row in history if row.bench == bench]
        middle = 40 + height * (k + 0.5)

        def at(value, first=own[0].ratio, middle=middle):
            share = math.log2(min(max(value / first, 0.5), 2.0))
            return middle - share * 0.45 * height

        parts.append(f'<text x="{left - 8}" y="{middle + 4}" text-anchor="end">{escape(bench)}</text>')
        parts.append(f'<line x1="{left}" x2="{width - 20}" y1="{middle}" y2="{middle}" stroke="#ddd"/>')
        for row in own:
            x = left + step * (commits.index(row.commit) + 0.5)
            title = escape(f"{row.commit[:12]}: {row.ratio:.4g} in {row.low:.4g} to {row.high:.4g}")
            parts.append(f'<g stroke="#1b4f8a" fill="#1b4f8a"><line x1="{x}" x2="{x}" y1="{at(row.low):.1f}" '
                         f'y2="{at(row.high):.1f}"/><circle cx="{x}" cy="{at(row.ratio):.1f}" r="2.5"/>'
                         f"<title>{title}</title></g>")
    return "\n".join([*parts, "</svg>\n"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--criterion", type=Path, default=ROOT / "target" / "criterion", metavar="DIR",
                        help="criterion's results (default: target/criterion)")
    parser.add_argument("--history", type=Path, default=HISTORY, metavar="FILE",
                        help="default: references/bench/history.csv")
    parser.add_argument("--svg", type=Path, metavar="FILE", help="draw the history")
    options = parser.parse_args()
    try:
        added = list(rows(estimates(options.criterion), commit()))
    except (NothingToRead, OSError, KeyError, json.JSONDecodeError) as error:
        print(f"error: {options.criterion}: {error}", file=sys.stderr)
        return 2
    history = [row for row in read(options.history) if row.commit != commit()]
    slower = False
    for bench, factor, flagged in compare(history, added):
        slower |= flagged and factor > 1
        print(f"{bench:36} {factor:6.3f} ×{'  CHANGED' if flagged else ''}")
    write(options.history, history + added)
    if options.svg:
        options.svg.write_text(svg(history + added), encoding="utf-8")
    print(f"{len(added)} benchmarks of {commit()[:12]} in {options.history}")
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
