"""Whole scenes, and mistakes that they may have."""
import json
import math

from at_random import between, direction, some, vector
from make_motion import FINGERS, make_hand, make_motion
from make_object import add_latch, make_object

SEGMENTS = [f"thumb {bone}" for bone in ("metacarpal", "proximal", "distal")] + ["palm"] + [
    f"{finger} {bone}" for finger in FINGERS[1:] for bone in ("proximal", "intermediate", "distal")]


def make_settings(r, seconds):
    tick_count = round(between(r, 30, 250))
    settings = {"seconds": seconds, "rate": tick_count / seconds, **some(
        r, 0.4, stiffness=between(r, 1e5, 1e9), max_force=r.choice([5, 20, 100, 1000]),
        fade_time=r.choice([0, 0.02, 0.5]), proxy_stiffness=r.choice([0, 100, 300, 3000, 20000]),
        felt_once=r.choice(["never", "by-samples"]))}
    settings.update(some(r, 0.1, effort=round(between(r, 100, 50000)), max_candidates=round(between(r, 1, 5000))))
    settings["law"] = r.choice(["field"] * 12 + ["column", "max-depth", "centroid", "point"])
    if r.random() < 0.7:
        settings["precision"] = r.choice([0, 0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1])
    if settings["law"] == "point":
        settings["point_area"] = between(r, 1e-6, 1e-3)
    if r.random() < 0.4:
        layers = sorted(r.uniform(0.05, 0.95) for _ in range(r.randint(0, 2)))
        settings["pad"] = {"layers": [{"from": at, "stiffness": r.choice([-0.3, 2, 20, 200])} for at in layers],
                           **some(r, 0.6, damping=between(r, 0.01, 100))}
    if r.random() < 0.35:
        precision, law = {"precision": r.choice([0, 1e-5, 1e-3])}, {"law": r.choice(["column", "max-depth"])}
        settings["segments"] = [{"segment": name, **r.choice([precision] * 5 + [law])}
                                for name in r.sample(SEGMENTS, r.randint(1, 6))]
    elif settings["law"] == "field" and r.random() < 0.1:
        settings["felt_once"] = "always"
    return settings


def make_scene(r, folder):
    """Its files are written to the folder, but for the scene itself."""
    place = r.choice([[0, 0, 0], [0, 0, 0], [0, 0, 0], vector(r, between(r, 0.1, 5000))])
    seconds, physics = round(r.uniform(0.3, 1.5), 3), r.random() < 0.12
    names = [r.choice(["object_{}", "object {}"]).format(i) for i in range(r.choice([1, 1, 2, 2, 3, 5]))]
    objects = [make_object(r, folder, name, place, physics) for name in names]
    add_latch(r, objects)
    scene = {"objects": objects, "motion": make_motion(r, folder, objects, place, seconds),
             "settings": make_settings(r, seconds)}
    if any(thing.get("moves") == "given" and ("mass" in thing or "density" in thing) for thing in objects):
        scene.update(some(r, 0.8, physics={"engine": "bullet", **some(r, 0.5, friction=between(r, 0.01, 10))}))
    scene.update(some(r, 0.2, gravity=direction(r, r.choice([0, 1, 10, 100]))))
    if r.random() < 0.25:
        up = r.choice([[0, 0, 1], direction(r)])
        height = sum(a * b for a, b in zip(up, place)) / math.hypot(*up) - r.uniform(-0.01, 0.1)
        scene["ground"] = {"normal": up, "height": height, **some(r, 0.5, friction=between(r, 0.01, 10))}
    hand = make_hand(r) if r.random() < 0.5 else {}
    if hand and r.random() < 0.2:
        (folder / "hand.json").write_text(json.dumps(hand))
        scene["hand_file"] = "hand.json"
    elif hand:
        scene["hand"] = hand
    execution = some(r, 0.15, leaf_size=r.randint(1, 64), tree_levels=r.randint(0, 12), cell_size=between(r, 0.005, 1),
                     threads=r.randint(1, 3))
    return scene | ({"execution": execution} if execution else {})


MISTAKES = [  # what is set, where, and which words the program should say of it
    ("settings", {"rate": 0}, "settings.rate"),
    ("settings", {"precision": 0.5}, "settings.precision"),
    ("settings", {"law": "fields"}, "settings.law"),
    ("settings", {"stiffness": -1}, "settings.stiffness"),
    ("settings", {"segments": [{"segment": "palm", "precision": 0}] * 2}, "settings.segments[1].segment"),
    ("settings", {"pad": {"layers": [{"from": 0.5}]}}, "settings.pad.layers[0]"),
    ("settings", {"pad": {"layers": [{"from": x, "stiffness": 1} for x in (0.2, 0.4, 0.6)]}}, "settings.pad.layers"),
    ("object", {"colour": "red"}, "colour"),
    ("object", {"plane": {}, "box": {}}, "objects[0]"),
    ("object", {"friction": 11}, "objects[0].friction"),
    ("object", {"moves": "about"}, "objects[0].moves"),
    ("object", {"moves": "fixed", "orientation": [0, 0, 0, 0]}, "objects[0].orientation"),
    ("object", {"moves": "fixed", "position": [0, 1e9, 0]}, "objects[0].position"),
    ("object", {"surface": {"bumps": {"image": "none.pgm"}}}, "objects[0].surface"),
    ("object", {"surface": {"bumps": {"image": "none.pgm", "period": 0.1, "white": 1e-3}}}, "none.pgm"),
    ("motion", {"file": "none.csv", "grasp": {}}, "motion"),
    ("scene", {"motion": {"file": "none.csv"}}, "none.csv"),
    ("scene", {"motion": {"rate": 30}}, "motion"),
    ("scene", {"objects": []}, "objects"),
    ("scene", {"objects": [{"mesh": "none.obj", "unit": "m"}]}, "none.obj"),
    ("scene", {"objects": [{"mesh": "none.obj"}]}, "objects[0]"),
    ("scene", {"objects": [{"box": {}, "moves": "free"}]}, "objects[0]"),
    ("scene", {"objects": [{"box": {}, "moves": "hinge", "mass": 1, "joint": {"latch": {"object": "no", "opens": 1}}}]},
     "objects[0].joint.latch.object"),
    ("scene", {"world": "none.world", "execution": {}}, "none.world"),
    ("scene", {"hand": {"length": 0.01}}, "hand"),
    ("scene", {"hand": {"palm": {"polygon": [{"x": 0, "z": 0}] * 3}}}, "palm.polygon"),
    ("scene", {"gravity": [0, 0]}, "gravity"),
    ("scene", {"ground": {"normal": [0, 0, 0]}}, "ground.normal"),
    ("scene", {"execution": {"leaf_size": 0}}, "execution.leaf_size"),
    ("scene", {"physics": {"engine": "none"}}, "physics.engine"),
]


def make_mistake(r, scene):
    """Puts one into the scene; what the program should name."""
    where, wrong, named = r.choice(MISTAKES)
    table = {"scene": scene, "object": scene["objects"][0]}.get(where) or scene[where]
    table.update(wrong)
    if "hand" in wrong:
        scene.pop("hand_file", None)
    return named
