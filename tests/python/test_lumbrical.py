"""The Python module as people use it, and as they misuse it."""
import os
import resource
import threading
import time

import numpy as np
import pytest

import lumbrical as lum


def ball_scene(**settings):
    scene = lum.Scene("right")
    scene.add_object("ball", *lum.make_sphere(0.04, 6))
    for name, value in settings.items():
        setattr(scene, name, value)
    return scene


def touching_frames(count):
    """Palm down over the ball, lower with every frame, fingers slowly bending."""
    share = np.arange(count) / 100
    angles = np.outer(0.2 * share, np.arange(20) % 4 != 0)
    position = np.stack([0.001 * share, np.full(count, -0.12), 0.07 - 0.03 * share], axis=1)
    return lum.angle_frames(angles, position, (np.sqrt(0.5), np.sqrt(0.5), 0, 0))


def same_bits(a, b):
    """Of all fields; bytes between them are nobody's."""
    if a.dtype.names is None:
        return a.tobytes() == b.tobytes()
    return a.dtype == b.dtype and all(same_bits(a[name], b[name]) for name in a.dtype.names)


@pytest.fixture
def session():
    return lum.Session(lum.Model(ball_scene()))


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
    with pytest.raises(ValueError):
        session.run(frames, given[:39])


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
    with pytest.raises(ValueError, match="friction_factor"):
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
        assert np.shares_memory(ticks["output"]["segment"]["force"], ticks)
        assert list(recording.read(10, 50, 10)["output"]["tick"]) == [10, 20, 30, 40]
        assert recording.read_objects().shape == (100, 0)
        again = lum.Session(recording.model()).run(ticks["frame"])
        assert same_bits(again, outputs)
    changed = lum.what_if(path, stiffness=1e7)
    assert changed["ticks"] == 100 and changed["force"]["max"].max() > 0.01


def test_forces_left_out_are_nan(tmp_path, session):
    path = str(tmp_path / "sparse.mcap")
    session.record(path, force_interval=10)
    session.run(touching_frames(30))
    session.stop_recording()
    forces = lum.Recording(path).read()["output"]["segment"]["force"]
    assert np.isnan(forces[1:10]).all() and np.isfinite(forces[::10]).all()


# ---- What goes wrong

def test_a_full_disk_takes_no_forces_away(tmp_path, session):
    frames = np.repeat(touching_frames(80), 5)
    path = str(tmp_path / "touch.mcap")
    session.record(path)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, limits[1]))
    outputs = []
    try:
        with pytest.warns(RuntimeWarning, match="no longer recorded") as warned:
            while len(outputs) < 3 or not len(warned):
                outputs.append(session.run(frames))
                time.sleep(0.01)  # the recorder is a thread of its own
        with pytest.raises(ValueError, match="touch.mcap.*the file has [1-9][0-9]* ticks"):
            session.stop_recording()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert len(warned) == 1
    alone = lum.Session(lum.Model(ball_scene()))
    assert all(same_bits(output, alone.run(frames)) for output in outputs)
    assert session.tick(frames[0])["tick"] == 400 * len(outputs)


def test_a_closed_recording_says_so(tmp_path, session):
    path = str(tmp_path / "touch.mcap")
    session.record(path)
    session.run(touching_frames(5))
    session.stop_recording()
    recording = lum.Recording(path)
    recording.close()
    recording.close()
    for use in (recording.read, recording.model, lambda: recording.info, recording.read_objects):
        with pytest.raises(ValueError, match="closed"):
            use()


@pytest.mark.parametrize("frames, error", [
    (None, TypeError), (3, TypeError), ("frames", TypeError), (np.zeros((5, 20)), TypeError),
    (np.zeros(3, dtype=[("angle", "f4", 20)]), TypeError), (np.zeros((2, 2), dtype=lum.frame_dtype), ValueError),
    (np.full(1, 9, dtype=[("kind", "u1")])["kind"].repeat(lum.frame_dtype.itemsize).view(lum.frame_dtype), ValueError),
])
def test_frames_of_another_kind_are_refused(session, frames, error):
    with pytest.raises(error):
        session.run(frames)
    with pytest.raises(error):
        lum.Batch(lum.Model(ball_scene()), 2).tick(frames)


def test_a_tick_of_several_frames_is_refused_before_it_is_done(session):
    for count in (0, 2):
        with pytest.raises(ValueError, match="one frame"):
            session.tick(touching_frames(count))
    assert session.state.tick == 0
    with pytest.raises(TypeError):
        session.tick(np.zeros(1, dtype=lum.pose_dtype)[0])


def test_strided_and_empty_frames_are_frames(session):
    frames = touching_frames(60)
    strided = session.run(frames[::2])
    assert same_bits(strided, lum.Session(lum.Model(ball_scene())).run(frames[::2].copy()))
    assert len(session.run(frames[:0])) == 0
    assert len(session.run(frames[::-1])) == 60


