"""Hands and their motions: the built-in grasp, and captures in every format."""
import json
import math
import pathlib
import shutil

from at_random import between, orientation, plus, some, vector

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
FINGERS = ("thumb", "index", "middle", "ring", "little")


def make_hand(r):
    hand = some(r, 0.5, length=r.uniform(0.12, 0.24))
    if r.random() < 0.3:
        joints = [f"{finger} {end}" for finger in FINGERS for end in ("proximal", "distal", "tip")] + ["wrist"]
        hand["radii"] = [{"joint": name, "radius": between(r, 0.003, 0.02)}
                         for name in r.sample(joints, r.randint(1, 6))]
    if r.random() < 0.3:
        corners = r.choice([[], [(-0.03, 0), (-0.03, -0.08), (0.03, -0.08)],
                            [(0.04 * math.cos(a), -0.05 + 0.05 * math.sin(a)) for a in range(6)]])
        hand["palm"] = {"polygon": [{"x": x, "z": z} for x, z in corners],
                        **some(r, 0.5, height=r.uniform(0, 0.02), thickness=between(r, 0.001, 0.05))}
    if r.random() < 0.3:
        hand["fingers"] = [{"name": name, **finger_shape(r, name)} for name in r.sample(FINGERS, r.randint(1, 3))]
    return hand


def finger_shape(r, name):
    metacarpal = 0 if name == "thumb" else r.uniform(0, 0.07)
    return some(r, 0.5, bone_length=[metacarpal] + [r.uniform(0.015, 0.06) for _ in range(3)],
                lower=[r.uniform(-1, 0) for _ in range(4)], upper=[r.uniform(0, 2) for _ in range(4)])


def moments(r, seconds):
    """Of a tracker's frames; now and then it sees nothing for a while."""
    times, now = [], 0.0
    while now < seconds:
        times.append(round(now, 4))
        now += 0.2 if r.random() < 0.05 else r.uniform(0.015, 0.06)
    return times


def finger_points(finger, side, bend):
    """Four joints of a plain hand that looks along -z, palm down: places [m], and how far each is turned down [rad]."""
    thumb = finger == 0
    x, z, turned = (-0.025, -0.03, 0.7) if thumb else (-0.045 + 0.022 * finger, -0.09, 0)
    lengths = (0.035, 0.03, 0.025) if thumb else (0.042, 0.026, 0.022)
    place, points, down = [x, 0.0, z], [], 0.2 if thumb else 0.0
    for length in lengths + (0,):
        down += bend * (0.4 if thumb else 1)
        points.append(([place[0] * (1 if side == "right" else -1), place[1], place[2]], down))
        along = length * math.cos(down)
        place = plus(place, [-along * math.sin(turned), -length * math.sin(down), -along * math.cos(turned)])
    return points


def bends(r, times):
    """How far the fingers are bent at each of the times [rad]."""
    first, last, swing = r.uniform(0.05, 0.3), r.uniform(0.3, 1), r.uniform(0, 0.2)
    return [first + (last - first) * t / (times[-1] or 1) + swing * math.sin(9 * t) ** 2 for t in times]


def angles_motion(r, side, times):
    steps = []
    turn = [x / math.hypot(*q) for q in [[r.gauss(0, 1) for _ in range(4)]] for x in q]
    away, way = vector(r, 0.12), vector(r, 0.1)
    for t, bend in zip(times, bends(r, times)):
        angles = [bend * r.uniform(0.9, 1.1) if i % 4 else r.uniform(-0.05, 0.05) for i in range(20)]
        wrist = {"position": plus(away, [t * x for x in way]), "orientation": turn}
        steps.append({"time": t, "wrist": wrist, "angles": angles})
    return "json", json.dumps({"format": "lumbrical-angles", "side": side, "samples": steps})


def landmarks_motion(r, side, times):
    lines = ["time," + ",".join(f"{axis}{i}" for i in range(21) for axis in "xyz")]
    for t, bend in zip(times, bends(r, times)):
        points = [[0, 0, 0]] + [place for finger in range(5) for place, _ in finger_points(finger, side, bend)]
        if r.random() < 0.03:
            points = [[0, 0, 0]] * 21  # the hand is lost
        lines.append(f"{t:.4f}," + ",".join(f"{x:.5f}" for place in points for x in place))
    return "csv", "\n".join(lines + [""])


