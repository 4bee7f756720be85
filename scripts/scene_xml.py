"""Mitsuba scene files as trees: includes put in place, names resolved, motion frozen at an instant."""

import copy
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np

FILE_PARAMETERS = ("filename",)


def read(path, parameters=None):
    """The scene's tree with includes inlined and $names replaced, and the files that it refers to.

    * `parameters`: values that override the scene's `<default>`s.
    Returns: the root element, and the list of paths read or named, the scene itself first. File names in
    the tree are absolute, so that the tree can be loaded from text.
    """
    files = []
    root = _inlined(Path(path).resolve(), files, ())
    values = {}
    for element in root.iter("default"):
        values.setdefault(element.get("name"), element.get("value"))
    values.update(parameters or {})
    for element in root.iter():
        _substitute(element, values)
    folder = Path(path).resolve().parent
    for element in root.iter("string"):
        if element.get("name") in FILE_PARAMETERS:
            file = folder / element.get("value")
            element.set("value", str(file))
            files.append(file)
    return root, files


def _inlined(path, files, parents):
    if path in parents:
        raise ValueError(f"{path}: includes itself")
    files.append(path)
    root = ElementTree.parse(path).getroot()
    for parent in list(root.iter()):
        for child in list(parent):
            if child.tag == "include":
                at = list(parent).index(child)
                parent.remove(child)
                included = _inlined(path.parent / child.get("filename"), files, (*parents, path))
                # What is included is a scene of its own, or one element.
                for element in reversed(list(included) if included.tag == "scene" else [included]):
                    parent.insert(at, element)
    return root


def _substitute(element, values):
    if element.tag == "default":
        return
    for key, text in element.attrib.items():
        # Longer names first: $res must not replace the start of $resolution.
        for name in sorted(values, key=len, reverse=True):
            text = text.replace(f"${name}", str(values[name]))
        element.set(key, text)


def with_filter(root, kind):
    """A copy of the tree whose films all have the reconstruction filter `kind` with its default width."""
    root = copy.deepcopy(root)
    for film in root.iter("film"):
        for old in film.findall("rfilter"):
            film.remove(old)
        ElementTree.SubElement(film, "rfilter", type=kind)
    return root


def to_text(root):
    """The tree as a file's text."""
    return ElementTree.tostring(root, encoding="unicode")


def moves(root):
    """Whether anything in the tree is animated."""
    return next(root.iter("animation"), None) is not None


def shutter(root):
    """The times at which the first sensor's shutter opens and closes."""
    sensor = next(root.iter("sensor"))
    values = {f.get("name"): float(f.get("value")) for f in sensor.findall("float")}
    return values.get("shutter_open", 0.0), values.get("shutter_close", 0.0)


def at_instant(root, time):
    """A copy of the tree in which every animation is the transform that it has at `time`."""
    root = copy.deepcopy(root)
    for animation in root.iter("animation"):
        matrix = interpolated(keys_of(animation), time)
        name = animation.get("name")
        animation.clear()
        animation.tag = "transform"
        animation.set("name", name)
        ElementTree.SubElement(animation, "matrix", value=" ".join(repr(float(v)) for v in matrix.ravel()))
    for sensor in root.iter("sensor"):
        for parameter in list(sensor.findall("float")):
            if parameter.get("name") in ("shutter_open", "shutter_close"):
                sensor.remove(parameter)
    return root


def keys_of(animation):
    """The keys of an animation, (time, 4 by 4 matrix), in order of time."""
    keys = [(float(t.get("time")), matrix_of(t)) for t in animation.findall("transform")]
    if not keys:
        raise ValueError("an animation needs at least one transform")
    return sorted(keys, key=lambda key: key[0])


def interpolated(keys, time):
    """The transform between two keys: translation, rotation and scaling each on their own.

    The linear part is split as rotation times symmetric matrix (polar decomposition); rotations turn about
    one axis at constant speed by the smaller angle; the symmetric part and the translation are linear in
    time. Before the first key and after the last the transform stands still.
    """
    times = [t for t, _ in keys]
    if time <= times[0]:
        return keys[0][1]
    if time >= times[-1]:
        return keys[-1][1]
    i = int(np.searchsorted(times, time, side="right")) - 1
    s = (time - times[i]) / (times[i + 1] - times[i])
    (q0, p0), (q1, p1) = polar(keys[i][1]), polar(keys[i + 1][1])
    result = np.eye(4)
    result[:3, :3] = turned(q0, q1, s) @ ((1 - s) * p0 + s * p1)
    result[:3, 3] = (1 - s) * keys[i][1][:3, 3] + s * keys[i + 1][1][:3, 3]
    return result


def polar(matrix):
    """The rotation and the symmetric matrix whose product is the linear part."""
    u, singular, vt = np.linalg.svd(matrix[:3, :3])
    if np.linalg.det(u @ vt) < 0:
        raise ValueError("a key's transform mirrors: no rotation leads to it")
    return u @ vt, vt.T @ np.diag(singular) @ vt


def turned(start, end, s):
    """The rotation a fraction s of the way from `start` to `end`, by the smaller angle."""
    change = end @ start.T
    cosine = np.clip((np.trace(change) - 1) / 2, -1.0, 1.0)
    angle = np.arccos(cosine)
    if angle == 0.0:
        return start
    if np.pi - angle < 1e-6:  # sin(angle) then has fewer than 10 digits, and at pi the axis has two senses
        raise ValueError("two keys half a turn apart: the shortest turn isn't unique")
    axis = np.array([change[2, 1] - change[1, 2], change[0, 2] - change[2, 0], change[1, 0] - change[0, 1]])
    return rotation(axis / (2 * np.sin(angle)), s * angle) @ start


def rotation(axis, radians):
    """The 3 by 3 rotation about a unit axis (Rodrigues' formula)."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(radians) * k + (1 - np.cos(radians)) * (k @ k)


def matrix_of(transform):
    """The 4 by 4 matrix of a `<transform>`: its operations, the first applied first."""
    result = np.eye(4)
    for operation in transform:
        result = _operation(operation) @ result
    return result


def _operation(element):
    matrix = np.eye(4)
    if element.tag == "translate":
        matrix[:3, 3] = _vector(element, 0.0)
    elif element.tag == "scale":
        matrix[:3, :3] = np.diag(_vector(element, 1.0))
    elif element.tag == "rotate":
        axis = _vector(element, 0.0)
        matrix[:3, :3] = rotation(axis / np.linalg.norm(axis), np.radians(float(element.get("angle"))))
    elif element.tag == "matrix":
        matrix = np.array(_numbers(element.get("value"))).reshape(4, 4)
    elif element.tag == "lookat":
        matrix = _lookat(*(np.array(_numbers(element.get(k))) for k in ("origin", "target", "up")))
    else:
        raise ValueError(f"unknown operation <{element.tag}> in a transform")
    return matrix


def _lookat(origin, target, up):
    forward = (target - origin) / np.linalg.norm(target - origin)
    left = np.cross(up, forward)
    left /= np.linalg.norm(left)
    matrix = np.eye(4)
    matrix[:3, :] = np.stack([left, np.cross(forward, left), forward, origin], axis=1)
    return matrix


def _vector(element, missing):
    value = element.get("value")
    if value is not None:
        numbers = _numbers(value)
        return np.array(numbers * 3 if len(numbers) == 1 else numbers)
    return np.array([float(element.get(k, missing)) for k in "xyz"])


def _numbers(text):
    return [float(v) for v in text.replace(",", " ").split()]
