"""A ball, and a hand that comes down over it."""
import numpy as np

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