@pytest.mark.parametrize("vertices, triangles, error", [
    (None, [[0, 1, 2]], TypeError), ([[0, 0, 0]], None, TypeError), ("mesh", [[0, 1, 2]], TypeError),
    (np.zeros((3, 2)), [[0, 1, 2]], ValueError), (np.zeros((3, 3)), [[0, 1]], ValueError),
    (np.zeros((3, 3)), [[0, 1, 3]], ValueError), (np.zeros((3, 3)), [[0, 1, -1]], ValueError),
    (np.zeros((3, 3)), [[0, 1, 1.5]], TypeError), (np.full((3, 3), np.nan), [[0, 1, 2]], ValueError),
    ([[0, 0, np.inf]] * 3, [[0, 1, 2]], ValueError), (np.zeros((3, 3), dtype=object), np.zeros((1, 3), dtype=object), TypeError),
])
def test_meshes_of_another_shape_or_kind_are_refused(vertices, triangles, error):
    with pytest.raises(error):
        lum.Scene().add_object("mesh", vertices, triangles)
    with pytest.raises(error):
        lum.probe(vertices, triangles, spheres=[[0, 0, 0, 1]])


def test_settings_out_of_range_are_told_when_the_model_is_built():
    for name, value in (("stiffness", -1.0), ("stiffness", float("nan")), ("rate", 0.0), ("max_force", float("inf"))):
        with pytest.raises(ValueError, match=name):
            lum.Model(ball_scene(**{name: value}))
    scene = ball_scene()
    scene.radii[3] = np.nan
    with pytest.raises(ValueError):
        lum.Model(scene)
    with pytest.raises(ValueError, match="law"):
        scene.law = "hooke"
    with pytest.raises(ValueError, match="broadphase"):
        lum.Model(ball_scene(), broadphase="quick")
    with pytest.raises(ValueError, match="threads"):
        lum.Model(ball_scene(), threads=0)
    with pytest.raises(ValueError, match="side"):
        lum.Scene("both")
    with pytest.raises(ValueError, match="unit"):
        lum.load_mesh("a.obj", "inch")
    with pytest.raises(ValueError, match="no such file.obj"):
        lum.load_mesh("no such file.obj", "m")
    with pytest.raises(ValueError, match="density or a mass"):
        scene.add_object("free", *lum.make_sphere(0.01, 2), moves="free")


@pytest.mark.parametrize("name", ["friction", "kinetic_friction", "viscosity", "shear_stiffness"])
@pytest.mark.parametrize("wrong", [np.nan, -1.0])
def test_a_material_that_makes_no_sense_is_refused(name, wrong):
    scene = lum.Scene()
    scene.add_object("ball", *lum.make_sphere(0.01, 2), **{name: wrong})
    with pytest.raises(ValueError, match="out of range"):
        lum.Model(scene)


@pytest.mark.parametrize("mass, density", [(np.nan, 1000), (-1, 1000), (1, np.nan), (1, -1), (1, 1000), (0, 0)])
def test_a_mass_that_makes_no_sense_is_refused(mass, density):
    with pytest.raises(ValueError, match="density or a mass"):
        lum.Scene().add_object("ball", *lum.make_sphere(0.01, 2), moves="free", mass=mass, density=density)


@pytest.mark.parametrize("wrong", [{"mass": 1}, {"density": 500}, {"mass": np.nan}, {"mass": -1, "friction": 0.5}])
def test_a_mass_of_what_stands_still_is_refused(wrong):
    with pytest.raises(ValueError, match="stands still takes no density or mass"):
        lum.Scene().add_object("ball", *lum.make_sphere(0.01, 2), **wrong)


def test_what_is_given_where_it_goes_may_have_a_mass_or_none():
    for good in ({}, {"mass": 0.2}, {"density": 500}):
        lum.Scene().add_object("ball", *lum.make_sphere(0.01, 2), moves="given", **good)
    for wrong in ({"mass": -1}, {"mass": np.nan}, {"mass": 1, "density": 500}):
        with pytest.raises(ValueError, match="density or a mass"):
            lum.Scene().add_object("ball", *lum.make_sphere(0.01, 2), moves="given", **wrong)


def test_none_and_other_types_are_refused():
    for make in (lum.Model, lum.Session, lum.Recording, lum.replay, lum.Scene.load):
        with pytest.raises(TypeError):
            make(None)
    with pytest.raises(TypeError):
        lum.Session(lum.Model(ball_scene())).state = None
    with pytest.raises(ValueError):
        lum.angle_frames(np.full(20, np.nan))
    with pytest.raises(ValueError):
        lum.angle_frames(np.zeros((3, 19)))
    with pytest.raises(ValueError):
        lum.angle_frames(np.zeros((3, 20)), position=np.zeros((2, 3)))
    with pytest.raises(ValueError):
        lum.pose_frames(np.zeros((26, 3)), np.zeros((25, 4)))


