"""make.py DATA OUT - writes the head of the page's avatar from DATA/free/makehuman.

It is MakeHuman's mean adult with fewer vertices, and a shape for each of ARKit's names that has
one. Only MakeHuman's mesh and targets go into it (CC0 1.0); colours are the page's. What an angle
of 0 is comes from DATA/facekit.npz, as for the tracker. Needs numpy.

The file, little-endian, which head.js reads:

    8 u16   vertices; triangles of skin, sockets, mouth, teeth; shapes; 0, 0
    8 f32   right and left eyeball: centre, radius [mm]
    3 i16   of each vertex: place [1/100 mm]; x to the person's left, y down, z backwards
    4 i8    of each vertex: inside lips, brows, hair [1/8 mm]; light from around, 0..127
    3 u16   corners of each triangle, counter-clockwise as seen from outside
    shapes  f32 mm of a step, u16 vertices moved; their numbers; 3 i8 of each
"""

import heapq
import json
import re
import sys
from pathlib import Path

import numpy as np

PARTS = (("skin",), ("eye_socket",), ("mouth_inside", "tongue"), ("teeth",))
VERTICES = 2700
# What moves no more than this stays [mm].
STILL_MM = 0.15
# Below the eyes by so much, shoulders are cut off [mm].
CHEST_MM = 150.0
NECK_MM = 75.0

# MakeHuman's facial units under the names nearest to them, with factors. Units without a side are
# split at the middle line where the name has a side.
UNITS = {
    "browDown": {"eyebrows-SIDE-down": 1.0},
    "browInnerUp": {
        "eyebrows-left-inner-up": 1.0, "eyebrows-right-inner-up": 1.0,
        "eyebrows-left-up": 0.3, "eyebrows-right-up": 0.3,
    },
    "browOuterUp": {"eyebrows-SIDE-extern-up": 0.7, "eyebrows-SIDE-up": 0.5},
    "eyeBlink": {"eye-SIDE-closure": 0.84},
    "eyeSquint": {"eye-SIDE-slit": 0.35},
    "eyeWide": {"eye-SIDE-opened-up": 1.0},
    "eyeLookDown": {"eye-SIDE-closure": 0.44},
    "eyeLookUp": {"eye-SIDE-opened-up": 0.7},
    "jawOpen": {"mouth-open": 0.85},
    "mouthFrown": {"mouth-depression": 0.7},
    "mouthFunnel": {"mouth-protusion": 0.84},
    "mouthLowerDown": {"mouth-depression-retraction": 0.5},
    "mouthPress": {"mouth-compression": 1.0},
    "mouthPucker": {"mouth-pursing": 0.94},
    "mouthShrugLower": {"mouth-eversion": 1.0},
    "mouthSmile": {"mouth-corner-puller": 1.0, "mouth-upward-retraction": 0.25},
    "mouthStretch": {"mouth-retraction": 1.0},
    "mouthUpperUp": {"mouth-elevation": 1.0, "mouth-parling": 0.4},
    "noseSneer": {"nose-SIDE-elevation": 1.0, "nose-SIDE-dilatation": 0.5},
}
# Half the width in which a unit without a side is split [mm].
SPLIT_MM = 10.0

# The hairline: at a depth in the head, up to which height hair is [mm].
HAIRLINE = ((-60, -74), (0, -66), (25, -48), (45, -30), (60, -4), (72, 14), (100, 30), (140, 66))
# How far hair stands off, and how far within the hairline it does so [mm].
HAIR_MM = 7.0
ROOTS_MM = 14.0
# What larger ears move by more than this is an ear; around its middle no hair grows [mm].
EAR_MM = 2.5
BARE_MM = 36.0
# How high rows of teeth are, how far behind MakeHuman's, and how many parts they have.
TEETH_MM = (9.0, 1.5)
TEETH = 12
# Least light from around: lips and mouth open, and what is inside then is seen.
LEAST_LIGHT = (0.25, 0.3, 0.35, 0.7)
# Half the width of a brow at its outer and inner end [mm].
BROW_MM = (1.8, 4.0)
# How much higher brows are painted than MakeHuman's, from the outer end to the inner one [mm]: the
# inner ends of those lie 7 mm below the arch, in the tracker's mean head 3 mm, so that it frowned.
BROW_UP_MM = (0.0, 0.0, 0.4, 1.6, 3.4)


