// Which hand points are of, told by the bend of its fingers, and hands built from them.
#include "motion/motion_points.h"

#include <span>

#include "motion/motion_formats.h"

namespace lumbrical {
namespace {

DeviceFrame frame_of(const HandPoints& points) {
  const std::array<Pose, kJointCount> poses = hand_from_positions(points);
  DeviceFrame frame;
  for (int j = 0; j < kJointCount; ++j) frame.joint[j] = to_joint_pose(poses[j]);
  return frame;
}

// How far the fingertips lean to the palmar side of the palm, if it is a right hand's, as the sine of an
// angle; negative on a left hand, and near zero where the fingers are straight. Fingers bend far to one side
// only.
double palmar_lean(const HandPoints& points) {
  const auto way = [&points](int from, int to) { return points.position[to] - points.position[from]; };
  const Vec3 palmar = unit_or(cross(way(kWrist, kIndexProximal), way(kWrist, kLittleProximal)), {});
  double sum = 0;
  for (int base = kIndexProximal; base <= kLittleProximal; base += 5)
    sum += dot(unit_or(way(base, base + 3), {}), palmar);
  return 0.25 * sum;
}

double mean_lean(std::span<const HandPoints> frames) {
  double sum = 0;
  std::size_t count = 0;
  for (const HandPoints& points : frames) {
    if (points.known == 0) continue;
    sum += palmar_lean(points);
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

}  // namespace

Status append_points(const std::string& name, const std::string& where, double time, const HandPoints& points,
                     std::vector<HandPoints>& frames, Motion& motion) {
  Status status = append_sample(name, where, time, lost_frame(), motion);
  const bool is_new = motion.samples.size() > frames.size();
  if (status.ok() && is_new) frames.push_back(points);
  return status;
}

void build_hands(Side side, std::vector<HandPoints>& frames, Motion& motion) {
  motion.side = side;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].side = side;
    if (frames[i].known != 0) motion.samples[i].frame = frame_of(frames[i]);
  }
}

Status build_told_by_shape(const std::string& name, std::optional<Side> said, const std::string& remedy,
                           std::vector<HandPoints>& frames, Motion& motion) {
  constexpr double kTelling = 0.25;  // beyond what flat hands differ by
  const double lean = mean_lean(frames);
  const Side bent = lean < 0 ? Side::left : Side::right;
  const Side side = std::fabs(lean) < kTelling ? said.value_or(Side::right) : bent;
  if (said.value_or(side) != side)
    return refuse(
        name, "as a " + std::string(side_name(*said)) + " hand its fingers would bend backwards; " + remedy);
  build_hands(side, frames, motion);
  return {};
}

std::string set_other_side(Side said) {
  return "set the side to " + std::string(side_name(other_side(said)));
}

}  // namespace lumbrical
