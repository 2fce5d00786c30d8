"""The Python module as people use it."""
import os
import subprocess
import sys

import numpy as np
import pytest

import lumbrical as lum
from touching import ball_scene, same_bits, touching_frames


# ---- What comes out

def test_forces_are_views_of_the_engines_memory(session):
    outputs = session.run(touching_frames(100))
    forces = outputs["segment"]["force"]
    assert forces.shape == (100, 16, 3) and forces.dtype == np.float64
    assert np.shares_memory(forces, outputs)
    assert outputs.dtype == lum.output_dtype
    assert np.abs(forces[-1]).max() > 0.1 and not forces[0].any()
    assert list(outputs["tick"]) == list(range(100))
    assert lum.hand_force(outputs).shape == (100, 3)


def test_a_run_is_its_ticks_one_by_one(session):
    frames = touching_frames(60)
    outputs = session.run(frames)
    again = lum.Session(lum.Model(ball_scene()))
    for frame, expected in zip(frames, outputs):
        out = again.tick(frame)
        assert out.shape == () and out["segment"]["force"].shape == (16, 3)
        assert same_bits(out, expected)


def test_poses_of_joints_give_what_their_angles_gave(session):
    frames = touching_frames(90)
    by_angles = session.run(frames)[-1]
    joints = session.joints
    assert joints.shape == (26,) and not joints.flags.writeable
    xyzw = np.roll(joints["orientation"], -1, axis=1)
    poses = lum.pose_frames(np.repeat(joints["position"][None], 90, 0), np.repeat(xyzw[None], 90, 0))
    by_poses = lum.Session(lum.Model(ball_scene())).run(poses)[-1]
    assert np.abs(by_angles["segment"]["force"] - by_poses["segment"]["force"]).max() < 1e-3
    assert by_poses["contact_count"] == by_angles["contact_count"]


def test_a_hand_is_fitted_to_a_trackers_frame(session):
    session.run(touching_frames(1))
    joints = session.joints
    frame = lum.pose_frames(1.2 * joints["position"][None], np.roll(joints["orientation"], -1, axis=1)[None])
    small, large = ball_scene(), ball_scene()
    radii = np.zeros(26)
    radii[10] = 0.0099
    large.fit_hand(frame[0], radii)
    assert large.radii[10] == 0.0099 and np.array_equal(np.delete(large.radii, 10), np.delete(small.radii, 10))
    lost, point = frame.copy(), frame.copy()
    lost["flags"] = lum.TRACKING_LOST
    point["joint"]["position"] = 0
    for wrong, told in ((touching_frames(1), "tracked"), (lost, "tracked"), (point, "no area"), (frame.repeat(2), "one frame")):
        with pytest.raises(ValueError, match=told):
            large.fit_hand(wrong, np.full(26, 0.01))
    assert large.radii[10] == 0.0099 and np.array_equal(np.delete(large.radii, 10), np.delete(small.radii, 10))
    felt = [lum.hand_force(lum.Session(lum.Model(scene)).run(touching_frames(100)))[-1] for scene in (small, large)]
    assert np.linalg.norm(felt[1] - felt[0]) > 0.01, "another palm feels otherwise"


def test_two_hands_share_a_world():
    model = lum.Model(ball_scene())
    left = model.share(lum.Scene("left"))
    assert (model.side, left.side) == ("right", "left") and left.object_names == ["ball"]
    assert np.shares_memory(left.vertices[0], model.vertices[0])
    right = model.share(lum.Scene("right"))
    assert same_bits(lum.Session(right).run(touching_frames(60)), lum.Session(model).run(touching_frames(60)))
    with pytest.raises(ValueError, match="radius"):
        bad = lum.Scene("left")
        bad.radii[3] = -1
        model.share(bad)


def test_pads_harden_and_are_damped():
    frames = touching_frames(90)
    plain = lum.Session(lum.Model(ball_scene())).run(frames)[-1]
    scene = ball_scene(pad_damping=2)
    scene.pad_layers[0] = (0.1, 5)
    hard = lum.Session(lum.Model(scene)).run(frames)[-1]
    assert np.linalg.norm(lum.hand_force(hard)) > np.linalg.norm(lum.hand_force(plain))
    scene.pad_layers[0] = (0.1, -2)
    with pytest.raises(ValueError, match="pad"):
        lum.Model(scene)