def smoothstep(low, high, value):
    share = np.clip((value - low) / (high - low), 0, 1)
    return share * share * (3 - 2 * share)


def to_lines(points, line):
    """Distance of points to a line of points, and how far along it the nearest place is, 0..1."""
    far, along = np.full(len(points), np.inf), np.zeros(len(points))
    for nth, (a, b) in enumerate(zip(line[:-1], line[1:])):
        share = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        here = np.linalg.norm(points - a - share[:, None] * (b - a), axis=1)
        nearer = here < far
        far[nearer] = here[nearer]
        along[nearer] = (nth + share[nearer]) / (len(line) - 1)
    return far, along


class Head:
    """MakeHuman's mean adult in the tracker's axes."""

    def __init__(self, data):
        folder = data / "free/makehuman"
        head, shapes = np.load(folder / "head.npz"), np.load(folder / "shapes.npz")
        marks = json.loads((folder / "landmarks.json").read_text())["points"]
        grown = [re.search("young$|old$", name) is not None for name in shapes["macro_names"]]
        mean = head["vertices"] + shapes["macro"][grown].astype(np.float32).mean(axis=0)
        eyes = [mean[head[f"eye_{side}_centre"]].mean(axis=0) for side in "rl"]
        mean -= (eyes[0] + eyes[1]) / 2
        landmarks = np.stack([
            np.asarray(mark["weights"]) @ mean[mark["vertices"]] for mark in marks
        ])
        turn = alignment(landmarks[17:], np.load(data / "facekit.npz"))
        self.turn = turn
        self.places = mean @ turn.T
        self.landmarks = landmarks @ turn.T
        self.units = {}
        for nth, name in enumerate(shapes["unit_names"]):
            column = slice(shapes["unit_ptr"][nth], shapes["unit_ptr"][nth + 1])
            moved = np.zeros_like(mean)
            moved[shapes["unit_index"][column]] = shapes["unit_value"][column]
            self.units[str(name)] = moved @ turn.T
        self.eyes = [self.places[head[f"eye_{side}_vertices"]] for side in "rl"]
        names = [str(name) for name in head["part_names"]]
        is_low = (self.places[:, 1] > CHEST_MM) | (
            (self.places[:, 1] > NECK_MM) & (np.abs(self.places[:, 0]) > 0.8 * NECK_MM))
        chest = is_low[head["triangles"]].all(axis=1)
        self.parts = [
            head["triangles"][np.isin(head["tri_part"], [names.index(n) for n in part]) & ~chest]
            for part in PARTS
        ]
        larger = [
            nth for nth, name in enumerate(shapes["detail_names"]) if "ear-scale|" in str(name)
        ]
        self.ear = np.zeros(len(mean), bool)
        for column in (2 * nth + 1 for nth in larger):
            of = slice(shapes["detail_ptr"][column], shapes["detail_ptr"][column + 1])
            far = np.linalg.norm(shapes["detail_value"][of].astype(np.float32), axis=1)
            self.ear[shapes["detail_index"][of][far > EAR_MM]] = True
        self.add_teeth()
        self.skin = np.zeros(len(self.places), bool)
        self.skin[self.parts[0].ravel()] = True
        self.soft = self.skin.copy()
        self.soft[self.parts[2].ravel()] = True
        self.normals = normals(self.places, np.concatenate(self.parts))
        self.brows = [self.brow(self.landmarks[of]) for of in (range(17, 22), range(26, 21, -1))]

    def brow(self, marks):
        """The line along which a brow is painted, on the skin, from its outer end."""
        line = marks - np.outer(BROW_UP_MM, (0, 1, 0))
        front = self.places[self.skin & (self.places[:, 2] < 30)]
        for point in line:
            near = np.linalg.norm((front - point)[:, :2], axis=1).argsort()[:3]
            point[2] = front[near, 2].mean()
        return line

    def add_teeth(self):
        """Puts a smooth row in place of each row of teeth: thinned ones would have gaps."""
        teeth = np.unique(self.parts[3])
        is_lower = np.linalg.norm(self.units["mouth-open"][teeth], axis=1) > 2
        high, behind = TEETH_MM
        rows, like = [], []
        for row, down in ((teeth[~is_lower], 1), (teeth[is_lower], -1)):
            x = self.places[row, 0]
            for middle in np.linspace(0.92 * x.min(), 0.92 * x.max(), TEETH + 1):
                near = row[np.abs(x - middle) < np.ptp(x) / TEETH]
                front = near[self.places[near, 2] < self.places[near, 2].min() + 4]
                edge = front[np.argmax(down * self.places[front, 1])]
                place = np.array([middle, self.places[edge, 1], self.places[front, 2].min()])
                rows += [place + (0, -down * high, behind), place + (0, 0, behind)]
                like += [edge, edge]
        first = len(self.places)
        self.places = np.concatenate([self.places, rows])
        self.units = {name: np.concatenate([of, of[like]]) for name, of in self.units.items()}
        self.ear = np.concatenate([self.ear, np.zeros(len(like), bool)])
        corners = []
        for row, down in ((first, 1), (first + 2 * TEETH + 2, -1)):
            for nth in range(TEETH):
                # The first of each pair is at the gums: above for the upper row.
                a, b, c, d = (row + 2 * nth + k for k in range(4))
                faces = [(a, b, c), (b, d, c)]
                corners += faces if down == 1 else [face[::-1] for face in faces]
        self.parts[3] = np.array(corners)


