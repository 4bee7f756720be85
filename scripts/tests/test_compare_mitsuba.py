import os
import sys

import compare_mitsuba


def program(folder, compare_status):
    """A stand-in for lightproof: notes its arguments, writes nothing, and ends `compare` with the given status."""
    path = folder / "program"
    path.write_text(f"#!{sys.executable}\nimport sys, pathlib\n"
                    f"with open({str(folder / 'calls')!r}, 'a') as f: print(*sys.argv[1:], file=f)\n"
                    f"if sys.argv[1] == 'compare': sys.exit({compare_status} if pathlib.Path(sys.argv[3]).exists() else 2)\n")
    os.chmod(path, 0o755)
    return str(path)


def test_the_status_is_that_of_compare(tmp_path):
    for status in (0, 1):
        arguments = ["--program", program(tmp_path, status), "--res=16", "--spp=1", "--seeds=2"]
        assert compare_mitsuba.main(arguments) == status
    render, compare = (tmp_path / "calls").read_text().splitlines()[:2]
    assert "soft-shadow.xml -Dres=16 --spp 2 --replicates 2 -o" in render
    assert compare.startswith("compare ") and compare.endswith("theirs.exr --max-bias 0.5")


def test_what_cannot_run_is_status_2(tmp_path):
    # The moving scene without instants is refused before lightproof is called.
    arguments = ["moving", "--program", program(tmp_path, 0), "--res=16", "--spp=1", "--seeds=2"]
    assert compare_mitsuba.main(arguments) == 2
    assert not (tmp_path / "calls").exists()
