# Types of the module; what things mean stands beside them.
import os
from types import TracebackType
from typing import Any, Mapping, Optional, Sequence, Tuple, Type, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
ALL_JOINTS: int
TRACKING_LOST: int
joint_names: Tuple[str, ...]
segment_names: Tuple[str, ...]

# The engine's structs. Fields: see `lumbrical.output_dtype.names`, and device.h, tick.h, contact.h for units and frames.
pose_dtype: np.dtype[np.void]
wrench_dtype: np.dtype[np.void]
frame_dtype: np.dtype[np.void]
output_dtype: np.dtype[np.void]
contact_dtype: np.dtype[np.void]
object_dtype: np.dtype[np.void]
tick_dtype: np.dtype[np.void]
probe_dtype: np.dtype[np.void]

Path = Union[str, bytes, os.PathLike[str], os.PathLike[bytes]]
Mesh = Tuple[NDArray[np.float64], NDArray[np.uint32]]  # vertices (n, 3) [m], triangles (m, 3)

def load_mesh(path: Path, unit: str) -> Mesh: ...  # unit of the file's numbers: "m", "cm" or "mm"
def make_mug(radius: float = ..., height: float = ..., wall: float = ..., segments: int = ...) -> Mesh: ...
def make_plane(extent: float, cells: int) -> Mesh: ...
def make_box(size: ArrayLike, cells: int) -> Mesh: ...
def make_sphere(radius: float, cells: int) -> Mesh: ...

# Of dtype probe_dtype. Rows: spheres x y z r; capsules x y z r of both ends; cylinders two ends and r.
def probe(vertices: ArrayLike, triangles: ArrayLike, spheres: Optional[ArrayLike] = ...,
          capsules: Optional[ArrayLike] = ..., cylinders: Optional[ArrayLike] = ..., law: str = ...,
          stiffness: float = ...) -> NDArray[np.void]: ...

def angle_frames(angles: ArrayLike, position: ArrayLike = ..., orientation: ArrayLike = ...) -> NDArray[np.void]: ...
def pose_frames(positions: ArrayLike, orientations: ArrayLike, valid: Union[int, ArrayLike] = ...,
                position: ArrayLike = ..., orientation: ArrayLike = ...) -> NDArray[np.void]: ...
def hand_force(outputs: NDArray[np.void]) -> NDArray[np.float64]: ...
def core_count() -> int: ...

# A plane that free objects rest on, normal . p = offset; the hand does not feel it.
class Ground:
    def __init__(self, *, normal: ArrayLike = ..., offset: float = ..., friction: float = ...) -> None: ...
    @property
    def normal(self) -> Tuple[float, float, float]: ...  # unit, away from the ground
    @property
    def offset(self) -> float: ...  # [m]
    @property
    def friction(self) -> float: ...  # 0 .. 10

# What is touched, by which hand, and how forces are computed.
class Scene:
    stiffness: float  # [N/m^3]
    rate: float  # [Hz]
    point_area: float  # [m^2]
    max_force: float  # [N]
    fade_time: float  # [s]
    proxy_stiffness: float  # [N/m]; 0: no proxy
    pad_damping: float  # [s/m]; 0: none
    felt_once: str  # "never", "by-samples" or "always"
    effort: int
    max_candidates: int
    law: Optional[str]  # of every segment; None where they follow different ones. Set one for all
    laws: Sequence[str]  # of each of the 16; set all of them together
    ground: Optional[Ground]  # None: free objects fall for ever
    def __init__(self, side: str = ..., hand_length: float = ...) -> None: ...
    @staticmethod
    def load(path: Path) -> Scene: ...  # one of two hands, with paths of given objects or physics is refused
    def add_object(self, name: str, vertices: ArrayLike, triangles: ArrayLike, *, position: ArrayLike = ...,
                   orientation: ArrayLike = ..., winding: str = ..., friction: float = ...,
                   kinetic_friction: Optional[float] = ..., viscosity: float = ..., shear_stiffness: float = ...,
                   moves: str = ..., density: float = ..., mass: float = ..., damping: float = ...,
                   pivot: Optional[ArrayLike] = ..., axis: ArrayLike = ..., lower: float = ..., upper: float = ...,
                   spring: float = ..., rest: float = ..., dry_friction: float = ..., detent_force: float = ...,
                   detent_pitch: float = ..., latch_object: Optional[int] = ..., latch_opens: float = ...,
                   crease_angle: float = ..., friction_factors: Optional[ArrayLike] = ...,
                   grip: Optional[Tuple[ArrayLike, float, float, float]] = ...,  # image of 0 .. 1, period, black, white
                   bumps: Optional[Tuple[ArrayLike, float, float, float]] = ...) -> None: ...
    def frames(self) -> NDArray[np.void]: ...  # the scene file's motion, a frame per tick
    # The palm of a frame of pose_frames in which all joints are tracked, and radii (26,) [m], 0 where unknown. A frame
    # that shows no hand, lost or with all joints in one point, is a ValueError, and nothing is changed.
    def fit_hand(self, frame: Union[NDArray[np.void], np.void], radii: Optional[ArrayLike] = ...) -> None: ...
    # Views to write into, or to be set: to as many numbers, precision to one for all segments, too.
    # precision: (16,), of the hand's force; 0 is exact. Exact segments feel by themselves what several of them hold
    # together (2 to 6 % of the force, 20 to 40 where fingers meet): compare with felt_once = "always".
    @property
    def precision(self) -> NDArray[np.float64]: ...
    @precision.setter
    def precision(self, numbers: ArrayLike) -> None: ...
    @property
    def pad_layers(self) -> NDArray[np.float64]: ...  # (2, 2): from, stiffness
    @pad_layers.setter
    def pad_layers(self, numbers: ArrayLike) -> None: ...
    @property
    def radii(self) -> NDArray[np.float64]: ...  # (26,) [m]
    @radii.setter
    def radii(self, numbers: ArrayLike) -> None: ...
    @property
    def gravity(self) -> NDArray[np.float64]: ...  # (3,) [m/s^2]
    @gravity.setter
    def gravity(self, numbers: ArrayLike) -> None: ...
    @property
    def side(self) -> str: ...

