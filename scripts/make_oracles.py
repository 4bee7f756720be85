"""Write references/stability/*.csv: hard inputs of our routines and their values to 50 digits, by mpmath.

Inputs are exact binary numbers (single precision unless the routine takes double);
values are what the routine's definition gives for exactly these inputs.

    python scripts/make_oracles.py             # writes references/stability/*.csv
    python scripts/make_oracles.py --check     # compares them with what is committed
"""

import argparse
import hashlib
import random
import sys
from pathlib import Path

import mpmath
import numpy as np
from mpmath import mp, mpf

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "references" / "stability"
DIGITS = 50
# Twice as many digits as are written, for differences of numbers that agree in up to 50.
mp.dps = 2 * DIGITS


def single(x):
    """The nearest single-precision number, as a float."""
    return float(np.float32(x))


def steps(x, n):
    """The single-precision number n steps above x."""
    x = np.float32(x)
    for _ in range(abs(n)):
        x = np.nextafter(x, np.float32(np.inf if n > 0 else -np.inf))
    return float(x)


def log_uniform(rng, low, high):
    """A number whose logarithm is uniform between those of low and high."""
    return float(10.0 ** rng.uniform(np.log10(low), np.log10(high)))


def direction(rng):
    """A unit vector with single-precision components."""
    v = np.array([rng.gauss(0, 1) for _ in range(3)])
    return [single(c) for c in v / np.linalg.norm(v)]


def dot(a, b):
    return sum((x * y for x, y in zip(a, b)), mpf(0))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def length(a):
    return mp.sqrt(dot(a, a))


def one_minus_cos(rng):
    """1 - cos of an angle from its squared sine."""
    inputs = [single(mp.sin(log_uniform(rng, 1e-19, np.pi / 2)) ** 2) for _ in range(300)]
    inputs += [0.0, 1.0, steps(1.0, -1), steps(1.0, -2), steps(0.0, 1), steps(0.0, 1000), 0.5, 2.0 ** -24, 2.0 ** -126]
    for s in inputs:
        yield [s], [mpf(s) / (1 + mp.sqrt(1 - mpf(s)))]


def difference_of_products(rng):
    """a b - c d where the products agree in up to all their digits."""
    for _ in range(400):
        a, b = single(log_uniform(rng, 1e-3, 1e3)), single(-log_uniform(rng, 1e-3, 1e3))
        c = single(a * (1 + rng.choice([0.0, 1.0, -1.0]) * log_uniform(rng, 1e-8, 1)))
        d = steps(single(mpf(a) * b / c), rng.randrange(-3, 4))
        yield [a, b, c, d], [mpf(a) * b - mpf(c) * d]


def cone(rng):
    """A direction in a cone: sine of the polar angle, and 1 - cos."""
    for _ in range(300):
        u = rng.choice([single(rng.random()), 1 - 2.0 ** -24, 2.0 ** -24, 0.0])
        h = single(rng.choice([log_uniform(rng, 1e-13, 2), 2.0, 1.0]))
        up = mpf(u) * h
        yield [u, h], [mp.sqrt(up * (2 - up)), 1 - up]


def phong(rng):
    """A direction of Phong's lobe: sine and cosine of the polar angle."""
    for _ in range(300):
        u = rng.choice([single(rng.random()), 1 - 2.0 ** -24, 2.0 ** -24, single(1 - log_uniform(rng, 1e-7, 1))])
        e = single(rng.choice([log_uniform(rng, 1e-3, 1e8), 0.0, 1.0]))
        log = mp.log(1 - mpf(u)) / (mpf(e) + 1)
        yield [u, e], [mp.sqrt(-mp.expm1(2 * log)), mp.exp(log)]


def phong_pdf(rng):
    """Density of Phong's lobe at (x, 0, z), from x near the axis and from z near the horizon."""
    for _ in range(300):
        e = single(log_uniform(rng, 1e-2, 1e8))
        sin = min(0.999999, rng.choice([log_uniform(rng, 1e-6, 1), abs(rng.gauss(0, 1)) / np.sqrt(e + 1)]))
        x, z = single(sin), single(np.sqrt((1 - sin) * (1 + sin)))
        log = mp.log(1 - mpf(x) ** 2) / 2 if x * x < 0.5 else mp.log(mpf(z))
        yield [x, z, e], [(mpf(e) + 1) / (2 * mp.pi) * mp.exp(mpf(e) * log)]


