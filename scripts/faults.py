"""Plant deliberate faults one at a time, and see which claims catch them: the detection matrix.

    python scripts/faults.py                                   # every fault of verify/suite/faults/*.toml
    python scripts/faults.py --only disk-without-root --first  # one fault, up to the first claims that catch it
    python scripts/faults.py --json matrix.json --svg matrix.svg --catalogue mine.toml
    python scripts/faults.py --json matrix.json --keep         # only faults that no commit's row is there of

Each fault is planted in a copy of the last commit, built, and held first against its subject's claims, then against all
of them at the quick level; where nothing caught it, against its subject's at the standard level, and where these don't
against all. Two at a time. A text that is not there exactly once is an error. Status: 0 every fault was caught; 1 one was not; 2 one could not be planted, built or run.
"""

import argparse
import json
import queue
import resource
import shutil
import subprocess
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape

from tables import ROOT, commit, write

CATALOGUE = ROOT / "verify" / "suite" / "faults"
CLASSES = ["sample, pdf and eval disagree", "wrong measure", "index overflow", "correlated decisions",
           "half-cell offset", "cancellation", "convention mismatch", "comparator bug"]
LEVELS = ["quick", "standard"]
# Changes of the release profile with which one changed file is built in seconds; other people's crates stay the same.
PLANTED = [word for setting in ("incremental=true", "package.renderer.codegen-units=256", "package.renderer.debug=false",
                                "package.verify.debug=false", "package.lightproof.debug=false")
           for word in ("--config", f"profile.release.{setting}")]

# Bytes that a wrong program may take before it is broken off; a tenth is enough for the right one at the quick level.
MEMORY = 6 << 30
PANIC = 101
BROKEN_OFF = "(the program breaks off)"


class Unplantable(Exception):
    """A fault that could not be planted, built or run."""


@dataclass(frozen=True)
class Fault:
    """A wrong version of one file."""
    id: str
    kind: str
    bug: str
    file: str
    find: str
    replace: str
    subject: tuple
    # Largest relative change of a mean or a density in percent; None where it is not small or not a number.
    percent: float | None = None


def read_catalogue(paths):
    """The faults of TOML files; raises on unknown or missing keys, unknown classes and repeated ids."""
    faults = []
    for path in paths:
        for entry in tomllib.loads(path.read_text(encoding="utf-8"))["fault"]:
            faults.append(fault_of(path, dict(entry)))
    ids = [fault.id for fault in faults]
    for name in ids:
        if ids.count(name) > 1:
            raise Unplantable(f"fault '{name}' is there {ids.count(name)} times")
    return faults


def fault_of(path, entry):
    """One entry of a catalogue."""
    name = entry.get("id", "without an id")
    try:
        kind = entry.pop("class")
        # A text that begins on a line of its own does so for the reader.
        texts = {key: entry.pop(key).removeprefix("\n") for key in ("find", "replace")}
        fault = Fault(kind=kind, subject=tuple(entry.pop("subject")), **texts, **entry)
    except (KeyError, TypeError) as error:
        raise Unplantable(f"{path.name}: fault '{name}': {error}") from error
    if fault.kind not in CLASSES:
        raise Unplantable(f"{path.name}: fault '{name}': class '{fault.kind}' is not one of {', '.join(CLASSES)}")
    return fault


def source(root, fault):
    """The text of the file that the fault is for; raises where the fault's text is not in it exactly once."""
    path = root / fault.file
    if not path.is_file():
        raise Unplantable(f"fault '{fault.id}': {fault.file} is not there")
    text = path.read_text(encoding="utf-8")
    count = text.count(fault.find)
    if count != 1:
        raise Unplantable(f"fault '{fault.id}': its text is there {count} times in {fault.file}, not once")
    return text


def plant(root, fault):
    """Writes the fault into the copy at `root`; returns the file's own text."""
    text = source(root, fault)
    (root / fault.file).write_text(text.replace(fault.find, fault.replace), encoding="utf-8")
    return text


