/* Lumbrical for C and whatever calls C: C#, Rust, Godot, Julia. C99; one shared library, liblumbrical.so.
 *
 *   lumbrical_scene    what is put together: hand, objects, settings
 *   lumbrical_model    built from it, immutable; any number of sessions and threads may share one
 *   lumbrical_session  a hand that is ticked on a model
 *   lumbrical_reader   a recording that is read
 *
 * Every function that can fail returns a lumbrical_status; lumbrical_message() then says what is wrong and
 * what to do, on the thread that called, until its next call that fails. No exception, signal or exit crosses
 * this line, but for SIGBUS where a scene names a world file and someone cuts that while it is in use. A null
 * handle, a handle of another kind, a struct of another size and a number that is no value of its enumeration
 * are errors; on error outputs are left alone unless said otherwise. A handle that was destroyed must not be
 * used again.
 *
 * Every struct begins with its size, which the caller sets (`frame.size = sizeof frame`, or the function
 * ..._init); in an array only the first element's size is read. Poses, wrenches and joints are plain numbers
 * and never change.
 *
 * A handle is used by one thread at a time; a second one that comes in between gets LUMBRICAL_BUSY, and one
 * that would destroy it, too: then it is there as before. Models are only read, by as many as like; destroy
 * one when no thread is in a call with it. Destroying null is no error. lumbrical_session_tick allocates
 * nothing, but for recording and once after a change of it.
 *
 * Units are metres, newtons, seconds, radians. The world W is right-handed. Quaternions are x y z w. Which
 * way is down only matters to objects that move by themselves (lumbrical_settings.gravity). */
#ifndef LUMBRICAL_H
#define LUMBRICAL_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define LUMBRICAL_API __attribute__((visibility("default")))
#else
#define LUMBRICAL_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define LUMBRICAL_JOINTS 26
#define LUMBRICAL_SEGMENTS 16
#define LUMBRICAL_ANGLES 20

typedef struct lumbrical_scene lumbrical_scene;
typedef struct lumbrical_model lumbrical_model;
typedef struct lumbrical_session lumbrical_session;
typedef struct lumbrical_reader lumbrical_reader;

enum lumbrical_status {
  LUMBRICAL_OK = 0,
  LUMBRICAL_BAD_ARGUMENT = 1, /* the caller's mistake: null, wrong size, no such value, out of range */
  LUMBRICAL_BAD_DATA = 2,     /* a file, mesh or setting that is refused */
  LUMBRICAL_TOO_SMALL = 3,    /* the caller's array; the size it needs is told */
  LUMBRICAL_BUSY = 4,         /* another thread is in a call with this handle */
  LUMBRICAL_NOT_RECORDED = 5, /* the tick is done and told, but the recording has failed */
  LUMBRICAL_FAILED = 6        /* out of memory, or a fault of the library */
};

enum lumbrical_side {
  LUMBRICAL_FIRST_HAND = -1, /* of a recording's: whichever that is */
  LUMBRICAL_LEFT = 0,
  LUMBRICAL_RIGHT = 1
};
enum lumbrical_law {
  LUMBRICAL_FIELD = 0,
  LUMBRICAL_COLUMN = 1,
  LUMBRICAL_MAX_DEPTH = 2,
  LUMBRICAL_CENTROID = 3,
  LUMBRICAL_POINT = 4
};
enum lumbrical_felt_once {
  LUMBRICAL_FELT_ONCE_NEVER = 0,
  LUMBRICAL_FELT_ONCE_BY_SAMPLES = 1, /* exact segments feel by themselves */
  LUMBRICAL_FELT_ONCE_ALWAYS = 2
};
enum lumbrical_mobility {
  LUMBRICAL_FIXED = 0,
  LUMBRICAL_GIVEN = 1, /* goes where each tick is told that it is */
  LUMBRICAL_FREE = 2,
  LUMBRICAL_HINGE = 3,
  LUMBRICAL_SLIDER = 4,
  LUMBRICAL_BALL = 5
};
enum lumbrical_unit { LUMBRICAL_METRE = 0, LUMBRICAL_CENTIMETRE = 1, LUMBRICAL_MILLIMETRE = 2 };
enum lumbrical_winding {
  LUMBRICAL_WINDING_AUTOMATIC = 0,
  LUMBRICAL_WINDING_AS_IS = 1,
  LUMBRICAL_WINDING_FLIP = 2
};
enum lumbrical_broadphase {
  LUMBRICAL_SEARCH_AUTOMATIC = 0,
  LUMBRICAL_SEARCH_TREE = 1,
  LUMBRICAL_SEARCH_GRID = 2,
  LUMBRICAL_SEARCH_VOXEL = 3,
  LUMBRICAL_SEARCH_BRUTE = 4
};
enum lumbrical_input { LUMBRICAL_JOINT_POSES = 0, LUMBRICAL_JOINT_ANGLES = 1 };