def alignment(inner, kit):
    """The turn about x, with a factor of the size, that brings landmarks nearest to the kit's."""
    other = kit["mean"][kit["lm68"][17:]] * np.array([10, -10, -10])
    a, b = inner - inner.mean(axis=0), other - other.mean(axis=0)
    along = (a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]).sum()
    across = (a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1]).sum()
    scale = ((a[:, 0] * b[:, 0]).sum() + np.hypot(along, across)) / (a * a).sum()
    angle = np.arctan2(across, along)
    cos, sin = np.cos(angle), np.sin(angle)
    return scale * np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])


def normals(places, triangles):
    a, b, c = (places[triangles[:, k]] for k in range(3))
    of = np.cross(b - a, c - a)
    sums = np.zeros_like(places)
    for k in range(3):
        np.add.at(sums, triangles[:, k], of)
    return sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-9)


def openness(head):
    """Share of the sky that each vertex sees, weighted by how it faces it."""
    rows, step, slack, directions = 13, 2.5, 6.0, 96
    p, q = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, rows))
    p, q = p[p + q <= 1], q[p + q <= 1]
    triangles = np.concatenate(head.parts)
    a, b, c = (head.places[triangles[:, k]][:, None] for k in range(3))
    points = (a + p[None, :, None] * (b - a) + q[None, :, None] * (c - a)).reshape(-1, 3)
    balls = np.concatenate(head.eyes)
    points = np.concatenate([points, balls])
    seen, facing = np.zeros(len(head.places)), np.zeros(len(head.places))
    for nth in range(directions):
        z = 1 - (2 * nth + 1) / directions
        angle = 2.399963 * nth
        to = np.array([np.sqrt(1 - z * z) * np.cos(angle), np.sqrt(1 - z * z) * np.sin(angle), z])
        x = np.cross(to, [0, 1, 0] if abs(to[1]) < 0.9 else [1, 0, 0])
        x /= np.linalg.norm(x)
        y = np.cross(to, x)
        cell = lambda of: ((of @ np.stack([x, y]).T) / step + 200).astype(int).clip(0, 399)
        most = np.full((400, 400), -np.inf)
        at = cell(points)
        np.maximum.at(most, (at[:, 0], at[:, 1]), points @ to)
        at = cell(head.places)
        reached = head.places @ to + slack >= most[at[:, 0], at[:, 1]]
        faces = np.maximum(head.normals @ to, 0)
        seen += faces * reached
        facing += faces
    return seen / np.maximum(facing, 1e-6)


