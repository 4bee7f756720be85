import xml.etree.ElementTree as ElementTree

import random_scenes


def scenes(count):
    return [ElementTree.fromstring(random_scenes.Scenes(number).scene()) for number in range(count)]


def plugins(element, tag):
    return [found.get("type") for found in element.iter(tag)]


def test_a_number_is_a_scene():
    first, again, other = (random_scenes.Scenes(number).scene() for number in (3, 3, 4))
    assert first == again != other


def test_every_plugin_and_every_kind_of_light_is_drawn():
    drawn = {tag: {plugin for scene in scenes(200) for plugin in plugins(scene, tag)} for tag in ("shape", "bsdf", "emitter", "sensor")}
    assert drawn["shape"] == {"rectangle", "disk", "sphere", "cube", "cylinder", "obj", "ply", "shapegroup", "instance"}
    assert drawn["bsdf"] == {"diffuse", "conductor", "roughconductor", "dielectric", "roughdielectric", "thindielectric",
                             "plastic", "roughplastic", "twosided", "mask", "blendbsdf"}
    assert drawn["emitter"] == {"area", "constant", "envmap", "point", "directional", "spot"}
    assert drawn["sensor"] == {"perspective", "thinlens"}


def test_what_mitsuba_does_otherwise_is_not_drawn():
    for scene in scenes(400):
        kind = scene.find("integrator").get("type")
        assert kind == "direct" or "mask" not in plugins(scene, "bsdf")
        skies = [plugin for plugin in plugins(scene, "emitter") if plugin in ("constant", "envmap")]
        assert len(skies) == 1
        hides = any(part.get("name") == "hide_emitters" for part in scene.iter("boolean"))
        assert not hides or not {"sphere", "cylinder"} & set(plugins(scene, "shape"))
        for shape in scene.iter("shape"):
            if shape.find("emitter") is not None:
                assert not {"thindielectric", "mask"} & set(plugins(shape, "bsdf"))
                names = {part.get("name"): part.get("value") for part in shape.iter("boolean")}
                assert shape.get("type") not in ("obj", "ply") or names["face_normals"] == "true"
                reflections = [scale for scale in shape.find("transform").iter("scale") if scale.get("x") == "-1"]
                assert shape.get("type") != "cylinder" or not reflections
        for blend in scene.iter("bsdf"):
            if blend.get("type") == "blendbsdf":
                assert not {"conductor", "plastic", "dielectric"} & set(plugins(blend, "bsdf"))


def test_the_worst_scene_gives_the_status(monkeypatch):
    words = {0: "holds: bias 0 %", 1: "undecided: bias 1 %", 2: "fails: bias 9 %", 3: "could not run: error"}
    monkeypatch.setattr(random_scenes, "judged", lambda number, options, folder: words[number])
    assert [random_scenes.main(["--scenes", str(count)]) for count in (1, 2, 3, 4)] == [0, 0, 1, 2]