/* Whose axes and unit of length. OpenXR's are right-handed, x right, y up, -z ahead, metres; Unity's
 * left-handed, x right, y up, z ahead, metres; Unreal's left-handed, x ahead, y right, z up, centimetres. */
enum lumbrical_convention { LUMBRICAL_OPENXR = 0, LUMBRICAL_UNITY = 1, LUMBRICAL_UNREAL = 2 };
enum lumbrical_quantity {
  LUMBRICAL_POSITION = 0,  /* has a unit of length */
  LUMBRICAL_DIRECTION = 1, /* a force, a normal: newtons stay newtons */
  LUMBRICAL_ROTATION = 2   /* a torque, an angular velocity: newton metres stay newton metres */
};

/* Bits of lumbrical_frame.flags, and those of lumbrical_output.flags; remedies are in lumbrical/device.h. */
enum lumbrical_frame_flag { LUMBRICAL_TRACKING_LOST = 1, LUMBRICAL_EXTRAPOLATED = 2 };
enum lumbrical_output_flag {
  LUMBRICAL_INPUT_NOT_FINITE = 1,
  LUMBRICAL_INPUT_IMPLAUSIBLE = 2,
  LUMBRICAL_INPUT_LOST = 4,
  LUMBRICAL_INPUT_EXTRAPOLATED = 8,
  LUMBRICAL_SEGMENT_MISSING = 16,
  LUMBRICAL_SEGMENT_DEGENERATE = 32,
  LUMBRICAL_ANGLE_CLAMPED = 64,
  LUMBRICAL_CANDIDATE_OVERFLOW = 128,
  LUMBRICAL_FORCE_LIMITED = 256,
  LUMBRICAL_FADING = 512,
  LUMBRICAL_COARSENED = 1024,
  LUMBRICAL_OBJECT_MISSING = 2048,
  LUMBRICAL_OBJECT_IMPLAUSIBLE = 4096,
  LUMBRICAL_MEMORY_FOREIGN = 8192, /* never here: a handle has its own memory */
  LUMBRICAL_HAND_JUMPED = 16384
};

typedef struct lumbrical_pose {
  double position[3];    /* [m] */
  double orientation[4]; /* x y z w */
} lumbrical_pose;

typedef struct lumbrical_wrench {
  double force[3];  /* [N] */
  double torque[3]; /* [N m] */
} lumbrical_wrench;

typedef struct lumbrical_joint {
  float position[3];    /* [m] */
  float orientation[4]; /* x y z w: -z along the bone to the tip, y to the back of the hand */
} lumbrical_joint;

/* A grey image repeated without end in the planes of the object's axes (OPENXR's, whatever the convention):
 * its lower left corner is at the origin, and it goes right along x, or y where it is seen along x, and up
 * along z, or y where it is seen along z. */
typedef struct lumbrical_texture {
  const uint16_t* grey; /* rows from the top, 0 .. 65535; null: there is none */
  uint32_t width, height;
  double period;       /* [m] of the image's width, 1e-6 .. 10 */
  double black, white; /* what its darkest and its brightest grey stand for */
} lumbrical_texture;

/* What is touched. Its mesh: either `mesh_file`, whose polygons are cut into triangles and which may not be
 * "-", or one of the two vertex arrays with triangles. What does not act on what moves so is left as
 * lumbrical_object_init sets it, or refused. */
