// Motions from files on a disk and from standard input.
#include <array>

#include "base/whole_file.h"
#include "motion/motion_formats.h"

namespace lumbrical {
namespace {

Status read_motion_file(const std::string& path, std::string& content) {
  return read_whole_file(path, std::uintmax_t{1} << 30, "a motion file", content);
}

}  // namespace

Status load_motion(const std::string& path, const MotionOptions& options, Motion& motion) {
  std::string content;
  if (Status status = read_motion_file(path, content); !status.ok()) return status;
  return parse_motion(content, shown_name(path), options, motion);
}

Status load_both_motions(const std::string& path, const MotionOptions& options, Motion& right, Motion& left) {
  std::string content;
  if (Status status = read_motion_file(path, content); !status.ok()) return status;
  const std::string name = shown_name(path);
  // A file of one hand that does not tell its side would be taken for either.
  Motion any;
  MotionOptions of_side = options;
  of_side.side.reset();
  if (Status status = parse_motion(content, name, of_side, any); status.ok() && any.other_frames == 0)
    return refuse(name, "shows one hand, not two; leave out the side \"both\"");
  std::array<Motion, 2> motions;
  for (const Side side : {Side::right, Side::left}) {
    of_side.side = side;
    Motion& motion = motions[side == Side::right ? 0 : 1];
    if (Status status = parse_motion(content, name, of_side, motion); !status.ok()) return status;
    if (motion.other_frames == 0)
      return refuse(name, "shows no two hands, a left and a right one; leave out the side \"both\"");
  }
  right = std::move(motions[0]);
  left = std::move(motions[1]);
  return {};
}

}  // namespace lumbrical