def painted(head):
    """Places with hair, and how far inside of lips, brows and hair each vertex is [mm]."""
    places, marks = head.places, head.landmarks
    inside = np.full((len(places), 3), -15.0)
    loop = np.concatenate([marks[48:60], marks[48:49]])[:, :2]
    far, _ = to_lines(places[:, :2], loop)
    crossings = np.zeros(len(places), int)
    for a, b in zip(loop[:-1], loop[1:]):
        between = (a[1] > places[:, 1]) != (b[1] > places[:, 1])
        x = a[0] + (b[0] - a[0]) * (places[:, 1] - a[1]) / (b[1] - a[1] + 1e-9)
        crossings += between & (places[:, 0] < x)
    front = places[:, 2] < marks[[48, 54], 2].max() + 6
    inside[:, 0] = np.where(front, np.where(crossings % 2 == 1, far, -far), -15)
    for brow in head.brows:
        far, along = to_lines(places, brow)
        inside[:, 1] = np.maximum(inside[:, 1], np.interp(along, [0, 1], BROW_MM) - far)
    depths, heights = np.array(HAIRLINE).T
    hair = np.interp(places[:, 2], depths, heights) - places[:, 1]
    middle = places[head.ear & (places[:, 0] > 0)].mean(axis=0)
    bare = np.linalg.norm((places - middle)[:, 1:] * (0.9, 1.2), axis=1) - BARE_MM
    is_side = np.abs(places[:, 0]) > 0.7 * middle[0]
    inside[:, 2] = np.where(is_side, np.minimum(hair, bare), hair)
    inside[~head.skin] = -15
    off = HAIR_MM * smoothstep(0, ROOTS_MM, inside[:, 2])
    return places + off[:, None] * head.normals, inside.clip(-15, 15)


def moves(head, name):
    """What a shape moves at 1 [mm]. There is no tongueOut, and looks to the side move no lids."""
    places, marks = head.places, head.landmarks
    side = next((side for side in ("Left", "Right") if name.endswith(side)), "")
    whole = name in UNITS or name in ("mouthLeft", "mouthRight", "jawLeft", "jawRight")
    units = UNITS.get(name if whole else name.removesuffix(side))
    if units is not None:
        moved = np.zeros_like(places)
        for unit, factor in units.items():
            of = factor * head.units[unit.replace("SIDE", side.lower())]
            if side and "SIDE" not in unit:
                x = places[:, 0] if side == "Left" else -places[:, 0]
                of = of * smoothstep(-SPLIT_MM, SPLIT_MM, x)[:, None]
            moved += of
        return moved
    # The person's right is at -x.
    sign, corner = (-1, marks[48]) if side == "Right" else (1, marks[54])
    lower, upper = marks[[48, 67, 66, 65, 54]], marks[[48, 61, 62, 63, 54]]
    soft = head.soft[:, None]
    opened = head.units["mouth-open"]
    jaw = np.linalg.norm(opened, axis=1, keepdims=True)
    jaw = np.minimum(1.5 * jaw / jaw.max(), 1)

    def around(at, radius, by):
        far = np.linalg.norm(places - at, axis=1) / radius
        return soft * np.exp(-far * far)[:, None] * np.array(by, float)

    def along(line, radius, by):
        far = to_lines(places, line)[0] / radius
        return soft * np.exp(-far * far)[:, None] * np.array(by, float)

    mouth = (marks[62] + marks[66]) / 2
    cheek = {"Left": (marks[46] + marks[13]) / 2, "Right": (marks[41] + marks[3]) / 2}
    if name == "cheekPuff":
        sums = [np.linalg.norm(places - (marks[a] + marks[b]) / 2, axis=1) / 26
                for a, b in ((48, 3), (54, 13))]
        return soft * 11 * head.normals * sum(np.exp(-far * far) for far in sums)[:, None]
    if name == "mouthClose":
        # The whole of the lower lip comes up, and what is below it follows.
        far = np.maximum(to_lines(places, lower)[0] - 10, 0) / 12
        return -UNITS["jawOpen"]["mouth-open"] * opened * soft * np.exp(-far * far)[:, None]
    if name.startswith("cheekSquint"):
        return around(cheek[side], 20, (sign, -5, -2))
    if name.startswith("mouthDimple"):
        return around(corner, 13, (3 * sign, -0.5, 4))
    of = {
        "jawForward": lambda: jaw * np.array([0, 0, -7.0]),
        "jawLeft": lambda: jaw * np.array([8.0, 0, 0]),
        "jawRight": lambda: jaw * np.array([-8.0, 0, 0]),
        "mouthLeft": lambda: around(mouth, 30, (10, 0, 1)),
        "mouthRight": lambda: around(mouth, 30, (-10, 0, 1)),
        "mouthRollLower": lambda: along(lower[1:4], 8, (0, -3, 5)),
        "mouthRollUpper": lambda: along(upper[1:4], 7, (0, 2.5, 4.5)),
        "mouthShrugUpper": lambda: along(upper[1:4], 8, (0, -3, -2.5)),
    }
    return of[name]() if name in of else np.zeros_like(places)