def fresnel(c, eta):
    """Reflectance, transmittance and cosine of the refracted angle."""
    c, eta = mpf(c), mpf(eta)
    far = 1 / eta if c < 0 else eta
    c = abs(c)
    q2 = c * c + far * far - 1
    if q2 <= 0 or c == 0:
        return [mpf(1), mpf(0), mpf(0)]
    q, ec = mp.sqrt(q2), far * far * c
    r = (((c - q) / (c + q)) ** 2 + ((ec - q) / (ec + q)) ** 2) / 2
    t = (4 * c * q / (c + q) ** 2 + 4 * ec * q / (ec + q) ** 2) / 2
    return [r, t, q / far]


def dielectric(rng):
    """Fresnel's equations: everywhere, at the critical angle, at indices next to 1, at grazing."""
    cases = []
    for _ in range(100):
        cases.append((single(rng.uniform(-1, 1)), single(log_uniform(rng, 1e-3, 1e3))))
        eta = single(log_uniform(rng, 1.0001, 10))
        critical = single(-mp.sqrt(1 - 1 / mpf(eta) ** 2))
        cases.append((steps(critical, rng.randrange(-3, 4)), eta))
        near = rng.choice([1.0, steps(1, 1), steps(1, -1), single(1 + 1e-7), single(1 - 1e-7), single(1 + rng.gauss(0, 1e-5))])
        cases.append((single(rng.choice([-1, 1]) * log_uniform(rng, 1e-6, 1)), near))
        cases.append((single(rng.choice([-1, 1]) * log_uniform(rng, 1e-30, 1e-2)), single(rng.choice([1.33, 1.5, 2.4, 0.7]))))
    for c, eta in cases:
        yield [c, eta], fresnel(c, eta)


def conductor(rng):
    """Reflectance of a conductor, by complex arithmetic."""
    for _ in range(400):
        c = single(rng.choice([rng.random(), log_uniform(rng, 1e-20, 1), 1.0, 0.0, steps(1.0, -1)]))
        eta = single(rng.choice([log_uniform(rng, 1e-3, 50), 0.0, 1.0, single(1 + rng.gauss(0, 1e-4))]))
        k = single(rng.choice([log_uniform(rng, 1e-6, 50), 0.0]))
        m2 = mp.mpc(eta, k) ** 2
        q, z = mp.sqrt(m2 - (1 - mpf(c) ** 2)), mpf(c)

        def share(a):
            return mpf(1) if a + q == 0 else abs((a - q) / (a + q)) ** 2

        yield [c, eta, k], [(share(z) + share(m2 * z)) / 2]


def ggx(rng):
    """GGX: D(m) and G1(w) for directions by x, y and z, at the pole, at a step off it, and grazing."""
    for _ in range(400):
        ax, ay = single(log_uniform(rng, 1e-5, 1)), single(log_uniform(rng, 1e-5, 1))
        theta = rng.choice([abs(rng.gauss(0, 1)) * ax, rng.uniform(0, np.pi / 2), np.pi / 2 - log_uniform(rng, 1e-8, 1), 0.0])
        phi = rng.uniform(0, 2 * np.pi)
        m = [single(np.sin(theta) * np.cos(phi)), single(np.sin(theta) * np.sin(phi)), max(single(np.cos(theta)), 2.0 ** -60)]
        x, y, z = (mpf(v) for v in m)
        r = (x / mpf(ax)) ** 2 + (y / mpf(ay)) ** 2 + z * z
        stretched = mp.sqrt((x * mpf(ax)) ** 2 + (y * mpf(ay)) ** 2 + z * z)
        yield [*m, ax, ay], [1 / (mp.pi * mpf(ax) * mpf(ay) * r * r), 2 * z / (z + stretched)]


