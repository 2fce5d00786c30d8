"""Recordings that only the command line makes: of two hands, and of a world in a file of its own."""
import os
import subprocess

import numpy as np
import pytest

import lumbrical as lum

EXAMPLES = os.path.join(os.environ.get("LUMBRICAL_SOURCE_DIR", "."), "examples")
PROGRAM = os.environ.get("LUMBRICAL_PROGRAM", "")
pytestmark = pytest.mark.skipif(not os.path.exists(PROGRAM), reason="LUMBRICAL_PROGRAM names no program")


def run(folder, *arguments):
    subprocess.run([PROGRAM, *map(str, arguments)], cwd=folder, check=True, capture_output=True)


def test_what_if_is_asked_of_one_hand_of_two(tmp_path):
    run(tmp_path, "run", os.path.join(EXAMPLES, "two_hands.json"), "--record", "two.mcap")
    path = tmp_path / "two.mcap"
    assert lum.replay(path)["identical"]
    with pytest.raises(ValueError, match="two.mcap: holds two hands.*side="):
        lum.what_if(path, stiffness=1e7)
    with pytest.raises(ValueError, match="side is neither"):
        lum.what_if(path, stiffness=1e7, side="both")
    left, right = (lum.what_if(path, stiffness=1e7, side=side) for side in ("left", "right"))
    assert left["ticks"] == right["ticks"] > 0
    assert not np.array_equal(left["force"]["max"], right["force"]["max"])


def test_a_world_file_that_has_moved_is_named(tmp_path):
    run(tmp_path, "world", os.path.join(EXAMPLES, "demo.json"), "-o", "demo.world")
    (tmp_path / "scene.json").write_text('{"world": "demo.world", "motion": {"grasp": {"seconds": 0.5}}}')
    run(tmp_path, "run", "scene.json", "--record", "session.mcap")
    path, moved = tmp_path / "session.mcap", tmp_path / "elsewhere" / "demo.world"
    moved.parent.mkdir()
    os.rename(tmp_path / "demo.world", moved)
    for ask in (lum.replay, lambda path, **world: lum.what_if(path, stiffness=1e7, **world),
                lambda path, **world: lum.Recording(path).model(**world)):
        with pytest.raises(ValueError, match="demo.world"):
            ask(path)
        ask(path, world=moved)
    assert lum.replay(path, world=str(moved))["identical"]
