"""The Python module as people misuse it."""
import os
import resource
import signal
import threading
import time

import numpy as np
import pytest

import lumbrical as lum
from touching import ball_scene, same_bits, touching_frames


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
    for use in (recording.read, recording.model, lambda: recording.info, recording.read_objects, recording.read_given):
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


POSES = np.zeros((26, 3)), np.tile([0, 0, 0, 1], (26, 1))


@pytest.mark.parametrize("valid", [0.5, 3.0, True, "3", None, np.ma.array([1, 2], mask=[1, 0])])
def test_a_mask_of_joints_that_is_no_whole_number_is_refused(valid):
    with pytest.raises(TypeError, match="valid is a whole number"):
        lum.pose_frames(*POSES, valid=valid)


@pytest.mark.parametrize("valid", [-1, 2**26, 2**32 + 1, 2**64, [1, 2**40 + 3], np.array([-1]), [[1, 2]]])
def test_a_mask_of_other_joints_than_there_are_is_refused(valid):
    with pytest.raises(ValueError, match="valid"):
        lum.pose_frames(*POSES, valid=valid)


def test_a_mask_is_for_all_frames_or_for_each():
    assert list(lum.pose_frames(*POSES, valid=[1, 2, 3])["valid"]) == [1, 2, 3]
    assert list(lum.pose_frames(*(p[None].repeat(2, 0) for p in POSES), valid=5)["valid"]) == [5, 5]
    with pytest.raises(ValueError, match="lengths"):
        lum.pose_frames(*(p[None].repeat(2, 0) for p in POSES), valid=[1, 2, 3])


@pytest.mark.parametrize("make", [
    lambda: lum.angle_frames(np.full(20, 1e39)), lambda: lum.pose_frames(np.full((26, 3), -1e39), POSES[1]),
    lambda: lum.pose_frames(POSES[0], np.full((26, 4), 1e300)),
])
def test_no_frame_is_made_of_what_single_precision_does_not_hold(make):
    with pytest.raises(ValueError, match="too large for float32"):
        make()


NO_NUMBERS = [np.full(3, "1"), ["1", "2", "3"], np.full(3, 1 + 1j), np.full(3, "2020-01-01", dtype="M8[s]"), [None] * 3,
              np.ma.array([1.0, 2.0, 3.0], mask=[1, 0, 0]), np.array([1, "2", 3], dtype=object)]


@pytest.mark.parametrize("wrong", NO_NUMBERS)
def test_what_numpy_would_make_numbers_of_is_refused(wrong):
    ball = lum.make_sphere(0.04, 2)
    for take in (lambda: lum.Scene().add_object("ball", *ball, position=wrong),
                 lambda: lum.Scene().add_object("ball", [wrong] if isinstance(wrong, list) else wrong[None], ball[1]),
                 lambda: lum.Ground(normal=wrong), lambda: lum.angle_frames(np.zeros(20), position=wrong)):
        with pytest.raises(TypeError, match="real numbers"):
            take()


def test_masked_frames_are_refused(session):
    with pytest.raises(TypeError, match="frames is a masked array"):
        session.run(np.ma.masked_array(touching_frames(1)))


@pytest.mark.parametrize("length", [0, 1e-9, 1e200])
def test_an_orientation_that_has_no_length_is_refused(length):
    with pytest.raises(ValueError, match="orientation is no quaternion"):
        lum.Scene().add_object("ball", *lum.make_sphere(0.04, 2), orientation=(0, 0, length, length))


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


@pytest.mark.parametrize("name, wrong, error, takes", [
    ("effort", -1, ValueError, "a whole number"), ("effort", 1.5, TypeError, "a whole number"),
    ("effort", None, TypeError, "a whole number"), ("max_candidates", 2**32, ValueError, "a whole number"),
    ("stiffness", "x", TypeError, "a number"), ("pad_damping", None, TypeError, "a number"),
    ("ground", 1, TypeError, "a Ground or None"), ("law", 5, TypeError, "a string"),
    ("felt_once", None, TypeError, "a string"), ("laws", "field", TypeError, "16 strings"),
])
def test_a_property_names_itself_and_what_it_takes(name, wrong, error, takes):
    with pytest.raises(error, match=f"^{name} takes {takes}"):
        setattr(lum.Scene(), name, wrong)


@pytest.mark.parametrize("name, wrong, error, told", [
    ("precision", [0, 1e-3], ValueError, r"precision is not of shape \(16\)"),
    ("precision", "1e-3", TypeError, "precision is not an array of real numbers"),
    ("precision", np.nan, ValueError, "precision holds a number that is not finite"),
    ("gravity", -9.81, ValueError, r"gravity is not of shape \(3\)"), ("radii", None, TypeError, "radii is None"),
    ("laws", ["field"], ValueError, "give 16, one for each segment"),
    ("laws", ["hard"] * 16, ValueError, "no law: field, column"),
])
def test_numbers_that_do_not_fit_a_view_are_refused(name, wrong, error, told):
    scene = lum.Scene()
    before = np.array(getattr(scene, name))
    with pytest.raises(error, match=told):
        setattr(scene, name, wrong)
    assert (before == getattr(scene, name)).all()


@pytest.mark.parametrize("asked, name", [({"first": -5}, "first"), ({"last": -1}, "last"), ({"step": -1}, "step")])
def test_a_tick_before_the_first_is_refused_in_a_sentence(session, tmp_path, asked, name):
    path = str(tmp_path / "few.mcap")
    session.record(path)
    session.run(touching_frames(10))
    session.stop_recording()
    with lum.Recording(path) as recording:
        for read in (recording.read, recording.read_objects, recording.read_given):
            with pytest.raises(ValueError, match=f"^{name} takes a whole number, 0 or more"):
                read(**asked)
        with pytest.raises(TypeError, match="^first takes a whole number"):
            recording.read("x")
        assert len(recording.read(np.int64(2), np.int64(8), 2)) == 3