def limit_memory():
    """Called in the process to be: paths without end need memory without end."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


@dataclass(frozen=True)
class Workshop:
    """A copy of the sources and a folder for what is built from them."""
    copy: Path
    target: Path

    def cargo(self, *words):
        """A command of cargo for the copy's own release build."""
        return ["cargo", words[0], "--quiet", "--release", *PLANTED, "--target-dir", str(self.target), *words[1:]]

    def build(self):
        """The program made from the copy as it is."""
        done = subprocess.run(self.cargo("build", "--package", "lightproof"), cwd=self.copy, capture_output=True, text=True)
        if done.returncode:
            raise Unplantable("the build failed:\n" + "\n".join(done.stderr.splitlines()[-30:]))
        return self.target / "release" / "lightproof"

    def verify(self, program, level, patterns, patience=None):
        """The claims that do not hold, as a list of {"claim", "level", "n", "seconds"}; `patience` in seconds."""
        report = self.target / "report"
        only = [word for pattern in patterns for word in ("--only", pattern)]
        command = [str(program), "verify", "--level", level, "--threads", "1", "--report", str(report), *only]
        done = subprocess.run(command, cwd=self.copy, capture_output=True, text=True, timeout=patience,
                              preexec_fn=limit_memory)
        if done.returncode < 0 or done.returncode == PANIC:
            return [{"claim": BROKEN_OFF, "level": level, "n": 0, "seconds": 0.0}]
        if done.returncode not in (0, 1) and "could not run" not in done.stderr:
            raise Unplantable(f"{' '.join(command)}\n{done.stderr}")
        return detections(json.loads((report / "report.json").read_text(encoding="utf-8")), level)


def detections(report, level):
    """What a report finds wrong. A claim that could not run has noticed something too."""
    found = [{"claim": claim["id"], "level": level, "n": claim["n"], "seconds": claim["seconds"]}
             for claim in report["claims"] if claim["verdict"] != "holds"]
    return found + [{"claim": error["id"], "level": level, "n": 0, "seconds": 0.0} for error in report.get("errors", [])]


def examine(fault, workshop, first):
    """Plants a fault, and returns its row of the matrix."""
    text = plant(workshop.copy, fault)
    try:
        program = workshop.build()
        found = []
        for level in LEVELS:
            found = workshop.verify(program, level, subject_at(workshop, program, level, fault))
            if found and (first or level != LEVELS[0]):
                break
            seen = {one["claim"] for one in found}
            found += [one for one in workshop.verify(program, level, []) if one["claim"] not in seen]
            if found:
                break
    except Unplantable as error:
        raise Unplantable(f"fault '{fault.id}': {error}") from error
    finally:
        (workshop.copy / fault.file).write_text(text, encoding="utf-8")
    return row(fault, found)


def subject_at(workshop, program, level, fault):
    """The patterns of a fault's subject that name claims of the level."""
    patterns = []
    for pattern in fault.subject:
        command = [str(program), "verify", "--list", "--level", level, "--only", pattern]
        done = subprocess.run(command, cwd=workshop.copy, capture_output=True, text=True)
        if done.returncode == 0:
            patterns.append(pattern)
        elif "run from --level" not in done.stderr:
            raise Unplantable(done.stderr.strip())
    return patterns


def row(fault, found):
    """The JSON of one fault; samples and seconds are those of the fastest claim that caught it."""
    fastest = min(found, key=lambda one: one["seconds"], default={"n": None, "seconds": None})
    return {"id": fault.id, "class": fault.kind, "bug": fault.bug, "percent": fault.percent,
            "caught_by": [one["claim"] for one in found], "n": fastest["n"], "seconds": fastest["seconds"],
            "detections": found}


def copy_of(root, folder):
    """A copy of the last commit; its files are new, so that what a run that was cut off has left is built again."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    archive = subprocess.run(["git", "archive", "HEAD"], cwd=root, check=True, capture_output=True).stdout
    subprocess.run(["tar", "-x", "-m", "-C", str(folder)], input=archive, check=True)
    return folder


def workshops(scratch, count):
    """So many copies, each with a program built from it as it is; what a release build has made already is taken over."""
    benches = queue.Queue()
    for k in range(count):
        workshop = Workshop(copy_of(ROOT, scratch / f"copy-{k}"), scratch / f"target-{k}")
        made = ROOT / "target" / "release"
        for part in ("build", "deps", ".fingerprint"):
            if (made / part).is_dir() and not (workshop.target / "release" / part).exists():
                shutil.copytree(made / part, workshop.target / "release" / part, copy_function=shutil.copy2)
        workshop.build()
        benches.put(workshop)
    return benches


def known(options):
    """The rows of an earlier run, by fault: what one that was cut off has found on this commit; with --keep on any."""
    if not (options.json and options.json.exists()):
        return {}
    rows = json.loads(options.json.read_text(encoding="utf-8"))["faults"]
    return {row["id"]: row for row in rows if options.keep or row["commit"] == commit()}


def examine_all(faults, options):
    """The matrix: every fault's row, in the order of the catalogue; written after each fault."""
    rows, at = known(options), commit()
    wanted = [fault for fault in faults if fault.id not in rows]
    benches = workshops(options.scratch, min(options.jobs, len(wanted)))

    def one(fault):
        workshop = benches.get()
        try:
            result = {**examine(fault, workshop, options.first), "commit": at}
        finally:
            benches.put(workshop)
        caught = result["caught_by"]
        word = f"{len(caught)} claims" if len(caught) > 1 else (caught or ["NOT CAUGHT"])[0]
        print(f"{fault.id:28} {word}", file=sys.stderr, flush=True)
        return result

    matrix = {"commit": at, "faults": [rows[fault.id] for fault in faults if fault.id in rows]}
    with ThreadPoolExecutor(options.jobs) as pool:
        try:
            for future in as_completed([pool.submit(one, fault) for fault in wanted]):
                rows[future.result()["id"]] = future.result()
                matrix["faults"] = [rows[fault.id] for fault in faults if fault.id in rows]
                if options.json:
                    write(options.json, matrix)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return matrix