typedef struct lumbrical_object {
  uint32_t size;
  int32_t mobility; /* FIXED */
  int32_t
      convention; /* OPENXR: of vertices, pose, pivot and axis. Which way triangles go round stays as it is */
  int32_t unit;   /* METRE: of mesh_file's numbers, and of nothing else */
  int32_t winding;  /* AUTOMATIC: closed parts are turned outside out, however they are wound */
  int32_t reserved; /* 0 */
  const char* name; /* "" */
  const char* mesh_file;
  const double* vertices;      /* x y z of each */
  const float* float_vertices; /* in the place of vertices */
  size_t vertex_count;
  const uint32_t* triangles; /* three vertices of each */
  size_t triangle_count;
  lumbrical_pose pose;     /* of the mesh in W, at the start */
  double static_friction;  /* 0 .. 10, between skin and it: 0 */
  double kinetic_friction; /* 0 .. static_friction, or -1: that. -1 */
  double viscosity;        /* [s/m] 0 .. 100: 0 */
  double shear_stiffness;  /* [N/m] 1 .. 1e6: 1000 */
  /* ---- of what moves by itself, and where one likes of GIVEN; the mesh must be closed */
  double density; /* [kg/m^3] of the solid inside the mesh, 0.001 .. 1e5; or */
  double mass;    /* [kg] of all of it, 1e-6 .. 1e6 */
  double damping; /* [N s/m], [N m s/rad] 0 .. 1e6, not of GIVEN: 0 */
  /* ---- of HINGE, SLIDER and BALL */
  double pivot[3]; /* [m] in W, at the start; not by itself the object's position: 0 0 0 */
  /* ---- of HINGE and SLIDER; the coordinate is the hinge's angle or the slider's way from the start */
  double axis[3];      /* unit, in W: 0 0 1 */
  double lower, upper; /* of the coordinate, -1000 .. 0 and 0 .. 1000: -1000, 1000 */
  double spring, rest; /* [N/m], [N m/rad] 0 .. 1e9, and where it is slack, -1000 .. 1000: 0, 0 */
  double dry_friction; /* [N], [N m] 0 .. 1e6: 0 */
  double detent_force; /* [N], [N m] 0 .. 1e6: 0 */
  double detent_pitch; /* from one detent to the next, 1e-6 .. 1000: 0.1 */
  int32_t has_latch; /* 0, and so the next two; else of HINGE and SLIDER: the coordinate stays at 0 and below
                        until ... */
  uint32_t latch_object; /* ... this other HINGE or SLIDER, in the order they are added, ... */
  double latch_opens;    /* ... has this coordinate, 1e-9 .. 1000 */
  /* ---- how it feels beside its shape */
  double crease_angle;            /* [rad] 0 .. pi, triangles that meet at less are felt as round: 0, none */
  const double* friction_factors; /* 0 .. 10, of all triangle_count, also of a mesh_file's; null: 1 */
  lumbrical_texture grip;         /* friction factor, too, 0 .. 10 */
  lumbrical_texture bumps;        /* [m] height, -1 .. 1: its slope tilts the force */
} lumbrical_object;

/* What decides results, besides hand and objects. */
typedef struct lumbrical_settings {
  uint32_t size;
  uint32_t effort;                      /* 0 .. 1e9, 0: as much as it takes; one cell a patch is the least */
  uint32_t max_candidates;              /* 1 .. 16777216: 262144 */
  int32_t has_ground;                   /* 0: free objects fall for ever */
  int32_t law[LUMBRICAL_SEGMENTS];      /* FIELD */
  double precision[LUMBRICAL_SEGMENTS]; /* 0 exact, its finger too, or 1e-6 .. 0.1 of the force: 1e-4 */
  double stiffness;                     /* [N/m^3] 0.001 .. 1e15: 2e7 */
  double rate;                          /* [Hz] ticks per second of session time, 1 .. 100000: 1000 */
  double point_area;                    /* [m^2] of POINT, 1e-12 .. 1: 1e-4 */
  double max_force;                     /* [N] of a segment, 0 .. 1e6: 20 */
  double fade_time;                     /* [s] 0 .. 60: 0.02 */
  double proxy_stiffness;  /* [N/m] to a hand that surfaces hold, 10 .. 1e5; 0: there is none. 0 */
  double pad_from[2];      /* share of the radius, 0.01 .. 0.99, the shallower first: 0 */
  double pad_stiffness[2]; /* times `stiffness` that skin is harder beyond, -1000 .. 1000; 0: no layer. 0 */
  double pad_damping;      /* [s/m] 0 .. 1000: 0 */
  double gravity[3];       /* [m/s^2] W: 0 0 -9.81 */
  double ground_normal[3]; /* unit, away from it: 0 0 1 */
  double ground_offset;    /* [m] ground_normal . p = ground_offset on it: 0 */
  double ground_friction;  /* 0 .. 10: 0.5 */
  int32_t felt_once; /* what several fingers, or fingers and palm, hold together is felt by the deepest only:
                        BY_SAMPLES; ALWAYS needs FIELD and all segments by samples, or all exact */
} lumbrical_settings;