def test_a_state_of_another_kind_is_refused_by_name(session):
    with pytest.raises(TypeError, match="^state takes a State"):
        session.state = 5


def test_words_that_are_none_are_told_with_those_that_are():
    with pytest.raises(ValueError, match="no law: field, column, max-depth, centroid or point"):
        lum.Scene().law = "x"
    with pytest.raises(ValueError, match="no felt_once: never, by-samples or always"):
        lum.Scene().felt_once = "x"
    with pytest.raises(ValueError, match="no instruction set: auto, scalar"):
        lum.Model(ball_scene(), isa="x")


@pytest.mark.parametrize("name", ["friction", "kinetic_friction", "viscosity", "shear_stiffness"])
@pytest.mark.parametrize("wrong", [np.nan, -1.0])
def test_a_material_that_makes_no_sense_is_refused(name, wrong):
    scene = lum.Scene()
    scene.add_object("ball", *lum.make_sphere(0.01, 2), **{name: wrong})
    with pytest.raises(ValueError, match="out of range"):
        lum.Model(scene)


@pytest.mark.parametrize("moves", ["fixed", "given", "free", "ball"])
@pytest.mark.parametrize("name", ["spring", "rest", "lower", "upper", "dry_friction", "detent_force", "detent_pitch"])
def test_what_does_not_act_on_what_moves_so_is_refused(moves, name):
    scene = lum.Scene()
    mass = {"mass": 1} if moves in ("free", "ball") else {}
    scene.add_object("ball", *lum.make_sphere(0.01, 2), moves=moves, **mass, **{name: -0.5 if name == "lower" else 0.5})
    with pytest.raises(ValueError, match=f"{name} acts on a hinge or slider only, and this is \"{moves}\""):
        lum.Model(scene)


@pytest.mark.parametrize("moves", ["fixed", "given", "free"])
def test_a_pivot_of_what_does_not_turn_is_refused(moves):
    mass = {"mass": 1} if moves == "free" else {}
    with pytest.raises(ValueError, match=f"pivot acts on a hinge, slider or ball only, and this is \"{moves}\""):
        lum.Scene().add_object("ball", *lum.make_sphere(0.01, 2), moves=moves, pivot=(0, 0, 0), **mass)


def test_a_latch_without_a_handle_is_refused():
    with pytest.raises(ValueError, match="latch_opens acts on a latch only: give latch_object"):
        lum.Scene().add_object("door", *lum.make_sphere(0.01, 2), moves="hinge", mass=1, latch_opens=0.5)


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


def test_a_path_that_is_no_utf_8_is_told_as_python_has_it(tmp_path, session):
    path = os.fsencode(tmp_path) + b"/t\xffch.mcap"
    session.record(path)
    session.run(touching_frames(5))
    session.stop_recording()
    with lum.Recording(path) as recording:
        assert os.fsencode(recording.info["path"]) == path
    for take in (lum.Recording, lum.replay, lum.what_if, lum.Scene.load):
        with pytest.raises(ValueError, match="gone\udcff"):
            take(os.fsencode(tmp_path) + b"/gone\xff")


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
    lambda: lum.Session(lum.Model.__new__(lum.Model)), lambda: lum.Batch(lum.Model.__new__(lum.Model), 1),
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


def test_nothing_is_read_from_standard_input():
    for read in (lum.Scene.load, lambda path: lum.load_mesh(path, "m")):
        with pytest.raises(ValueError, match="standard input"):
            read("-")


@pytest.mark.parametrize("rate", [float("inf"), float("nan"), -1.0, 1e9])
def test_frames_at_a_rate_out_of_range_are_refused(rate):
    scene = lum.Scene.load(os.path.join(os.environ["LUMBRICAL_SOURCE_DIR"], "examples/demo.json"))
    scene.rate = rate
    with pytest.raises(ValueError, match="rate is out of range"):
        scene.frames()


def test_a_recording_begins_with_the_first_tick(tmp_path, session):
    session.run(touching_frames(3))
    with pytest.raises(RuntimeError, match="first tick"):
        session.record(str(tmp_path / "late.mcap"))
    with pytest.raises(RuntimeError, match="not recorded"):
        session.stop_recording()


@pytest.mark.parametrize("part", [1, 2, 3])
def test_a_texture_of_other_types_is_a_type_error(part):
    grip = [np.ones((2, 2)), 0.1, 0, 1]
    grip[part] = "x"
    with pytest.raises(TypeError, match="grip takes"):
        lum.Scene().add_object("ball", *lum.make_sphere(0.01, 2), friction=0.5, grip=tuple(grip))


def interrupted(call):
    """How long `call` went on after Ctrl-C [s]."""
    pressed = []

    def press():
        pressed.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.2, press)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        call()
    timer.join()
    return time.monotonic() - pressed[0]


def test_ctrl_c_ends_long_calls(tmp_path, session):
    path = tmp_path / "long.mcap"
    session.record(path)
    frames = np.repeat(touching_frames(61)[-1:], 200_000)
    interrupted(lambda: session.run(frames))
    done = session.state.tick
    assert 0 < done < len(frames), "between two ticks"
    while session.state.tick < 20_000:
        session.run(frames[:5000])
    assert session.stop_recording() == session.state.tick
    began = time.monotonic()
    lum.replay(path)
    whole = time.monotonic() - began
    for call in (lum.replay, lambda path: lum.what_if(path, stiffness=1e7)):
        assert interrupted(lambda: call(path)) < 0.5 * whole
    assert lum.Session(lum.Model(ball_scene())).run(frames[:3]).shape == (3,)


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