def sphere(rng):
    """First distance of a sphere of radius 1, from 1 to 1e8 radii away and from inside; -1 for a miss."""
    for k in range(400):
        o, d = [single(rng.gauss(0, 1)) for _ in range(3)], direction(rng)
        far = rng.choice([log_uniform(rng, 1, 1e8), rng.uniform(-1, 1) * 0.99])
        side = cross(d, direction(rng))
        off = rng.choice([rng.uniform(0, 0.99), 1 - log_uniform(rng, 1e-4, 1), 1 + log_uniform(rng, 1e-4, 1)])
        off *= np.sqrt(1 - far * far) if abs(far) < 1 else 1
        norm = float(length(side))
        c = [float(a + far * b + off * s / norm) for a, b, s in zip(o, d, side)]
        f = minus([mpf(v) for v in c], [mpf(v) for v in o])
        dd, b = dot(d, [mpf(v) for v in d]), dot(f, d)
        disc = b * b - dd * (dot(f, f) - 1)
        roots = [] if disc < 0 else [(b - mp.sqrt(disc)) / dd, (b + mp.sqrt(disc)) / dd]
        yield [*o, *d, *c], [next((t for t in roots if t > 0), mpf(-1))]


def triangle(rng):
    """Distance and weights where a ray meets a triangle: needles to an aspect of 1e7, seen edge-on to 1e-4 rad."""
    for _ in range(400):
        aspect = log_uniform(rng, 1, 1e7)
        a = [rng.uniform(-1, 1) for _ in range(3)]
        along, other = direction(rng), direction(rng)
        across = [float(v) for v in cross(along, other)]
        norm = np.linalg.norm(across)
        p = [[single(v) for v in a], [single(v + e) for v, e in zip(a, along)],
             [single(v + 0.4 * e + w / norm / aspect) for v, e, w in zip(a, along, across)]]
        exact = [[mpf(v) for v in q] for q in p]
        e1, e2 = minus(exact[1], exact[0]), minus(exact[2], exact[0])
        n = cross(e1, e2)
        if length(n) == 0:
            continue
        b1, b2 = sorted(rng.random() for _ in range(2))
        target = [float(q0 + b1 * x + (b2 - b1) * y) for q0, x, y in zip(exact[0], e1, e2)]
        unit = np.array([float(v / length(n)) for v in n])
        tilt = log_uniform(rng, 1e-4, 1)
        d = tilt * unit + np.sqrt(1 - tilt * tilt) * np.array(along)
        d = [single(v) for v in d / np.linalg.norm(d)]
        o = [single(t - rng.uniform(0.5, 2) * v) for t, v in zip(target, d)]
        slope = dot(n, d)
        if slope == 0:
            continue
        t = dot(n, minus(exact[0], o)) / slope
        hit = [mpf(x) + t * mpf(y) for x, y in zip(o, d)]
        nn = dot(n, n)
        w1 = dot(cross(minus(hit, exact[0]), e2), n) / nn
        w2 = dot(cross(e1, minus(hit, exact[0])), n) / nn
        # Rounding of the ray may carry it past a needle; only what is well inside or outside is unambiguous.
        margin = min(w1, w2, 1 - w1 - w2)
        if abs(margin) < 0.05 or t <= 0:
            continue
        inside = margin > 0
        yield [*o, *d, *p[0], *p[1], *p[2]], [t, w1, w2] if inside else [mpf(-1)] * 3


def power_heuristic(rng):
    """Weights of two densities that may be as small or large as single precision holds."""
    for _ in range(300):
        a, b = single(log_uniform(rng, 1e-44, 3e38)), single(log_uniform(rng, 1e-44, 3e38))
        if rng.random() < 0.5:
            b = single(min(a * log_uniform(rng, 1e-4, 1e4), 3e38)) or a
        yield [a, b], [mpf(a) ** 2 / (mpf(a) ** 2 + mpf(b) ** 2)]