def test_contacts_add_up_to_the_forces():
    scene = ball_scene(max_force=1000)
    scene.precision[:] = 0
    session = lum.Session(lum.Model(scene))
    out = session.run(touching_frames(90))[-1]
    contacts = session.contacts()
    assert len(contacts) == out["contact_count"] > 0
    total = np.zeros((16, 3))
    np.add.at(total, contacts["segment"], contacts["force"])
    assert np.abs(total - out["segment"]["force"]).max() < 1e-9
    assert (contacts["depth"] > 0).all() and (contacts["area"] > 0).all()
    assert (contacts["object"] == 0).all()


def contacts_of_a_tilted_ball(**how):
    scene = lum.Scene("right")
    scene.max_force = 1000
    scene.precision[:] = 0
    scene.add_object("ball", *lum.make_sphere(0.04, 6), position=(0.002, 0.001, 0.001), orientation=(0.7, 0.5, -0.5, 0.1),
                     **how)
    scene.add_object("far", *lum.make_box((0.1, 0.1, 0.1), 1), position=(2, 0, 0))
    model = lum.Model(scene)
    session = lum.Session(model)
    out = session.run(touching_frames(90))[-1]
    contacts = session.contacts()
    assert len(contacts) == out["contact_count"] > 0
    assert {model.object_names[i] for i in contacts["object"]} == {"ball"}
    return contacts, out


@pytest.mark.parametrize("how", [{"friction": 0.5}, {"moves": "given"}, {"crease_angle": 0.1}])
def test_contacts_of_objects_apart_are_those_of_the_same_object_in_the_world(how):
    expected, _ = contacts_of_a_tilted_ball()
    contacts, out = contacts_of_a_tilted_ball(**how)
    assert (contacts["segment"] == expected["segment"]).all() and (contacts["triangle"] == expected["triangle"]).all()
    for field in ("depth", "area", "centroid", "centre", "normal", "force"):
        assert np.abs(contacts[field] - expected[field]).max() < 1e-9, field
    if "moves" in how:
        total = np.zeros((16, 3))
        np.add.at(total, contacts["segment"], contacts["force"])
        assert np.abs(total - out["segment"]["force"]).max() < 1e-9


def test_a_models_mesh_is_seen_where_it_lies():
    model = lum.Model(ball_scene())
    x, y, z = model.vertices
    a, b, c = model.triangles
    assert np.allclose(np.sqrt(x * x + y * y + z * z), 0.04)
    assert not x.flags.owndata and not x.flags.writeable and x.base is not None
    assert a.dtype == np.uint32 and max(a.max(), b.max(), c.max()) == len(x) - 1
    del model
    assert abs(x[0]) <= 0.04  # the view keeps it alive


def test_jacobians_predict_a_small_move():
    scene = ball_scene(fade_time=0)
    scene.precision[:] = 0
    model = lum.Model(scene)
    frame = touching_frames(61)[-1:]
    moved = frame.copy()
    moved["base"]["position"][0, 2] -= 1e-7
    session = lum.Session(model)
    before = session.tick(frame)["segment"]["force"].copy()
    values, known = session.jacobians()
    after = lum.Session(model).tick(moved)["segment"]["force"]
    assert values.shape == (16, 6, 6) and known.all()
    assert np.abs(values).max() > 1
    assert np.allclose(after - before, values[:, :3, 2] * -1e-7, atol=1e-8, rtol=1e-3)