# A scene built for ticks: immutable, for any number of sessions and threads.
class Model:
    def __init__(self, scene: Scene, *, threads: Optional[int] = ..., broadphase: Optional[str] = ...,
                 isa: str = ...) -> None: ...
    def share(self, scene: Scene) -> Model: ...  # this world for another hand, that of `scene`
    @property
    def vertices(self) -> Tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...  # x, y, z: views
    @property
    def triangles(self) -> Tuple[NDArray[np.uint32], NDArray[np.uint32], NDArray[np.uint32]]: ...
    @property
    def object_names(self) -> Sequence[str]: ...  # of the world first, then of those felt apart
    @property
    def rate(self) -> float: ...
    @property
    def side(self) -> str: ...

# What one tick leaves for the next.
class State:
    @property
    def tick(self) -> int: ...
    @property
    def hash(self) -> int: ...

# One hand in the world of a model, tick by tick.
class Session:
    state: State  # a copy; set it to go back
    def __init__(self, model: Model) -> None: ...
    # An output, of output_dtype, for each frame, of frame_dtype.
    # given: of pose_dtype, (frames, given objects), in the order in which they were added; (given objects,) for one
    # frame, (frames,) for one object.
    def tick(self, frame: Union[NDArray[np.void], np.void],
             given: Optional[Union[NDArray[np.void], np.void]] = ...) -> NDArray[np.void]: ...
    def run(self, frames: NDArray[np.void], given: Optional[NDArray[np.void]] = ...) -> NDArray[np.void]: ...
    # Of contact_dtype, in W, of the last tick: "object" counts in Model.object_names. A contact's "force" is the pressure
    # on its triangle alone: friction, bumps, pads' layers and damping are in outputs, and limits and fading besides.
    def contacts(self) -> NDArray[np.void]: ...
    def jacobians(self, segments: int = ...) -> Tuple[NDArray[np.float64], NDArray[np.bool_]]: ...
    @property
    def objects(self) -> NDArray[np.void]: ...  # a view that the next tick writes over
    @property
    def joints(self) -> NDArray[np.void]: ...  # likewise
    def record(self, path: Path, *, force_interval: int = ...) -> None: ...
    def stop_recording(self) -> int: ...

# Many hands that have nothing to do with each other, in the world of a model.
class Batch:
    def __init__(self, model: Model, count: int) -> None: ...
    def tick(self, frames: NDArray[np.void], threads: int = ...) -> NDArray[np.void]: ...  # threads 0: all cores
    def __len__(self) -> int: ...

# A recorded session; of one of two hands, side says which.
class Recording:
    def __init__(self, path: Path, side: Optional[str] = ...) -> None: ...
    @property
    def info(self) -> Mapping[str, Any]: ...
    def read(self, first: int = ..., last: Optional[int] = ..., step: int = ...) -> NDArray[np.void]: ...
    # (ticks, objects felt apart) of object_dtype.
    def read_objects(self, first: int = ..., last: Optional[int] = ..., step: int = ...) -> NDArray[np.void]: ...
    # (ticks, given objects) of pose_dtype: what Session.run takes with the frames of the same ticks, to the same bits.
    def read_given(self, first: int = ..., last: Optional[int] = ..., step: int = ...) -> NDArray[np.void]: ...
    # world, here and below: the world file, where the recording names one that is not beside it.
    def model(self, *, world: Optional[Path] = ..., threads: int = ..., broadphase: str = ...) -> Model: ...
    def close(self) -> None: ...
    def __enter__(self) -> Recording: ...
    def __exit__(self, kind: Optional[Type[BaseException]], value: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None: ...

# "damage" says what is wrong with the file, whatever "identical" says of the ticks that can be read; None: nothing.
def replay(path: Path, *, world: Optional[Path] = ..., threads: int = ...,
           broadphase: str = ...) -> Mapping[str, Any]: ...
# Of one hand: a session of two has none to answer for both, so side says which, "left" or "right".
def what_if(path: Path, *, stiffness: Optional[float] = ..., law: Optional[str] = ..., precision: Optional[float] = ...,
            side: Optional[str] = ..., world: Optional[Path] = ..., threads: int = ...) -> Mapping[str, Any]: ...
