#!/usr/bin/env bash
# The Python scripts' tests, in an environment made here: .venv with the pinned packages.
set -euo pipefail
cd "$(dirname "$0")/.."
[ -x .venv/bin/python ] || python3 -m venv .venv
.venv/bin/python -m pip install --quiet --disable-pip-version-check -r scripts/requirements.txt
exec .venv/bin/python -m pytest -q scripts/tests