def test_given_objects_go_where_they_are_told():
    scene = lum.Scene("right")
    scene.max_force = 1000
    scene.add_object("ball", *lum.make_sphere(0.04, 6), moves="given")
    session = lum.Session(lum.Model(scene))
    frames = np.repeat(touching_frames(61)[-1:], 40)
    given = np.zeros((40, 1), dtype=lum.pose_dtype)
    given["orientation"][..., 0] = 1
    given["position"][..., 2] = np.arange(40)[:, None] * 1e-4
    outputs = session.run(frames, given)
    assert outputs["segment"]["force"][-1, :, 2].sum() > outputs["segment"]["force"][20, :, 2].sum() > 0
    assert session.objects["pose"]["position"][0, 2] == given["position"][-1, 0, 2]
    assert np.allclose(session.objects["wrench"]["force"][0], -lum.hand_force(outputs)[-1], atol=1e-6)


@pytest.mark.parametrize("frames, objects, good, wrong", [
    (3, 2, [(3, 2)], [(2, 3), (6,), (1, 6, 1), (3,), (2,), (2, 2), ()]), (1, 2, [(1, 2), (2,)], [(2, 1), (1,), ()]),
    (3, 1, [(3, 1), (3,), (3, 0)], [(1, 3), (1,), (2, 1), ()]), (1, 1, [(1, 1), (1,), ()], [(1, 1, 1), (2,)]),
])
def test_poses_of_given_objects_stand_in_their_places(frames, objects, good, wrong):
    scene = lum.Scene()
    for name in "ab"[:objects]:
        scene.add_object(name, *lum.make_sphere(0.04, 2), moves="given")
    model = lum.Model(scene)
    places = np.arange(frames * objects, dtype=float)
    for shape in good + wrong:
        given = np.zeros(shape, dtype=lum.pose_dtype)
        given["orientation"][..., 0] = 1
        session = lum.Session(model)
        if shape in wrong:
            with pytest.raises(ValueError, match=rf"shape .* in the place of \({frames}, {objects}\)"):
                session.run(touching_frames(frames), given)
            assert session.state.tick == 0
        elif given.size == frames * objects:
            given["position"][..., 0] = places.reshape(shape)
            session.run(touching_frames(frames), given)
            assert list(session.objects["pose"]["position"][:, 0]) == list(places[-objects:])
        else:
            assert same_bits(session.run(touching_frames(frames), given), lum.Session(model).run(touching_frames(frames)))


def test_a_surface_is_felt():
    sphere = lum.make_sphere(0.04, 4)
    ribs = (np.array([[0, 1]]), 0.004, 0, 0.0005)
    forces = []
    for surface in ({}, {"crease_angle": 0.8}, {"bumps": ribs}, {"friction_factors": np.full(len(sphere[1]), 0.1)}):
        scene = lum.Scene("right")
        scene.add_object("ball", *sphere, friction=0.5, **surface)
        outputs = lum.Session(lum.Model(scene)).run(touching_frames(80))
        forces.append(outputs["segment"]["force"].copy())
    for other in forces[1:]:
        assert np.abs(other - forces[0]).max() > 1e-3
    for grip in (3, ribs[:3], (np.array([[2.0]]), 0.1, 0, 1), (np.zeros(3), 0.1, 0, 1), (np.zeros((0, 2)), 0.1, 0, 1)):
        with pytest.raises((TypeError, ValueError)):
            lum.Scene().add_object("ball", *sphere, friction=0.5, grip=grip)
    scene = lum.Scene()
    scene.add_object("ball", *sphere, friction=0.5, friction_factors=[1, 2])
    with pytest.raises(ValueError, match="friction factors"):
        lum.Model(scene)


def test_a_free_body_falls():
    scene = lum.Scene("right")
    scene.add_object("box", *lum.make_box((0.1, 0.1, 0.1), 1), moves="free", density=500, position=(0, 0, 5))
    session = lum.Session(lum.Model(scene))
    session.run(np.repeat(touching_frames(1), 101))
    assert session.objects["pose"]["position"][0, 2] == pytest.approx(5 - 0.5 * 9.81 * 0.1 * 0.101, abs=1e-6)