def svg(matrix):
    """The detection matrix as a picture: a row a fault, a column a claim, darker where it was caught sooner."""
    rows = sorted(matrix["faults"], key=lambda fault: CLASSES.index(fault["class"]))
    claims = sorted({claim for fault in rows for claim in fault["caught_by"]})
    left, top, cell = 330, 170, 9
    width, height = left + cell * len(claims) + 20, top + cell * len(rows) + 40
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" '
             f'font-size="8"><rect width="100%" height="100%" fill="white"/>',
             f'<text x="8" y="16" font-size="12">{len(rows)} faults against {len(claims)} claims; commit '
             f'{" and ".join(sorted({row["commit"][:12] for row in rows}))}; dark: caught within 0.1 s, pale: more, orange: at the standard level only</text>']
    for x, claim in enumerate(claims):
        at = left + cell * x + 7
        parts.append(f'<text transform="translate({at},{top - 4}) rotate(-60)">{escape(claim)}</text>')
    for y, fault in enumerate(rows):
        at = top + cell * y
        name = escape(f'{fault["id"]}  ({fault["class"]})')
        parts.append(f'<text x="{left - 6}" y="{at + 7}" text-anchor="end">{name}</text>')
        for one in fault["detections"]:
            x = left + cell * claims.index(one["claim"])
            fill = "#1b4f8a" if one["seconds"] < 0.1 else "#6f9fd0" if one["level"] == "quick" else "#e0a050"
            title = escape(f'{fault["id"]}: {one["claim"]}, n = {one["n"]}, {one["seconds"]:.2f} s, {one["level"]}')
            parts.append(f'<rect x="{x}" y="{at}" width="{cell - 1}" height="{cell - 1}" fill="{fill}">'
                         f"<title>{title}</title></rect>")
    return "\n".join([*parts, "</svg>\n"])


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", metavar="ID", help="this fault; may be repeated")
    parser.add_argument("--first", action="store_true", help="stop at the subject's claims where they catch a fault")
    parser.add_argument("--catalogue", type=Path, metavar="FILE.toml", help="faults from elsewhere")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the matrix; faults that it has for this commit are not run again")
    parser.add_argument("--keep", action="store_true", help="keep the rows of earlier commits too; each says its own")
    parser.add_argument("--svg", type=Path, metavar="FILE", help="draw the matrix")
    parser.add_argument("--scratch", type=Path, default=ROOT / "target" / "faults", metavar="DIR",
                        help="for the copies and what is built (default: target/faults)")
    parser.add_argument("--jobs", type=int, default=2, help="faults at a time (default: 2)")
    return parser.parse_args()


def chosen(faults, only):
    """The faults asked for; raises on an id that isn't there."""
    missing = set(only or []) - {fault.id for fault in faults}
    if missing:
        raise Unplantable(f"no fault is called {', '.join(sorted(missing))}")
    return [fault for fault in faults if not only or fault.id in only]


def main():
    options = arguments()
    paths = [options.catalogue] if options.catalogue else sorted(CATALOGUE.glob("*.toml"))
    try:
        faults = chosen(read_catalogue(paths), options.only)
        for fault in faults:
            source(ROOT, fault)
        matrix = examine_all(faults, options)
    except (Unplantable, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    if options.svg:
        options.svg.write_text(svg(matrix), encoding="utf-8")
    missed = [fault["id"] for fault in matrix["faults"] if not fault["caught_by"]]
    alone = [f'{fault["id"]} by {fault["caught_by"][0]}' for fault in matrix["faults"] if len(fault["caught_by"]) == 1]
    print(f'{len(matrix["faults"])} faults, {len(matrix["faults"]) - len(missed)} caught')
    if alone and not options.first:
        print("caught by a single claim: " + "; ".join(alone))
    if missed:
        print("not caught: " + ", ".join(missed))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
