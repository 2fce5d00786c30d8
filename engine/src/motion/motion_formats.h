// What the readers of the motion formats share: JSON with positions in its errors, checked numbers, and
// samples in the order of time. Internal to the motion_*.cpp files.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "base/text_cursor.h"
#include "lumbrical/motion.h"

namespace lumbrical {

// One reader per format. `name` opens every message. They fill side, radius, samples and format of an empty
// motion; times may start anywhere and lost samples may be without poses: parse_motion completes both.
Status parse_webxr(const nlohmann::json& root, const std::string& name, const MotionOptions& options,
                   Motion& motion);
/// `size` [bytes] of the file.
Status parse_leap(const nlohmann::json& root, std::size_t size, const std::string& name,
                  const MotionOptions& options, Motion& motion);
Status parse_angles(const nlohmann::json& root, const std::string& name, const MotionOptions& options,
                    Motion& motion);
Status parse_bvh(std::string_view content, const std::string& name, const MotionOptions& options,
                 Motion& motion);
Status parse_landmarks(std::string_view content, const std::string& name, const MotionOptions& options,
                       Motion& motion);

/// However little a frame holds, its sample takes hundreds of bytes: beyond so many frames each needs so much
/// of the file.
inline constexpr double kMostShortFrames = 65536, kShortFrame = 32;  // [bytes]

/// Parses JSON nested at most 32 deep.
Status parse_json(std::string_view content, const std::string& name, nlohmann::json& root);

/// The member of an object; null where `object` is no object or has no such member.
const nlohmann::json* find_member(const nlohmann::json& object, std::string_view key);

/// A finite number. `value` may be null.
bool read_number(const nlohmann::json* value, double& number);

/// Three numbers, multiplied by `unit`, none beyond kFarthest. `value` may be null.
bool read_position(const nlohmann::json* value, double unit, Vec3& position);

/// Four numbers that make a unit quaternion to within 5 %, normalised; `first_is_w` tells the order. `value`
/// may be null.
bool read_quaternion(const nlohmann::json* value, bool first_is_w, Quat& quaternion);

inline constexpr double kFarthest = 1e4;  ///< [m] from the origin: beyond, a float cannot carry millimetres
inline constexpr double kLargestRadius = 0.2;  ///< [m] of a joint
/// [s] Seconds since 1970 are far below it; their differences are numbers yet, and to a millisecond.
inline constexpr double kLastTime = 1e12;
inline constexpr double kLongestMotion = 1e9;  ///< [s] from the first sample to the last

/// "name: " and what follows it.
Status refuse(const std::string& name, const std::string& what);

/// Appends a sample unless its time equals the last one's. Refuses one that goes back in time, or is beyond
/// kLastTime or kLongestMotion; `where` ("frame 7") names it in the message.
Status append_sample(const std::string& name, const std::string& where, double time, const DeviceFrame& frame,
                     Motion& motion);

/// A frame without a hand, to be completed by parse_motion.
DeviceFrame lost_frame();

/// Where the little finger's knuckle lies as seen from the index's: the mean over all good frames of the
/// direction's component along the wrist's x. Near 1 on a right hand, near -1 on a left one, 0 if it cannot
/// be told. Says something only where the source told the orientation.
double right_handedness(const Motion& motion);

}  // namespace lumbrical