def test_a_free_body_comes_to_rest_on_the_ground():
    scene = lum.Scene("right")
    assert scene.ground is None
    scene.ground = lum.Ground(normal=(0, 0, 2), offset=0.3, friction=0.8)
    assert scene.ground.normal == (0, 0, 1) and (scene.ground.offset, scene.ground.friction) == (0.3, 0.8)
    scene.add_object("box", *lum.make_box((0.1, 0.1, 0.1), 1), moves="free", density=500, position=(0, 5, 0.36))
    session = lum.Session(lum.Model(scene))
    session.run(np.repeat(touching_frames(1), 500))
    assert np.abs(session.objects["pose"]["position"][0] - (0, 5, 0.35)).max() < 1e-4
    scene.ground = None
    session = lum.Session(lum.Model(scene))
    session.run(np.repeat(touching_frames(1), 500))
    assert session.objects["pose"]["position"][0, 2] < 0


def test_a_ground_that_makes_no_sense_is_refused():
    scene = ball_scene()
    for wrong in ({"friction": -1}, {"offset": np.nan}, {"normal": (0, 0, 0)}):
        with pytest.raises(ValueError):
            scene.ground = lum.Ground(**wrong)
            lum.Model(scene)
    for wrong in (0.3, (0, 0, 1), lum.Ground.__new__(lum.Ground)):
        with pytest.raises(TypeError):
            scene.ground = wrong


def test_a_state_brings_back_every_bit(session):
    frames = touching_frames(80)
    session.run(frames[:40])
    state = session.state
    assert state.tick == 40
    first = session.run(frames[40:])
    session.state = state
    assert same_bits(session.run(frames[40:]), first)


def test_a_state_of_forces_above_the_limit_fades_from_the_limit():
    frames = touching_frames(80)
    strong = lum.Session(lum.Model(ball_scene(max_force=1000.0, stiffness=1e9)))
    weak = lum.Session(lum.Model(ball_scene(max_force=1.0, stiffness=1e9)))
    strong.run(frames)
    weak.run(frames)
    weak.state = strong.state
    lost = frames[-1:].copy()
    lost["flags"] = lum.TRACKING_LOST
    assert np.linalg.norm(weak.run(lost)["segment"]["force"], axis=2).max() <= 1 + 1e-6


def test_a_batch_is_its_hands_one_by_one():
    model = lum.Model(ball_scene())
    frames = touching_frames(100)
    batch = lum.Batch(model, 100)
    for _ in range(3):
        outputs = batch.tick(frames)
    for i in (0, 50, 99):
        alone = lum.Session(model).run(np.repeat(frames[i:i + 1], 3))
        assert same_bits(alone[-1], outputs[i])
    assert len(batch) == 100


def test_probe_measures_one_sphere():
    contacts = lum.probe(*lum.make_plane(0.2, 1), spheres=[[0.01, 0.02, 0.003, 0.008]], stiffness=1e6)
    depth = 0.005
    volume = np.pi * depth**2 * (0.008 - depth / 3)
    assert contacts["depth"].max() == pytest.approx(depth, abs=1e-12)
    assert contacts["area"].sum() == pytest.approx(np.pi * (0.008**2 - 0.003**2), rel=1e-9)
    assert contacts["force"].sum(axis=0)[2] > 0
    assert 0 < contacts["volume"].sum() < volume * 1.5


def test_a_scene_file_brings_its_motion():
    root = os.environ["LUMBRICAL_SOURCE_DIR"]
    scene = lum.Scene.load(os.path.join(root, "examples/cup.json"))
    frames = scene.frames()
    outputs = lum.Session(lum.Model(scene)).run(frames)
    assert len(frames) > 1000 and outputs["contact_count"].max() > 0


def test_a_law_that_not_all_segments_follow_is_none(tmp_path):
    (tmp_path / "mixed.json").write_text("""{"objects": [{"box": {}}], "motion": {"grasp": {}},
        "settings": {"segments": [{"segment": "palm", "law": "point"}]}}""")
    scene = lum.Scene.load(tmp_path / "mixed.json")
    assert scene.law is None
    scene.law = "column"
    assert scene.law == "column"


# ---- Recordings

@pytest.mark.parametrize("name, told", [("bodies", "bodies.json: physics: .*leave it out"),
                                        ("two_hands", "two_hands.json: motion: .*motion.side")])