/* How work is done; never changes a result. */
typedef struct lumbrical_execution {
  uint32_t size;
  int32_t broadphase; /* AUTOMATIC */
  uint32_t threads;   /* 1 .. 64: 1 */
  uint32_t leaf_size; /* 1 .. 64: 16 */
} lumbrical_execution;

typedef struct lumbrical_model_info {
  uint32_t size;
  int32_t side;
  uint32_t object_count; /* in the order they were added */
  uint32_t apart_count;  /* that move, rub or have a surface feel */
  uint32_t given_count;  /* of those, the GIVEN ones */
  int32_t broadphase;    /* that was chosen */
  uint64_t triangle_count;
  double rate; /* [Hz] */
} lumbrical_model_info;

/* What the device says. */
typedef struct lumbrical_frame {
  uint32_t size;
  int32_t kind;                            /* lumbrical_input: JOINT_POSES */
  uint32_t flags;                          /* lumbrical_frame_flag: 0 */
  uint32_t valid;                          /* bit j: joint j is tracked (JOINT_POSES): all */
  lumbrical_pose base;                     /* B in W. Joints are given in B; for angles B is the wrist */
  lumbrical_joint joint[LUMBRICAL_JOINTS]; /* in OpenXR's order */
  float angle[LUMBRICAL_ANGLES];           /* [rad] in the order of lumbrical/hand.h */
} lumbrical_frame;

/* What the hand feels, in W. */
typedef struct lumbrical_output {
  uint32_t size;
  uint32_t flags; /* lumbrical_output_flag */
  uint64_t tick;
  uint32_t contact_count; /* behind the forces, as they were computed: of samples, patches */
  uint32_t object_count;  /* for lumbrical_session_objects */
  uint64_t evaluations;   /* of a field, by samples: what settings.effort bounds */
  double error_estimate;  /* [N] what samples may be off by, from experience */
  double force_error;     /* [N] bound of what exact forces may be off by */
  double hand_force[3];   /* [N] sum over segments */
  lumbrical_wrench segment[LUMBRICAL_SEGMENTS]; /* torque about the joint at the segment's base */
  double joint_torque[LUMBRICAL_SEGMENTS][3];   /* [N m] about that joint, of all it carries */
  double flexion_torque[LUMBRICAL_SEGMENTS];    /* [N m] of it along the flexion axis; > 0 opens the hand */
} lumbrical_output;

/* A contacted triangle, of objects apart, too. Its force is the pressure on it alone: friction, bumps, pads'
 * layers and damping are in output.segment, in which there are limits and fading besides. */
typedef struct lumbrical_contact {
  uint32_t size;
  uint32_t segment;
  uint32_t object;    /* in the order they were added */
  uint32_t triangle;  /* of the object's mesh */
  double depth;       /* [m] */
  double area;        /* [m^2] of the triangle inside the hand */
  double centroid[3]; /* [m] W, of that area */
  double centre[3];   /* [m] W, where the force acts */
  double normal[3];   /* W, unit, out of the object */
  double force[3];    /* [N] W, on the hand, before limits */
} lumbrical_contact;

