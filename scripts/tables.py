"""Tables that are committed: from which commit they are, and how they are written."""

import json
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def commit():
    """The last commit."""
    return subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, check=True, capture_output=True,
                          text=True).stdout.strip()


def of_this_commit(path):
    """The table at a path if it is there and of the last commit, what a run that was cut off has found; else None."""
    if not path.exists():
        return None
    table = json.loads(path.read_text(encoding="utf-8"))
    return table if table["commit"] == commit() else None


def write(path, table):
    """Writes a table beside itself first, so that a run that is cut off leaves the last whole one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_suffix(".part")
    beside.write_text(json.dumps(table, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    beside.replace(path)