def test_a_scene_file_that_asks_for_more_is_refused(name, told):
    with pytest.raises(ValueError, match=told):
        lum.Scene.load(os.path.join(os.environ["LUMBRICAL_SOURCE_DIR"], f"examples/{name}.json"))


def test_a_scene_file_with_a_path_is_refused(tmp_path):
    scene = """{"objects": [{"box": {}}, {"box": {}, "moves": "given"}, {"box": {}, "moves": "given"%s}],
                "motion": {"grasp": {"radius": 0.037, "height": 0.095}}}"""
    (tmp_path / "still.json").write_text(scene % "")
    (tmp_path / "told.json").write_text(scene % ', "path": [{"time": 0}, {"time": 1, "position": [0, 0, 1]}]')
    lum.Model(lum.Scene.load(tmp_path / "still.json"))
    with pytest.raises(ValueError, match=r"told.json: objects\[2\].path: .*tell each tick"):
        lum.Scene.load(tmp_path / "told.json")


def test_a_recording_is_read_replayed_and_changed(tmp_path, session):
    path = str(tmp_path / "touch.mcap")
    frames = touching_frames(100)
    session.record(path)
    outputs = session.run(frames)
    assert session.stop_recording() == 100
    replayed = lum.replay(path)
    assert (replayed["identical"], replayed["ticks"], replayed["divergence"]) == (True, 100, None)
    with lum.Recording(path) as recording:
        assert recording.info["ticks"] == 100 and recording.info["hands"] == ["right"]
        ticks = recording.read()
        assert same_bits(ticks["frame"], frames)
        assert same_bits(ticks["output"], outputs)
        assert (ticks["duration_ns"] > 0).all()
        assert np.shares_memory(ticks["output"]["segment"]["force"], ticks)
        assert list(recording.read(10, 50, 10)["output"]["tick"]) == [10, 20, 30, 40]
        assert recording.read_objects().shape == recording.read_given().shape == (100, 0)
        again = lum.Session(recording.model()).run(ticks["frame"])
        assert same_bits(again, outputs)
    changed = lum.what_if(path, stiffness=1e7)
    assert changed["ticks"] == 100 and changed["force"]["max"].max() > 0.01


def given_session(path, count=60):
    """Recorded: a ball that is told where it is, and rubs."""
    scene = lum.Scene()
    scene.add_object("ball", *lum.make_sphere(0.04, 4), moves="given", friction=0.5)
    session = lum.Session(lum.Model(scene))
    session.record(path)
    given = np.zeros((count, 1), dtype=lum.pose_dtype)
    given["orientation"][..., 0] = 1
    given["position"][..., 2] = np.arange(count)[:, None] * 1e-4
    return session, session.run(np.repeat(touching_frames(61)[-1:], count), given), given


def test_a_recording_of_given_objects_is_felt_again(tmp_path):
    path = tmp_path / "given.mcap"
    session, outputs, given = given_session(path)
    session.stop_recording()
    with lum.Recording(path) as recording:
        read = recording.read_given()
        assert read.shape == (60, 1) and same_bits(read, given)
        assert same_bits(recording.read_given(10, 50, 10), given[10:50:10])
        assert recording.read_given(60).shape == (0, 0)
        frames = recording.read()["frame"]
        assert same_bits(lum.Session(recording.model()).run(frames, read), outputs)
    pytest.importorskip("matplotlib")
    example = os.path.join(os.environ["LUMBRICAL_SOURCE_DIR"], "examples/python/what_if.py")
    subprocess.run([sys.executable, example, tmp_path / "what_if.png", path], check=True)


def test_ticks_told_of_other_numbers_of_objects_are_read_apart(tmp_path):
    path = tmp_path / "given.mcap"
    session, outputs, given = given_session(path)
    rest = session.run(touching_frames(60))
    session.stop_recording()
    with lum.Recording(path) as recording:
        with pytest.raises(ValueError, match="tick 60 has 0 poses of given objects, those before 1 each.*last=60"):
            recording.read_given()
        assert recording.read_objects().shape == (120, 1)
        frames, again = recording.read()["frame"], lum.Session(recording.model())
        assert same_bits(again.run(frames[:60], recording.read_given(0, 60)), outputs)
        assert same_bits(again.run(frames[60:], recording.read_given(60)), rest)