def half_vector(rng):
    """|a + b|/2 for two directions, down to opposite ones that graze the surface."""
    for _ in range(300):
        a, b = direction(rng), direction(rng)
        if rng.random() < 0.7:
            up = log_uniform(rng, 1e-30, 1e-3)
            phi = rng.uniform(0, 2 * np.pi)
            a = [single(np.cos(phi)), single(np.sin(phi)), single(up)]
            b = [-a[0], -a[1], single(up * rng.random())]
        s = [mpf(x) + mpf(y) for x, y in zip(a, b)]
        yield [*a, *b], [length(s) / 2, s[2] / length(s)]


def blur_disk(rng):
    """Density of the blur disk about a mirror's direction: 1/(pi f^2 cos^3), 0 beyond its rim or below."""
    for _ in range(400):
        f = single(log_uniform(rng, 1e-4, 100))
        up = rng.choice([rng.uniform(0.01, 1), log_uniform(rng, 1e-6, 1)])
        phi = rng.uniform(0, 2 * np.pi)
        side = np.sqrt(1 - up * up)
        wo = [single(side * np.cos(phi)), single(side * np.sin(phi)), single(up)]
        r = np.array([-wo[0], -wo[1], wo[2]])
        t1 = np.cross(r, direction(rng))
        off = f * rng.choice([rng.uniform(0, 0.999), rng.uniform(1.001, 2)])
        wi = r + off * t1 / np.linalg.norm(t1)
        wi = [single(v) for v in wi / np.linalg.norm(wi)]
        mirror, w = [-mpf(wo[0]), -mpf(wo[1]), mpf(wo[2])], [mpf(v) for v in wi]
        cos = dot(mirror, w)
        tan2 = dot(cross(mirror, w), cross(mirror, w)) / (cos * cos)
        inside = cos > 0 and wi[2] > 0 and tan2 <= mpf(f) ** 2
        value = (1 + tan2) ** mpf(1.5) / (mp.pi * mpf(f) ** 2) if inside else mpf(0)
        yield [*wo, *wi, f], [value]


def rotation(rng):
    """Where x goes at share s of a turn about z, in double precision: by an angle near 0, near pi, or between."""
    for _ in range(300):
        angle = rng.choice([log_uniform(rng, 1e-17, 1), np.pi - log_uniform(rng, 1e-12, 1), rng.uniform(0, 3.1)])
        s = rng.choice([rng.random(), 0.5, 2.0 ** -20, 1 - 2.0 ** -20])
        turned = mpf(s) * mpf(angle)
        yield [angle, s], [mp.cos(turned), mp.sin(turned)]


def discrete(rng):
    """Share of one weight among eight, each between 1e-30 and 1e30 or 0, in double precision."""
    for _ in range(200):
        weights = [rng.choice([0.0, log_uniform(rng, 1e-30, 1e30), log_uniform(rng, 0.1, 10)]) for _ in range(8)]
        if rng.random() < 0.3:
            keep = rng.randrange(8)
            weights = [w if k == keep else 0.0 for k, w in enumerate(weights)]
        total = sum((mpf(w) for w in weights), mpf(0))
        if total == 0:
            continue
        index = rng.randrange(8)
        yield [*weights, float(index)], [mpf(weights[index]) / total]


def unit_vertices(rng, size):
    """Three single-precision points at distance about 1, about as far apart as size, seen from the origin."""
    c = np.array(direction(rng))
    return [[single(v) for v in c + size * np.array(direction(rng))] for _ in range(3)]


def triangle_solid_angle(rng):
    """Solid angle of a triangle seen from the origin (van Oosterom, Strackee), from 1e-12 sr to nearly 2 pi."""
    for _ in range(300):
        size = rng.choice([log_uniform(rng, 1e-6, 1), rng.uniform(1, 1e3)])
        p = unit_vertices(rng, size)
        a, b, c = ([mpf(v) for v in q] for q in p)
        la, lb, lc = length(a), length(b), length(c)
        volume = abs(dot(a, cross(b, c)))
        below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
        if volume == 0:
            continue
        yield [*p[0], *p[1], *p[2]], [2 * mp.atan2(volume, below)]