def lengths(head):
    """How long edges are to be at each vertex [mm]: short where a face moves."""
    wanted = [(11, 0.3)] * 17 + [(2.6, 0.25)] * 10 + [(7, 0.3)] * 4 + [(4.5, 0.3)] * 5
    wanted += [(0.8, 0.15)] * 12 + [(2.5, 0.25)] * 20
    length = np.full(len(head.places), 22.0)
    marks = head.landmarks.copy()
    marks[17:22], marks[26:21:-1] = head.brows
    for (least, slope), mark in zip(wanted, marks):
        far = np.linalg.norm(head.places - mark, axis=1)
        length = np.minimum(length, least + slope * far)
    return np.where(head.ear, np.minimum(length, 7), length)


class Thinning:
    """Takes vertices from a surface, one by one, where it needs them least. A vertex on a seam of
    materials or on an edge goes along it."""

    def __init__(self, head):
        self.points = [tuple(p) for p in head.places.tolist()]
        self.length = lengths(head).tolist()
        # The rows of teeth are thin as they are.
        self.fixed = set(head.parts[3].ravel().tolist())
        self.triangles, self.part = {}, {}
        self.at = [set() for _ in self.points]
        for part, triangles in enumerate(head.parts):
            for corners in triangles.tolist():
                number = len(self.triangles)
                self.triangles[number], self.part[number] = tuple(corners), part
                for corner in corners:
                    self.at[corner].add(number)
        sides = {}
        for number, (a, b, c) in self.triangles.items():
            for edge in ((a, b), (b, c), (c, a)):
                sides.setdefault(frozenset(edge), []).append(self.part[number])
        self.seams = {}
        for edge, parts in sides.items():
            if len(parts) != 2 or parts[0] != parts[1]:
                a, b = edge
                self.seams.setdefault(a, set()).add(b)
                self.seams.setdefault(b, set()).add(a)

    def neighbours(self, vertex):
        return {c for t in self.at[vertex] for c in self.triangles[t]} - {vertex}

    def normal(self, corners):
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (self.points[c] for c in corners)
        p, q = (bx - ax, by - ay, bz - az), (cx - ax, cy - ay, cz - az)
        return (p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0])

    def cost(self, vertex, onto):
        """How bad it is to move a vertex onto a neighbour; None where it must not."""
        near, others = self.neighbours(vertex), self.neighbours(onto)
        between = [t for t in self.at[vertex] if onto in self.triangles[t]]
        if len(near & others) != len(between) or len(self.at[onto]) <= len(between):
            return None
        start, end = self.points[vertex], self.points[onto]
        way = [e - s for s, e in zip(start, end)]
        longest, moved = 0.0, 0.0
        for number in self.at[vertex]:
            corners = self.triangles[number]
            before = self.normal(corners)
            size = sum(n * n for n in before) ** 0.5 or 1e-9
            moved = max(moved, abs(sum(n * w for n, w in zip(before, way))) / size)
            if onto in corners:
                continue
            corners = tuple(onto if c == vertex else c for c in corners)
            after = self.normal(corners)
            area = sum(n * n for n in after) ** 0.5
            a, b, c = (self.points[k] for k in corners)
            side = max(sum((p - q) ** 2 for p, q in zip(u, v)) for u, v in ((a, b), (b, c), (c, a)))
            turned = sum(m * n for m, n in zip(before, after)) / (size * area or 1e-9)
            if area < 0.1 * side or turned < 0.3:
                return None
            for corner in corners:
                if corner != onto:
                    far = sum((p - q) ** 2 for p, q in zip(self.points[corner], end)) ** 0.5
                    length = min(self.length[corner], self.length[onto])
                    longest = max(longest, far / length)
        apart = sum(w * w for w in way) ** 0.5 / self.length[vertex]
        crowd = 0.15 * max(0, len(near | others) - 2 - 7)
        return max(longest, apart) + moved / 2.0 + crowd

    def best(self, vertex):
        if vertex in self.fixed:
            return None
        ends = self.seams.get(vertex, ())
        places = ends if len(ends) == 2 else () if ends else self.neighbours(vertex)
        costs = ((self.cost(vertex, onto), onto) for onto in sorted(places))
        return min((found for found in costs if found[0] is not None), default=None)

    def collapse(self, vertex, onto):
        ends = self.seams.pop(vertex, None)
        if ends:
            (other,) = ends - {onto}
            self.seams[onto] = self.seams[onto] - {vertex} | {other}
            self.seams[other] = self.seams[other] - {vertex} | {onto}
        for number in list(self.at[vertex]):
            corners = self.triangles[number]
            if onto in corners:
                del self.triangles[number]
                for corner in corners:
                    self.at[corner].discard(number)
            else:
                self.triangles[number] = tuple(onto if c == vertex else c for c in corners)
                self.at[onto].add(number)
        self.at[vertex] = set()

    def thin(self, count):
        left = [v for v, at in enumerate(self.at) if at]
        when = dict.fromkeys(left, 0)
        heap = [(found[0], v, 0) for v in left if (found := self.best(v))]
        heapq.heapify(heap)
        gone = len(left) - count
        while gone > 0 and heap:
            _, vertex, seen = heapq.heappop(heap)
            if seen != when[vertex] or not self.at[vertex]:
                continue
            found = self.best(vertex)
            if found is None:
                continue
            touched = self.neighbours(vertex)
            self.collapse(vertex, found[1])
            gone -= 1
            for near in touched | self.neighbours(found[1]):
                when[near] += 1
                if better := self.best(near):
                    heapq.heappush(heap, (better[0], near, when[near]))
        return [
            [corners for number, corners in self.triangles.items() if self.part[number] == part]
            for part in range(len(PARTS))
        ]


