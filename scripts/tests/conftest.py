"""Lets the tests import the scripts, and gives them one scene rendered by Mitsuba."""

import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(SCRIPTS))


@pytest.fixture(scope="session")
def rendered(tmp_path_factory):
    """The soft-shadow scene at 32 by 32 with 16 samples from each of 32 seeds: the EXR's path."""
    import render_mitsuba

    path = tmp_path_factory.mktemp("mitsuba") / "soft-shadow.exr"
    assert render_mitsuba.main(["soft-shadow", "--res=32", "--spp=16", "--seeds=32", "-o", str(path)]) == 0
    return path