def rectangle_solid_angle(rng):
    """Solid angle of the rectangle [x0, x1] x [y0, y1] at height z, in double precision."""
    def corner(x, y, z):
        return mp.atan2(x * y, z * mp.sqrt(x * x + y * y + z * z))

    for _ in range(300):
        z = log_uniform(rng, 1e-8, 1e6)
        x0, y0 = rng.uniform(-2, 2), rng.uniform(-2, 2)
        x1, y1 = x0 + log_uniform(rng, 1e-6, 10), y0 + log_uniform(rng, 1e-6, 10)
        e = [mpf(v) for v in (x0, y0, x1, y1, z)]
        value = corner(e[2], e[3], e[4]) - corner(e[0], e[3], e[4]) - corner(e[2], e[1], e[4]) + corner(e[0], e[1], e[4])
        yield [x0, y0, x1, y1, z], [value]


def beckmann(rng):
    """Beckmann: D(m) and G1(w) for directions by x, y and z, at the pole, a step off it, and grazing."""
    for _ in range(300):
        ax, ay = single(log_uniform(rng, 1e-5, 1)), single(log_uniform(rng, 1e-5, 1))
        theta = rng.choice([abs(rng.gauss(0, 1)) * ax, rng.uniform(0, np.pi / 2), np.pi / 2 - log_uniform(rng, 1e-8, 1), 0.0])
        phi = rng.uniform(0, 2 * np.pi)
        m = [single(np.sin(theta) * np.cos(phi)), single(np.sin(theta) * np.sin(phi)), max(single(np.cos(theta)), 2.0 ** -60)]
        x, y, z = (mpf(v) for v in m)
        t = ((x / mpf(ax)) ** 2 + (y / mpf(ay)) ** 2) / (z * z)
        across = mp.sqrt((x * mpf(ax)) ** 2 + (y * mpf(ay)) ** 2)
        d = mp.exp(-t) / (mp.pi * mpf(ax) * mpf(ay) * z ** 4)
        g1 = 2 * z / (z * (1 + mp.erf(z / across)) + across * mp.exp(-((z / across) ** 2)) / mp.sqrt(mp.pi)) if across else mpf(1)
        yield [*m, ax, ay], [d if d > mpf(10) ** -300 else mpf(0), g1]


def ground_glass(rng):
    """What GGX windows refract, f and pdf, near the critical angle and elsewhere; Fresnel's share from both cosines."""
    for k in range(300):
        eta, alpha = single(log_uniform(rng, 1.01, 4)), single(log_uniform(rng, 1e-3, 1))
        cos, tilt, phi = log_uniform(rng, 1e-3, 1), min(alpha * log_uniform(rng, 1e-2, 2), 1.4), rng.uniform(0, 2 * np.pi)
        h = np.array([np.sin(tilt) * np.cos(phi), np.sin(tilt) * np.sin(phi), np.cos(tilt)])
        t = np.cross(h, direction(rng))
        t *= np.copysign(1, t[2]) / np.linalg.norm(t)
        sin = np.sqrt((1 - cos) * (1 + cos))
        a, b = cos * h + sin * t, -np.sqrt(1 - (sin / eta) ** 2) * h - sin / eta * t
        a, b = [single(v) for v in a], [single(v) for v in b]
        if not (a[2] > 0 > b[2]):
            continue
        total = [mpf(x) + mpf(eta) * mpf(y) for x, y in zip(a, b)]
        size = length(total)
        n = [v / size * mp.sign(total[2]) for v in total]
        ca, cb, e, w = dot(n, [mpf(v) for v in a]), -dot(n, [mpf(v) for v in b]), mpf(eta), mpf(alpha)
        passed = (4 * ca * e * cb / (ca + e * cb) ** 2 + 4 * e * ca * cb / (e * ca + cb) ** 2) / 2
        d = 1 / (mp.pi * w * w * ((n[0] ** 2 + n[1] ** 2) / (w * w) + n[2] ** 2) ** 2)

        def shadowing(v):
            x, y, z = (abs(mpf(c)) for c in v)
            return 2 / (z + mp.sqrt((x * w) ** 2 + (y * w) ** 2 + z * z))

        both = passed * d * ca * cb / size ** 2
        value = both * shadowing(a) * shadowing(b)
        if k % 2:
            yield [*a, *b, alpha, eta], [value, both * shadowing(a) * e * e]
        else:
            yield [*b, *a, alpha, eta], [value * e * e, both * shadowing(b)]


