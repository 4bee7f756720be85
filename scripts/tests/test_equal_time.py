import equal_time
import pytest


def test_every_scene_is_there_and_all_are_rendered_by_default():
    options = equal_time.parse([])
    assert options.scenes == equal_time.SCENES
    assert all(options.path(scene).is_file() for scene in options.scenes)
    assert options.parameters("direct") == {} and options.parameters("mesh")["ply"].endswith("mesh.ply")


def test_one_seed_has_no_variance():
    with pytest.raises(SystemExit):
        equal_time.parse(["--seeds=1"])


def test_llvm_is_taken_from_the_environment(monkeypatch):
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", "libLLVM.so")
    assert equal_time.find_llvm() == "libLLVM.so"


def test_a_scene_that_is_not_there_is_refused():
    with pytest.raises(SystemExit):
        equal_time.parse(["sponza"])