def main():
    data, out = map(Path, sys.argv[1:])
    names = Path(__file__).with_name("retargeting.js").read_text()
    names = re.search(r"AVATAR_SHAPES = \[(.*?)\]", names, re.S).group(1)
    names = re.findall(r"'(\w+)'", names)
    head = Head(data)
    parts = Thinning(head).thin(VERTICES)
    kept = np.unique(np.concatenate([np.ravel(part) for part in parts]))
    place = {int(vertex): nth for nth, vertex in enumerate(kept)}
    places, inside = painted(head)
    light = openness(head)
    for part, least in zip(parts, LEAST_LIGHT):
        corners = np.unique(part)
        light[corners] = np.maximum(light[corners], least)
    light = np.round(127 * light[kept, None])
    numbers = [len(kept), *map(len, parts), len(names), 0, 0]
    blob = np.array(numbers, "<u2").tobytes()
    for eye in head.eyes:
        centre = eye.mean(axis=0)
        radius = np.median(np.linalg.norm(eye - centre, axis=1))
        blob += np.array([*centre, radius], "<f4").tobytes()
    blob += np.round(100 * places[kept]).astype("<i2").tobytes()
    blob += np.hstack([np.round(8 * inside[kept]), light]).astype("i1").tobytes()
    corners = [place[corner] for part in parts for triangle in part for corner in triangle]
    blob += np.array(corners, "<u2").tobytes()
    for name in names:
        moved = moves(head, name)[kept]
        chosen = np.flatnonzero(np.linalg.norm(moved, axis=1) > STILL_MM)
        step = max(np.abs(moved[chosen]).max(initial=0) / 127, 1e-6)
        blob += np.array([step], "<f4").tobytes() + np.array([len(chosen)], "<u2").tobytes()
        blob += chosen.astype("<u2").tobytes()
        blob += np.round(moved[chosen] / step).astype("i1").tobytes()
    out.write_bytes(blob)
    print(f"{out}: {len(blob)} bytes, {len(kept)} vertices, {sum(map(len, parts))} triangles")


main()