/* An object felt apart: it moves, rubs or has a surface feel. */
typedef struct lumbrical_object_output {
  uint32_t size;
  uint32_t object;         /* in the order they were added */
  lumbrical_pose pose;     /* in W, that the tick has felt it at */
  lumbrical_wrench wrench; /* of the hand on it, about its origin, in W */
  double coordinate;       /* of a hinge or slider */
} lumbrical_object_output;

typedef struct lumbrical_record_options {
  uint32_t size;
  int32_t live;            /* 0: the tick waits for a full ring; else a gap is marked in the file */
  uint32_t force_interval; /* ticks whose number is a multiple of it keep their forces; 0: none: 1 */
  uint32_t reserved;       /* 0 */
} lumbrical_record_options;

typedef struct lumbrical_recording_info {
  uint32_t size;
  int32_t complete; /* 0: its writer was killed, or is still at work */
  int32_t side;     /* of the hand that is read */
  int32_t hands;    /* in the session, 1 or 2 */
  uint64_t ticks, first_tick, last_tick, missing_ticks;
  double seconds;
} lumbrical_recording_info;

typedef struct lumbrical_replay_result {
  uint32_t size;
  int32_t identical; /* 1: every bit; else the rest says where the two part first */
  uint64_t ticks;    /* compared, of all hands together */
  uint64_t tick;
  char stage[32], field[64], recorded[64], replayed[64];
  char damage[256]; /* what is wrong with the file, whatever the replay found, without the middle of a long
                       text; empty: nothing */
} lumbrical_replay_result;

/* ---- Everywhere
 * ------------------------------------------------------------------------------------------------- */

LUMBRICAL_API const char* lumbrical_version(void); /* "0.1.0" */
/* Of this thread's last error; "" before the first. Of one above 1023 bytes the middle is left out. */
LUMBRICAL_API const char* lumbrical_message(void);
LUMBRICAL_API const char* lumbrical_joint_name(int32_t joint);     /* null: there is none */
LUMBRICAL_API const char* lumbrical_segment_name(int32_t segment); /* null: there is none */

/* Fill in the size and the defaults. */
LUMBRICAL_API int lumbrical_object_init(lumbrical_object* object);
LUMBRICAL_API int lumbrical_settings_init(lumbrical_settings* settings);
LUMBRICAL_API int lumbrical_execution_init(lumbrical_execution* execution);
LUMBRICAL_API int lumbrical_frame_init(lumbrical_frame* frame);

/* ---- Scenes
 * ----------------------------------------------------------------------------------------------------- */

/* An empty world and an adult's hand, `hand_length` [m] from wrist to middle fingertip, 0.05 .. 0.5
 * (0.19). */
LUMBRICAL_API int lumbrical_scene_create(int32_t side, double hand_length, lumbrical_scene** scene);
/* A scene file (JSON) with the meshes and the motion it names. Refuses one of two hands, with paths of given
 * objects or with physics: those are for `lumbrical run`. */
LUMBRICAL_API int lumbrical_scene_load(const char* path, lumbrical_scene** scene);
LUMBRICAL_API int lumbrical_scene_destroy(lumbrical_scene* scene);
LUMBRICAL_API int lumbrical_scene_add_object(lumbrical_scene* scene, const lumbrical_object* object);
LUMBRICAL_API int lumbrical_scene_settings(lumbrical_scene* scene, lumbrical_settings* settings);
LUMBRICAL_API int lumbrical_scene_set_settings(lumbrical_scene* scene, const lumbrical_settings* settings);
/* [m] LUMBRICAL_JOINTS distances from joint to skin, 1e-6 .. 1000. */
LUMBRICAL_API int lumbrical_scene_set_radii(lumbrical_scene* scene, const double* radii);
/* Radii (above 0) and palm from an XrHandJointLocationsEXT (see lumbrical_frame_from_openxr). Refused, and
 * nothing is changed, unless it shows the whole hand: active, every joint valid, finite, and not in one
 * point. */
LUMBRICAL_API int lumbrical_scene_fit_hand(lumbrical_scene* scene, const void* xr_hand_joint_locations);
/* Of a scene from a file: the session's length [s], and the frame of its motion at a time [s]. */
LUMBRICAL_API int lumbrical_scene_seconds(lumbrical_scene* scene, double* seconds);
LUMBRICAL_API int lumbrical_scene_frame(lumbrical_scene* scene, double time, lumbrical_frame* frame);