def webxr_motion(r, side, times):
    bones = ("metacarpal", "phalanx-proximal", "phalanx-intermediate", "phalanx-distal", "tip")
    frames = []
    for t, bend in zip(times, bends(r, times)):
        joints = {"wrist": {"position": [0, 0, 0], "orientation": [0, 0, 0, 1], "radius": 0.02}}
        for finger, name in enumerate(FINGERS):
            points = finger_points(finger, side, bend)
            if finger:
                points.insert(0, ([points[0][0][0] / 2, 0, -0.03], 0))
            stem, names = (name, bones[:2] + bones[3:]) if finger == 0 else (f"{name}-finger", bones)
            for bone, (place, down) in zip(names, points):
                turn = [-math.sin(down / 2), 0, 0, math.cos(down / 2)]
                joints[f"{stem}-{bone}"] = {"position": place, "orientation": turn, "radius": 0.008}
        for name in r.sample(sorted(joints), r.choice([0, 0, 0, 1, 9])):
            del joints[name]  # not seen in this frame
        frames.append({"time": t, "joints": joints if r.random() > 0.03 else None})
    return "json", json.dumps(frames)


def leap_motion(r, sides, times):
    frames = []
    for t, bend in zip(times, bends(r, times)):
        hands, pointables = [], []
        for number, side in enumerate(sides):
            shift = 0.12 * (number if side == "right" else -number)
            move = lambda place: [1000 * x for x in plus(place, [shift, 0, 0])]
            hands.append({"id": number + 1, "type": side, "direction": [0, 0, -1], "palmNormal": [0, -1, 0],
                          "wrist": move([0, 0, 0])})
            for finger in range(5 if r.random() > 0.03 else 4):
                places = [move(place) for place, _ in finger_points(finger, side, bend)]
                pointables.append({"handId": number + 1, "type": finger,
                                   **dict(zip(("mcpPosition", "pipPosition", "dipPosition", "btipPosition"), places))})
        frames.append({"timestamp": round(1e6 * t), "hands": hands, "pointables": pointables})
    return "json", json.dumps({"frames": frames})


def motion_file(r, folder, seconds):
    """Writes a motion or takes one of the examples'; its name, and the side it is of."""
    kind = r.choice(["angles", "landmarks", "webxr", "leap", "both", "example"])
    if kind == "example":
        name = r.choice(["grasp.json", "stroke.csv", "twirl.json", "twist.json", "hold.json"])
        shutil.copy(EXAMPLES / name, folder / name)
        return name, "both" if name == "hold.json" else "right"
    side, times = r.choice(["left", "right"]), moments(r, seconds)
    if kind in ("leap", "both"):
        ending, text = leap_motion(r, [side] if kind == "leap" else ["right", "left"], times)
    else:
        writers = {"angles": angles_motion, "landmarks": landmarks_motion, "webxr": webxr_motion}
        ending, text = writers[kind](r, side, times)
    (folder / f"motion.{ending}").write_text(text)
    return f"motion.{ending}", "both" if kind == "both" else side


def alignment(r, objects, place):
    target = r.choice(["contact", "contact", "centre", "top", "bottom", "left", "right", "front", "back"])
    return r.choice([target, f"{r.choice(objects)['name']}:{target}", ",".join(f"{x:.6g}" for x in place)])


def make_motion(r, folder, objects, place, seconds):
    if r.random() < 0.5:
        grasp = some(r, 0.5, radius=r.uniform(0.015, 0.06), height=r.uniform(0.05, 0.2), lift=between(r, 0.01, 0.3))
        motion = {"grasp": {"seconds": max(0.5, seconds), **grasp}, "position": place,
                  **some(r, 0.3, side=r.choice(["left", "right"]))}
    else:
        name, side = motion_file(r, folder, seconds)
        side = r.choice(["both", "both", "left", "right"]) if side == "both" else side
        motion = {"file": name, "side": side, "align": alignment(r, objects, place),
                  **some(r, 0.1, rate=between(r, 10, 100))}
        if r.random() < 0.2:
            motion["position"] = place
            del motion["align"]
    return motion | some(r, 0.3, orientation=orientation(r))
