// The engine's own motion format: joint angles and a wrist pose per sample, as strict JSON.
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "motion/motion_formats.h"

namespace lumbrical {
namespace {

using nlohmann::json;

constexpr double kLargestAngle = 6.4;  // [rad] just over a full turn; degrees are told from radians by it

// Refuses members other than those named, so that a misspelt field is not silently ignored.
Status check_fields(const std::string& name, const std::string& where, const json& object,
                    std::initializer_list<std::string_view> allowed) {
  if (!object.is_object()) return refuse(name, where + "expected an object");
  for (const auto& [key, value] : object.items()) {
    bool known = false;
    for (const std::string_view field : allowed) known = known || key == field;
    if (!known)
      return refuse(name, where + "unknown field " + in_quotes(key) + "; remove it or correct its name");
  }
  return {};
}

Status read_angles(const std::string& name, const std::string& where, const json* value, DeviceFrame& frame) {
  if (!value || !value->is_array() || value->size() != kAngleCount) {
    return refuse(name, where + "\"angles\" must be " + std::to_string(kAngleCount) + " numbers");
  }
  for (std::size_t i = 0; i < kAngleCount; ++i) {
    double angle = 0;
    if (!read_number(&(*value)[i], angle) || !(std::fabs(angle) <= kLargestAngle)) {
      return refuse(
          name, where + "angle " + std::to_string(i) + " is not a number of radians between -6.4 and 6.4");
    }
    frame.angle[i] = static_cast<float>(angle);
  }
  return {};
}

Status read_sample(const std::string& name, const std::string& where, const json& sample, double unit,
                   double& time, DeviceFrame& frame) {
  Status status = check_fields(name, where, sample, {"time", "wrist", "angles"});
  if (!status.ok()) return status;
  if (!read_number(find_member(sample, "time"), time))
    return refuse(name, where + "\"time\" must be a number [s]");
  const json* wrist = find_member(sample, "wrist");
  if (!wrist) return refuse(name, where + "\"wrist\" is missing");
  status = check_fields(name, where + "wrist: ", *wrist, {"position", "orientation"});
  if (!status.ok()) return status;
  if (!read_position(find_member(*wrist, "position"), unit, frame.base.position)) {
    return refuse(name, where + "\"position\" must be three numbers within 10 km");
  }
  if (!read_quaternion(find_member(*wrist, "orientation"), true, frame.base.orientation)) {
    return refuse(name, where + "\"orientation\" must be a unit quaternion [w,x,y,z]");
  }
  return read_angles(name, where, find_member(sample, "angles"), frame);
}

Status read_side(const std::string& name, const json* value, const MotionOptions& options, Side& side) {
  if (value && *value == "right") {
    side = Side::right;
  } else if (value && *value == "left") {
    side = Side::left;
  } else {
    return refuse(name, "\"side\" must be \"left\" or \"right\"");
  }
  if (options.side.value_or(side) == side) return {};
  return refuse(name, "it is a " + std::string(side_name(side)) + " hand; ask for that side or for none");
}

}  // namespace

Status parse_angles(const json& root, const std::string& name, const MotionOptions& options, Motion& motion) {
  motion.format = "angles";
  Status status = check_fields(name, "", root, {"format", "side", "samples"});
  if (!status.ok()) return status;
  if (*find_member(root, "format") != "lumbrical-angles") {
    return refuse(name, "\"format\" must be \"lumbrical-angles\"");
  }
  status = read_side(name, find_member(root, "side"), options, motion.side);
  if (!status.ok()) return status;
  const json* samples = find_member(root, "samples");
  if (!samples || !samples->is_array()) return refuse(name, "\"samples\" must be an array");
  const double unit = options.unit > 0 ? options.unit : 1;
  for (std::size_t i = 0; i < samples->size(); ++i) {
    const std::string where = "sample " + std::to_string(i);
    double time = 0;
    DeviceFrame frame;
    frame.kind = InputKind::joint_angles;
    status = read_sample(name, where + ": ", (*samples)[i], unit, time, frame);
    if (status.ok()) status = append_sample(name, where, time, frame, motion);
    if (!status.ok()) return status;
  }
  return {};
}

}  // namespace lumbrical
