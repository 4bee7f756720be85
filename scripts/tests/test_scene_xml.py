import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import scene_xml
from render_mitsuba import ROOT, instants


def animation(*keys):
    text = "".join(f'<transform time="{t}">{operations}</transform>' for t, operations in keys)
    return scene_xml.keys_of(ElementTree.fromstring(f'<animation name="to_world">{text}</animation>'))


def test_operations_apply_in_the_order_written():
    keys = animation((0, '<scale value="2"/><rotate z="1" angle="90"/><translate x="1"/>'))
    # (1, 0, 0) is scaled to (2, 0, 0), turned to (0, 2, 0), moved to (1, 2, 0); rounding of sin and cos: 1e-15.
    assert np.abs(keys[0][1] @ [1, 0, 0, 1] - [1, 2, 0, 1]).max() < 1e-15


def test_lookat_is_the_frame_that_mitsuba_makes():
    import mitsuba as mi
    mi.set_variant("scalar_rgb")
    theirs = mi.ScalarTransform4f().look_at(origin=[1, 2, 3], target=[0, 0.5, -1], up=[0, 1, 0])
    text = '<lookat origin="1,2,3" target="0,0.5,-1" up="0,1,0"/>'
    # Mitsuba computes in single precision: a few roundings of 6e-8 of numbers up to 3.
    assert np.abs(animation((0, text))[0][1] - np.array(theirs.matrix)).max() < 1e-6


def test_halfway_a_turn_has_half_its_angle_and_keeps_its_size():
    keys = animation((1, '<scale value="3"/><rotate y="1" angle="10"/><translate x="2"/>'),
                     (3, '<scale value="3"/><rotate y="1" angle="70"/><translate x="4"/>'))
    expected = animation((0, '<scale value="3"/><rotate y="1" angle="25"/><translate x="2.5"/>'))[0][1]
    # A quarter of the way; a dozen f64 operations on numbers up to 4.
    assert np.abs(scene_xml.interpolated(keys, 1.5) - expected).max() < 1e-14


def test_turns_take_the_smaller_angle_and_refuse_half_a_turn():
    keys = animation((0, '<rotate z="1" angle="170"/>'), (1, '<rotate z="1" angle="-170"/>'))
    expected = animation((0, '<rotate z="1" angle="180"/>'))[0][1]
    # arccos near cos 20° loses a factor 1/sin 20° = 3 of a rounding 2e-16.
    assert np.abs(scene_xml.interpolated(keys, 0.5) - expected).max() < 1e-14
    with pytest.raises(ValueError, match="half a turn"):
        scene_xml.interpolated(animation((0, ""), (1, '<rotate z="1" angle="180"/>')), 0.5)


def test_outside_its_keys_an_animation_stands_still():
    keys = animation((1, '<translate x="1"/>'), (2, '<translate x="2"/>'))
    assert np.array_equal(scene_xml.interpolated(keys, 0), keys[0][1])
    assert np.array_equal(scene_xml.interpolated(keys, 9), keys[1][1])


def test_an_instant_of_the_moving_scene_has_no_animation_left():
    root, files = scene_xml.read(ROOT / "references" / "scenes" / "moving.xml", {"res": "8"})
    assert scene_xml.moves(root) and scene_xml.shutter(root) == (0.0, 1.0)
    still = scene_xml.at_instant(root, 0.25)
    assert not scene_xml.moves(still) and scene_xml.shutter(still) == (0.0, 0.0)
    assert len(list(root.iter("animation"))) == 3 and len(list(still.iter("matrix"))) == 3
    assert [f.name for f in files] == ["moving.xml"]


def test_includes_names_and_files_are_put_in_place(tmp_path):
    (tmp_path / "part.xml").write_text('<scene version="3.0.0"><shape type="obj">'
                                       '<string name="filename" value="$mesh.obj"/></shape></scene>')
    (tmp_path / "a.xml").write_text('<scene version="3.0.0"><default name="mesh" value="cube"/><a/>'
                                    '<include filename="part.xml"/><b/><film><rfilter type="gaussian"/></film></scene>')
    root, files = scene_xml.read(tmp_path / "a.xml", {"mesh": "ball"})
    assert [e.tag for e in root] == ["default", "a", "shape", "b", "film"]
    assert [f.name for f in files] == ["a.xml", "part.xml", "ball.obj"]
    assert [f.get("type") for f in scene_xml.with_filter(root, "box").iter("rfilter")] == ["box"]
    assert [f.get("type") for f in root.iter("rfilter")] == ["gaussian"]


def test_an_include_loop_is_refused(tmp_path):
    (tmp_path / "a.xml").write_text('<scene version="3.0.0"><include filename="a.xml"/></scene>')
    with pytest.raises(ValueError, match="includes itself"):
        scene_xml.read(tmp_path / "a.xml")


def test_instants_are_one_in_each_part_of_the_interval():
    times = instants(1.0, 3.0, 64, seed=5)
    assert np.array_equal(np.floor((times - 1.0) / 2.0 * 64), np.arange(64))
    assert not np.array_equal(times, instants(1.0, 3.0, 64, seed=6))
