"""Lumbrical: what a whole human hand feels in a world of triangles, at haptic rates.

Everything that comes in numbers is a NumPy array over the engine's own memory: structured arrays with the engine's names
(frame_dtype, output_dtype, contact_dtype, ...), so that out["segment"]["force"] is a view of shape (n, 16, 3). Units are
metres, newtons, seconds, radians. Quaternions are w x y z, those of tracked joints x y z w as OpenXR has them.
"""
import numpy as _np

from ._lumbrical import (
    Batch, Ground, Model, Recording, Scene, Session, State, contact_dtype, core_count, frame_dtype, joint_names,
    load_mesh, make_box, make_mug, make_plane, make_sphere, object_dtype, output_dtype, pose_dtype, probe, probe_dtype,
    replay, segment_names, tick_dtype, what_if, wrench_dtype)
from ._lumbrical import __version__

ALL_JOINTS = (1 << 26) - 1
TRACKING_LOST = 1


def _numbers(name, array):
    """As NumPy has them, but no text, dates or complex numbers, and nothing masked, which it would take for numbers."""
    array = _np.asanyarray(array)
    if array.dtype.kind not in "biuf" or isinstance(array, _np.ma.MaskedArray):
        raise TypeError(f"{name} is not an array of real numbers, with none of them masked")
    return array


def _finite(name, array, shape, dtype=_np.float64):
    array = _numbers(name, array)
    if array.shape[-len(shape):] != shape or array.ndim > len(shape) + 1:
        raise ValueError(f"{name} is not of shape {shape} or (n, {', '.join(map(str, shape))})")
    with _np.errstate(over="ignore"):
        array = array.astype(dtype)
    if not _np.isfinite(array).all():
        raise ValueError(f"{name} holds a number that is not finite, or too large for {_np.dtype(dtype)}")
    return array.reshape((-1,) + shape)


def _mask(valid):
    if isinstance(valid, int) and not isinstance(valid, bool) and not 0 <= valid <= ALL_JOINTS:
        raise ValueError(f"valid is {valid}: there are 26 joints, with a bit each, 0 to ALL_JOINTS")
    valid = _np.asanyarray(valid)
    if valid.dtype.kind not in "iu" or isinstance(valid, _np.ma.MaskedArray):
        raise TypeError("valid is a whole number, with a bit for each joint that is tracked")
    if valid.ndim > 1:
        raise ValueError("valid is not of shape () or (n,)")
    if ((valid < 0) | (valid > ALL_JOINTS)).any():
        raise ValueError("valid holds bits of no joint: there are 26, 0 to ALL_JOINTS")
    return valid.reshape(-1)


def _frames(count, kind, position, orientation, *, flags=0):
    frames = _np.zeros(count, dtype=frame_dtype)
    frames["kind"] = kind
    frames["flags"] = flags
    frames["valid"] = ALL_JOINTS
    frames["joint"]["orientation"][..., 3] = 1
    frames["base"]["position"] = _finite("position", position, (3,))
    frames["base"]["orientation"] = _finite("orientation", orientation, (4,))
    return frames


def _count(**arrays):
    counts = {len(array) for array in arrays.values()} - {1}
    if len(counts) > 1:
        raise ValueError(f"{' and '.join(arrays)} have different lengths: {sorted(counts)}")
    return counts.pop() if counts else 1


def angle_frames(angles, position=(0, 0, 0), orientation=(1, 0, 0, 0)):
    """Frames of joint angles [rad] (n, 20) and the wrist in the world; position (n, 3) and orientation w x y z (n, 4) may
    be one for all."""
    angles = _finite("angles", angles, (20,), _np.float32)
    position, orientation = _finite("position", position, (3,)), _finite("orientation", orientation, (4,))
    frames = _frames(_count(angles=angles, position=position, orientation=orientation), 1, position, orientation)
    frames["angle"] = angles
    return frames


def pose_frames(positions, orientations, valid=ALL_JOINTS, position=(0, 0, 0), orientation=(1, 0, 0, 0)):
    """Frames of joint poses in OpenXR's order: positions [m] (n, 26, 3), orientations x y z w (n, 26, 4), and which joints
    are tracked, a bit each, (n,) or one for all; position and orientation w x y z place the tracker in the world."""
    positions = _finite("positions", positions, (26, 3), _np.float32)
    orientations = _finite("orientations", orientations, (26, 4), _np.float32)
    valid = _mask(valid)
    position, orientation = _finite("position", position, (3,)), _finite("orientation", orientation, (4,))
    count = _count(positions=positions, orientations=orientations, valid=valid, position=position,
                   orientation=orientation)
    frames = _frames(count, 0, position, orientation)
    frames["joint"]["position"] = positions
    frames["joint"]["orientation"] = orientations
    frames["valid"] = valid
    return frames


def hand_force(outputs):
    """[N] (..., 3): the sum over the hand's segments."""
    return outputs["segment"]["force"].sum(axis=-2)


__all__ = [name for name in dir() if not name.startswith("_")]