def sphere_solid_angle(rng):
    """Solid angle of a sphere of radius 1 from a distance of 1 + 1e-9 to 1e6, in double precision."""
    for _ in range(200):
        distance = 1 + log_uniform(rng, 1e-9, 1e6)
        s2 = 1 / mpf(distance) ** 2
        yield [distance], [2 * mp.pi * s2 / (1 + mp.sqrt(1 - s2))]


# Name, columns of inputs, columns of values, function.
TABLES = [
    ("one_minus_cos", "sin2", "value", one_minus_cos),
    ("difference_of_products", "a b c d", "value", difference_of_products),
    ("cone", "u one_minus_cos_max", "sin cos", cone),
    ("phong", "u exponent", "sin cos", phong),
    ("phong_pdf", "x z exponent", "pdf", phong_pdf),
    ("dielectric", "cos_i eta", "reflectance transmittance cos_t", dielectric),
    ("conductor", "cos_i eta k", "reflectance", conductor),
    ("ggx", "x y z alpha_x alpha_y", "d g1", ggx),
    ("sphere", "ox oy oz dx dy dz cx cy cz", "t", sphere),
    ("triangle", "ox oy oz dx dy dz ax ay az bx by bz cx cy cz", "t b1 b2", triangle),
    ("power_heuristic", "a b", "weight", power_heuristic),
    ("half_vector", "ax ay az bx by bz", "cos z", half_vector),
    ("blur_disk", "ox oy oz ix iy iz blur", "pdf", blur_disk),
    ("rotation", "angle s", "x y", rotation),
    ("discrete", "w0 w1 w2 w3 w4 w5 w6 w7 index", "pmf", discrete),
    ("triangle_solid_angle", "ax ay az bx by bz cx cy cz", "sr", triangle_solid_angle),
    ("beckmann", "x y z alpha_x alpha_y", "d g1", beckmann),
    ("ground_glass", "ox oy oz ix iy iz alpha eta", "f pdf", ground_glass),
    ("sphere_solid_angle", "distance", "sr", sphere_solid_angle),
    ("rectangle_solid_angle", "x0 y0 x1 y1 z", "sr", rectangle_solid_angle),
]


def source_hash():
    """SHA-256 of this file: who changes it writes the tables again."""
    return hashlib.sha256(Path(__file__).read_bytes()).hexdigest()


def digits(value):
    """A value to 50 digits; 0 and small integers as they are."""
    return mpmath.nstr(value, DIGITS, strip_zeros=True, min_fixed=0, max_fixed=0) if value else "0"


def files():
    """Every file's name and text."""
    texts = {}
    for name, inputs, values, rows in TABLES:
        names = [*inputs.split(), *values.split()]
        about = " ".join(rows.__doc__.split())
        lines = [f"# {about} {DIGITS} digits by mpmath {mpmath.__version__}; scripts/make_oracles.py, SHA-256 {source_hash()}",
                 ",".join(names)]
        for row, exact in rows(random.Random(name)):
            cells = [*(repr(v) for v in row), *(digits(v) for v in exact)]
            assert len(cells) == len(names), f"{name}: {len(cells)} cells for {len(names)} columns"
            lines.append(",".join(cells))
        texts[f"{name}.csv"] = "\n".join(lines) + "\n"
    return texts


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing; status 1 if a file differs")
    options = parser.parse_args(arguments)
    OUT.mkdir(exist_ok=True)
    differs = [name for name, text in files().items() if not (OUT / name).exists() or (OUT / name).read_text() != text]
    for name in differs if options.check else []:
        print(f"references/stability/{name} differs from what mpmath {mpmath.__version__} gives")
    if not options.check:
        for name, text in files().items():
            (OUT / name).write_text(text)
    return 1 if options.check and differs else 0


if __name__ == "__main__":
    sys.exit(main())