/* ---- Models
 * ----------------------------------------------------------------------------------------------------- */

/* `execution` may be null: the scene file's, or the defaults. The scene may be changed or destroyed
 * afterwards. */
LUMBRICAL_API int lumbrical_model_build(lumbrical_scene* scene, const lumbrical_execution* execution,
                                        lumbrical_model** model);
/* The same world for another hand, that of `hand`; what doesn't depend on the hand is shared. */
LUMBRICAL_API int lumbrical_model_share(const lumbrical_model* world, lumbrical_scene* hand,
                                        lumbrical_model** model);
/* Sessions go on: they keep what they need. */
LUMBRICAL_API int lumbrical_model_destroy(lumbrical_model* model);
LUMBRICAL_API int lumbrical_model_describe(const lumbrical_model* model, lumbrical_model_info* info);
/* Lives as long as the model. */
LUMBRICAL_API int lumbrical_model_object_name(const lumbrical_model* model, uint32_t object,
                                              const char** name);

/* ---- Sessions
 * --------------------------------------------------------------------------------------------------- */

LUMBRICAL_API int lumbrical_session_create(const lumbrical_model* model, lumbrical_session** session);
/* Ends its recording, dropping errors: lumbrical_session_stop_recording tells them. */
LUMBRICAL_API int lumbrical_session_destroy(lumbrical_session* session);
/* One tick. `given`: poses in W of the GIVEN objects in the order they were added, at most as many as there
 * are (fewer: the others stay where they were); may be null where `given_count` is 0. */
LUMBRICAL_API int lumbrical_session_tick(lumbrical_session* session, const lumbrical_frame* frame,
                                         const lumbrical_pose* given, size_t given_count,
                                         lumbrical_output* output);
/* Contacts of the last tick, computed now: takes as long as an exact tick. Those of objects apart come last,
 * where the tick has felt them. `count` is how many there are; more than `capacity` are LUMBRICAL_TOO_SMALL.
 * `contacts` may be null where `capacity` is 0. */
LUMBRICAL_API int lumbrical_session_contacts(lumbrical_session* session, lumbrical_contact* contacts,
                                             size_t capacity, size_t* count);
/* The objects felt apart, in the order they were added; else likewise. */
LUMBRICAL_API int lumbrical_session_objects(lumbrical_session* session, lumbrical_object_output* objects,
                                            size_t capacity, size_t* count);
/* Joint poses in W of the last tick whose frame could be trusted: LUMBRICAL_JOINTS of them. */
LUMBRICAL_API int lumbrical_session_joints(lumbrical_session* session, lumbrical_pose* joints);
/* How the wrench of each segment changes as the segment moves: `values` are LUMBRICAL_SEGMENTS matrices of 6
 * rows (force, torque) by 6 columns (translation, rotation), of the segments whose bit is set in `segments`,
 * 0 for others; `known` has the bits of those that could be computed. About 30 us for each exact contact. */
LUMBRICAL_API int lumbrical_session_jacobians(lumbrical_session* session, uint32_t segments, double* values,
                                              uint32_t* known);
/* All that survives from one tick to the next, as bytes: for rollback, here or on another machine. `size` is
 * how many there are, the same from a session's first tick on. `bytes` may be null where `capacity` is 0. */
LUMBRICAL_API int lumbrical_session_save(lumbrical_session* session, void* bytes, size_t capacity,
                                         size_t* size);
/* Refuses bytes that are damaged, or of another model as far as they tell: with more or fewer objects that
 * are felt apart, with one where its mobility and its start don't let it be, or with a proxy where there is
 * none. Meshes and settings are not in them. Of forces above settings.max_force, which other settings have
 * left, no more than that is let out. Not while the session is recorded. */
LUMBRICAL_API int lumbrical_session_restore(lumbrical_session* session, const void* bytes, size_t size);
/* Hash of the same: equal on two machines exactly if they are in lockstep. */
LUMBRICAL_API int lumbrical_session_hash(lumbrical_session* session, uint64_t* hash);
/* Every tick from the next on, which must be the session's first, into a new file (MCAP); `options` may be
 * null. */