@pytest.mark.parametrize("make, told", [
    (lambda: lum.make_sphere(0.03, 0), "cells .* 1 to 8192"), (lambda: lum.make_sphere(np.nan, 5), "radius .* m"),
    (lambda: lum.make_plane(1, 16385), "cells .* 1 to 16384"), (lambda: lum.make_plane(0, 1), "extent .* m"),
    (lambda: lum.make_box((0.1, 0, 0.1), 1), "size .* m"), (lambda: lum.make_box((1, 1, 1), 8193), "cells"),
    (lambda: lum.make_mug(segments=7), "segments .* 8 to 2048"), (lambda: lum.make_mug(wall=0), "wall .* 1000 m"),
    (lambda: lum.make_mug(wall=0.03), "half of radius"), (lambda: lum.make_mug(height=0.02), "handle"),
])
def test_a_shape_that_is_not_made_says_which_argument_is_wrong(make, told):
    with pytest.raises(ValueError, match=told):
        make()


@pytest.mark.parametrize("given", [[1, 2], 3, np.zeros(3), np.zeros(1, dtype=lum.frame_dtype)])
def test_poses_of_another_kind_are_refused(session, given):
    with pytest.raises(TypeError, match="given is not an array of lumbrical.pose_dtype"):
        session.run(touching_frames(1), given)


def test_more_hands_than_can_be_are_refused():
    with pytest.raises(ValueError, match="count"):
        lum.Batch(lum.Model(ball_scene()), 2**62)


def test_paths_are_taken_as_python_has_them(tmp_path, session):
    path = tmp_path / "touch.mcap"
    session.record(path)
    session.run(touching_frames(5))
    session.stop_recording()
    assert lum.replay(path)["identical"] and lum.what_if(path)["ticks"] == 5
    for same in (path, str(path), os.fsencode(path)):
        with lum.Recording(same) as recording:
            assert recording.info["ticks"] == 5
    assert lum.Scene.load(os.path.join(os.environ["LUMBRICAL_SOURCE_DIR"], "examples/cup.json")).side == "right"
    (tmp_path / "one.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert len(lum.load_mesh(tmp_path / "one.obj", "m")[1]) == 1


def test_a_path_with_a_nul_is_refused(tmp_path):
    path = str(tmp_path / "touch\0.mcap")
    record = lum.Session(lum.Model(ball_scene())).record
    for take in (record, lum.Recording, lum.replay, lum.what_if, lum.Scene.load, lambda p: lum.load_mesh(p, "m")):
        with pytest.raises(ValueError, match="NUL"):
            take(path)
    assert not os.listdir(tmp_path)


@pytest.mark.parametrize("use", [
    lambda: lum.Session.__new__(lum.Session).tick(touching_frames(1)), lambda: lum.Session.__new__(lum.Session).joints,
    lambda: lum.Scene.__new__(lum.Scene).rate, lambda: lum.Scene.__new__(lum.Scene).radii,
    lambda: lum.Model(lum.Scene.__new__(lum.Scene)), lambda: lum.Model.__new__(lum.Model).rate,
    lambda: len(lum.Batch.__new__(lum.Batch)), lambda: lum.Recording.__new__(lum.Recording).read(),
    lambda: lum.State.__new__(lum.State).tick,
])
def test_what_no_call_of_its_class_has_made_is_refused(use):
    with pytest.raises(TypeError, match="not made"):
        use()


def test_questions_before_the_first_tick_are_refused(session):
    for ask in (session.contacts, session.jacobians, lambda: session.joints, lambda: session.objects):
        with pytest.raises(RuntimeError, match="ticked"):
            ask()


def test_a_recording_begins_with_the_first_tick(tmp_path, session):
    session.run(touching_frames(3))
    with pytest.raises(RuntimeError, match="first tick"):
        session.record(str(tmp_path / "late.mcap"))
    with pytest.raises(RuntimeError, match="not recorded"):
        session.stop_recording()


def test_threads_that_meet_in_a_session_are_told_and_others_run_on(session):
    frames = touching_frames(400)
    told, done, ticks = [], [], []

    def run():
        for _ in range(5):
            try:
                done.append(len(session.run(frames)))
            except RuntimeError as error:
                told.append(str(error))
            try:
                ticks.append(session.state.tick)
            except RuntimeError as error:
                assert "another thread" in str(error)

    threads = [threading.Thread(target=run) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(told) + len(done) == 15 and done
    assert all(tick % 400 == 0 for tick in ticks), "a state amid another thread's run"
    assert all("another thread" in text for text in told)
    assert session.run(frames[:1])["tick"][0] == 400 * len(done)


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