def test_a_replay_of_a_torn_file_says_so(tmp_path, session):
    path = tmp_path / "torn.mcap"
    session.record(path)
    session.run(touching_frames(100))
    session.stop_recording()
    assert lum.replay(path)["damage"] is None
    path.write_bytes(path.read_bytes()[:-200])
    torn = lum.replay(path)
    assert torn["identical"] and torn["damage"]


def test_forces_left_out_are_nan(tmp_path, session):
    path = str(tmp_path / "sparse.mcap")
    session.record(path, force_interval=10)
    session.run(touching_frames(30))
    session.stop_recording()
    forces = lum.Recording(path).read()["output"]["segment"]["force"]
    assert np.isnan(forces[1:10]).all() and np.isfinite(forces[::10]).all()


# ---- Settings that are arrays

def test_arrays_of_a_scene_are_written_to_and_set():
    scene = lum.Scene()
    scene.precision = 1e-3
    scene.gravity = [0, -9.81, 0]
    scene.radii = 1.1 * scene.radii
    scene.pad_layers = [[0.6, 1e7], [0, 0]]
    view = scene.precision
    scene.precision = np.linspace(1e-4, 1e-2, 16)
    assert view[0] == 1e-4 and view[15] == 1e-2
    assert list(scene.gravity) == [0, -9.81, 0] and scene.pad_layers[0, 1] == 1e7
    scene.gravity[2] = 1
    assert list(scene.gravity) == [0, -9.81, 1]


def test_each_segment_may_have_a_law_of_its_own():
    scene = lum.Scene()
    assert scene.laws == ("field",) * 16
    scene.laws = ["column"] * 15 + ["max-depth"]
    assert scene.law is None and scene.laws[14:] == ("column", "max-depth")
    scene.law = "field"
    assert scene.laws == ("field",) * 16


def test_scenes_and_models_say_what_they_are():
    scene = ball_scene()
    assert repr(scene) == "<lumbrical.Scene: right hand, 1 object>"
    triangles = len(lum.Model(scene).triangles[0])
    assert repr(lum.Model(scene)) == f"<lumbrical.Model: right hand, {triangles} triangles>"


# ---- The stubs

def test_the_stubs_name_what_is_there():
    import ast
    folder = os.path.dirname(lum.__file__)
    with open(os.path.join(folder, "__init__.pyi")) as file:
        tree = ast.parse(file.read())

    def names(body):
        found = set()
        for node in body:
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                found.add(node.name)
            elif isinstance(node, ast.AnnAssign):
                found.add(node.target.id)
        return found

    public = {name for name in dir(lum) if not name.startswith("_")} | {"__version__"}
    assert names(tree.body) == public
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            there = {name for name in vars(getattr(lum, node.name)) if not name.startswith("__")}
            special = {"__init__", "__len__", "__enter__", "__exit__"} & set(vars(getattr(lum, node.name)))
            wanted = names(node.body)
            assert wanted - {"__init__"} == there | special - {"__init__"}, node.name
    assert os.path.exists(os.path.join(folder, "py.typed"))


def test_help_says_what_the_stubs_say():
    import re
    with open(os.path.join(os.path.dirname(lum.__file__), "__init__.pyi")) as file:
        said = " ".join(re.findall("# (.*)", file.read()))
    methods = (lum.Scene.frames, lum.Scene.fit_hand, lum.Model.share, lum.Session.tick, lum.Session.run,
               lum.Session.contacts, lum.Recording.read_objects, lum.Recording.read_given, lum.replay, lum.what_if,
               lum.probe)
    for method in methods:  # whose first line is the signature
        assert method.__doc__.split("\n\n", 1)[1].strip() in said, method
    for kind in (lum.Ground, lum.Scene, lum.Model, lum.State, lum.Session, lum.Batch, lum.Recording):
        assert kind.__doc__ in said and kind.__doc__, kind