LUMBRICAL_API int lumbrical_session_record(lumbrical_session* session, const char* path,
                                           const lumbrical_record_options* options);
/* Ends and closes it. `kept` (may be null) is how many ticks are in the file, whatever went wrong. */
LUMBRICAL_API int lumbrical_session_stop_recording(lumbrical_session* session, uint64_t* kept);

/* ---- Recordings
 * ------------------------------------------------------------------------------------------------- */

/* Runs a recording's inputs through the engine again and compares every bit, of two hands both.
 * `world` is the world file of a recording that names one; null: the one beside the recording. `execution`
 * may be null. */
LUMBRICAL_API int lumbrical_replay(const char* path, const char* world, const lumbrical_execution* execution,
                                   lumbrical_replay_result* result);
/* Opens a recording to read the hand of that side, or its first. */
LUMBRICAL_API int lumbrical_reader_open(const char* path, int32_t side, lumbrical_reader** reader);
LUMBRICAL_API int lumbrical_reader_close(lumbrical_reader* reader);
LUMBRICAL_API int lumbrical_reader_describe(lumbrical_reader* reader, lumbrical_recording_info* info);
/* The model that was recorded; sessions of it start as the recorded one did. `world` and `execution` as of
 * lumbrical_replay. */
LUMBRICAL_API int lumbrical_reader_model(lumbrical_reader* reader, const char* world,
                                         const lumbrical_execution* execution, lumbrical_model** model);
/* The next tick as recorded; forces that the recording leaves out (force_interval) are NaN. `end` is 1 where
 * there is none, and then the others are left alone; each may be null. */
LUMBRICAL_API int lumbrical_reader_next(lumbrical_reader* reader, lumbrical_frame* frame,
                                        lumbrical_output* output, int32_t* end);
/* Of the tick that lumbrical_reader_next gave last, until it gives another: as lumbrical_session_objects has
 * them. Before the first an error. */
LUMBRICAL_API int lumbrical_reader_objects(lumbrical_reader* reader, lumbrical_object_output* objects,
                                           size_t capacity, size_t* count);
/* Likewise what lumbrical_session_tick was given of GIVEN objects, which felt again gives the same bits. */
LUMBRICAL_API int lumbrical_reader_given(lumbrical_reader* reader, lumbrical_pose* given, size_t capacity,
                                         size_t* count);
/* What comes next is the first tick that is not before `tick`. */
LUMBRICAL_API int lumbrical_reader_seek(lumbrical_reader* reader, uint64_t tick);

/* ---- Frames from and for others
 * --------------------------------------------------------------------------------- */

/* From an XrHandJointLocationsEXT as OpenXR defines it, jointCount 26; its headers are not needed. With
 * 64-bit pointers `type` (1000051003) is at byte 0, `isActive` at 16, `jointCount` at 20, `jointLocations` at
 * 24 of 32; of each location `locationFlags` at 0, orientation at 8, position at 24, radius at 36 of 40.
 * Joints whose position or orientation is not valid are not tracked; not active: LUMBRICAL_TRACKING_LOST.
 * `base` and size stay as they are. */
LUMBRICAL_API int lumbrical_frame_from_openxr(const void* xr_hand_joint_locations, lumbrical_frame* frame);

/* In place. Mirroring turns triangles inside out, and W must be right-handed: convert what goes in to OPENXR,
 * what comes out from OPENXR. Orientations of joints keep their meaning. */
LUMBRICAL_API int lumbrical_convert_vectors(int32_t from, int32_t to, int32_t quantity, double* xyz,
                                            size_t count);
LUMBRICAL_API int lumbrical_convert_poses(int32_t from, int32_t to, lumbrical_pose* poses, size_t count);
LUMBRICAL_API int lumbrical_convert_frame(int32_t from, int32_t to, lumbrical_frame* frame);
LUMBRICAL_API int lumbrical_convert_output(int32_t from, int32_t to, lumbrical_output* output);
LUMBRICAL_API int lumbrical_convert_contacts(int32_t from, int32_t to, lumbrical_contact* contacts,
                                             size_t count);

#ifdef __cplusplus
}
#endif

#endif
