// Hand motions from files or generated, and the resampler that brings them to the tick rate.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lumbrical/device.h"
#include "lumbrical/hand.h"
#include "lumbrical/status.h"

namespace lumbrical {

struct MotionSample {
  double time = 0;  ///< [s] strictly increasing from 0
  DeviceFrame frame;
};

struct Motion {
  Side side = Side::right;
  std::array<double, kJointCount> radius{};  ///< [m] as the source tells them; 0 where it does not
  std::vector<MotionSample> samples;         ///< at least one; all of one InputKind
  std::size_t other_frames = 0;              ///< frames of the file that also show a hand which was not taken
  Side other_side = Side::left;              ///< of the first such hand: MotionOptions::side takes it
  std::string format;  ///< what the file was taken for: "webxr", "leapjs", "landmarks", "bvh", "angles"; or
                       ///< "grasp" (made)
};

struct MotionOptions {
  double rate = 30;  ///< [Hz] for files without time stamps (landmark CSV)
  std::optional<Side>
      side;         ///< which hand to take, or what the file is when it does not say; see load_motion
  double unit = 0;  ///< [m] per number of the file; 0: the format's own (LeapJS mm, the others m)
};

/// Reads a hand motion, from standard input where `path` is "-"; the format is told by the content:
///
/// - webxr, one pose:
///   `{"jointTransforms": {NAME: {"offsetMatrix": [16 numbers, column-major], "radius": r}, ...}}`.
/// - webxr, a sequence:
///   `[{"time": s, "joints": {NAME: {"position": [x,y,z], "orientation": [x,y,z,w], "radius": r}}}, ...]`.
///   `radius` may be missing. A joint left out of a frame is marked as not tracked in it; a frame without a
///   wrist, or whose `joints` is empty or null, is kTrackingLost.
///   NAME is WebXR's ("index-finger-phalanx-proximal"), OpenXR's ("XR_HAND_JOINT_INDEX_PROXIMAL_EXT",
///   "index_proximal") or the engine's ("index proximal"). A missing palm is put midway along the middle
///   metacarpal.
/// - leapjs: `{"frames": [...]}`, protocol 6 (fingers with joints), lengths in mm, time stamps in
///   microseconds; frames are objects, or arrays of which the first describes the layout. LZ-compressed
///   recordings are refused. Frames without five fingers of the hand are kTrackingLost. With several hands,
///   the first of the side asked for (of any side by default) is followed by its id, and after its loss the
///   next hand of the same side; Motion::other_frames tells of others.
/// - landmarks: CSV of 21 points in MediaPipe's order, 63 columns x0,y0,z0,x1..., with or without a header
///   line; a leading 64th column of seconds if the header names it `time`, `timestamp` or `t`, in capitals,
///   quotes or with the unit [s] or (s) behind it as well. A frame whose points all coincide, or whose
///   cells are all blank or all `nan`, is kTrackingLost.
/// - bvh: a skeleton (`HIERARCHY`) and its frames (`MOTION`). Of its joints those below a joint named after a
///   finger (thumb, index, middle, ring, little or pinky; of the side that names tell: "RightHandIndex1",
///   "index_01_r", "rIndex1") are the hand's, the nearest joint they all hang on is the wrist. Two hands
///   whose names tell no side are refused. Position channels of a joint take the place of its offset where
///   they repeat it in the first frame, else they come on top. The format doesn't say its unit, so
///   options.unit must.
/// - angles: `{"format": "lumbrical-angles", "side": "right", "samples": [SAMPLE, ...]}` where SAMPLE is
///   `{"time": s, "wrist": {"position": [x,y,z], "orientation": [w,x,y,z]}, "angles": [20 numbers]}`, the
///   angles in radians and in the order of hand.h. No other field is allowed.
///
/// Joints that the source lacks (palm, wrist, metacarpals) are derived, and orientations are built from
/// positions where there are none. Frames that are kTrackingLost repeat the last good pose (leading ones the
/// first). Of samples with equal time stamps the first counts. Where the file does not say which hand it is,
/// options.side does; without it the shape of the hand tells, and where that is undecided (a flat hand of
/// landmarks or BVH) it is taken for a right one.
///
/// Refused, with line and column or the frame's index: what is not finite, goes back in time, lies farther
/// than 10 km from the origin or 1 m from its wrist (wrong unit), and a side that the shape of the hand
/// contradicts. On error `motion` is unchanged.
Status load_motion(const std::string& path, const MotionOptions& options, Motion& motion);

/// Both hands of a capture, each as load_motion gives it for its side, with the same time stamps; nothing is
/// read twice. Refused where the file does not show both; on error both motions are unchanged.
Status load_both_motions(const std::string& path, const MotionOptions& options, Motion& right, Motion& left);

/// The same for a file already in memory; `name` stands in for the path in messages.
Status parse_motion(std::string_view content, const std::string& name, const MotionOptions& options,
                    Motion& motion);

/// The placing of a motion in the world: scale about B's origin first, then pose.
struct MotionPlacement {
  Pose pose;  ///< every sample's X_WB becomes pose * X_WB
  double scale =
      1;  ///< > 0, of joint positions (joint poses only: anything but 1 is refused for angles); radii follow
};

/// Refuses a pose that is not finite or not a unit quaternion and a scale that is not finite or not > 0.
/// On error `motion` is unchanged.
Status place_motion(const MotionPlacement& placement, Motion& motion);

/// The hand that belongs to a motion: `hand`, mirrored if the motion is of the other side, with the radii the
/// motion knows, and for joint poses a palm polygon fitted to its first frame in which the palm and its
/// knuckles are tracked.
Hand fit_hand(const Hand& hand, const Motion& motion);

/// Fits the hand to one frame of its own side that shows all of it: the palm, and the radii [m] that are
/// above 0. Refuses other frames: of joint angles, with a joint that is not tracked, not finite or without
/// a unit quaternion, with a palm that spans no area; and radii that are not finite or no hand's. On error
/// `hand` is unchanged.
Status fit_hand_to(const DeviceFrame& frame, const std::array<double, kJointCount>& radius, Hand& hand);

/// How the resampler behaves between and beyond samples.
struct ResamplerOptions {
  double max_gap =
      0.1;  ///< [s] no data for longer than this: kTrackingLost; up to it, held values are kExtrapolated
};

/// The device frame at `time` [s]. At a sample's time it is that sample, bit for bit. Between samples
/// positions, angles and base follow a monotone cubic (each coordinate stays between its two neighbours, its
/// speed is continuous), orientations the normalised linear blend along the shorter arc; a joint is valid
/// where both neighbours have it, and flags are those of both, with kTrackingLost where the two are more than
/// max_gap apart. Before the first and after the last sample the nearest is held: kExtrapolated, and
/// kTrackingLost beyond max_gap or where `time` is not a number; but a single sample, a still pose, is that
/// sample at any time. A pure function of its arguments: the same bits everywhere. `motion` must have at
/// least one sample.
DeviceFrame resample(const Motion& motion, double time, const ResamplerOptions& options = {});

/// Duration of the samples [s].
double duration(const Motion& motion);

/// Of a session of `seconds`, `rate` a second: those that begin before its end, but for rounding, and at
/// least one.
std::uint64_t tick_count(double seconds, double rate);

/// The demo's motion in joint angles at 100 Hz: a minimum-jerk reach from the -x side, grasp, stroke up and
/// down with changing squeeze, release and withdrawal, round an upright object of `radius` [m] standing on z
/// = 0 with its axis through the origin, `height` [m] tall. A right hand's fingers go round by the -y side,
/// its thumb by the +y side (a left hand's the other way round), so that a handle towards +x stays free.
/// Meant for radii from 0.025 to 0.05 m, where every finger presses 1 to 2 mm into the surface; both lengths
/// must be finite. `seconds` is clamped to 0.1 .. 3600. Above 0, `lift` [m] takes the place of the stroke: so
/// far the hand lifts what it holds, tilts it by 0.5 rad about the y axis and puts it down again.
Motion make_grasp(const Hand& hand, double radius, double height, double seconds, double lift = 0);

}  // namespace lumbrical
