#include "proxy/core_pushes.h"

namespace lumbrical {
namespace {

/// What a neighbour takes of a push on a segment.
struct Share {
  double part = 0;  ///< 0: there is none
  std::size_t neighbour = 0;
  Vec3 joint;  ///< [m] W, between the two
};

bool has_phalanx(const Joints& joints, std::size_t i) {
  return joints.has(kPhalanxJoints[i].base) && joints.has(kPhalanxJoints[i].tip);
}

// Of the neighbour at the nearer end of a phalanx, and no farther than to its middle.
Share share_of(const Hand& hand, const Joints& proxy, const Gap& gap) {
  if (gap.segment == kPalmSegment) return {};
  const auto [base, tip] = kPhalanxJoints[gap.segment];
  const double to_base = norm(gap.point - proxy.position(base)),
               to_tip = norm(gap.point - proxy.position(tip));
  const bool outwards = to_tip < to_base;
  if (gap.segment % 3 == (outwards ? 2 : 0)) return {};
  const std::size_t neighbour = outwards ? gap.segment + 1u : gap.segment - 1u;
  if (!has_phalanx(proxy, neighbour)) return {};
  const int joint = outwards ? tip : base;
  const double distance = min(to_base, to_tip), half_length = 0.5 * (to_base + to_tip),
               reach = min(kCoreShare * hand.radius[static_cast<std::size_t>(joint)], half_length);
  return {distance < reach ? 0.5 * (1 - distance / reach) : 0, neighbour, proxy.position(joint)};
}

// A part of a push, on a segment at a point.
Gap part_of(const Gap& gap, double part, std::size_t segment, Vec3 point) {
  Gap push = gap;
  push.segment = static_cast<std::uint8_t>(segment);
  push.point = point;
  push.push *= part;
  push.stiffness *= part;
  return push;
}

}  // namespace

void list_pushes(const Hand& hand, const Joints& proxy, std::span<const Gap> gaps, PushList& pushing) {
  pushing.clear();
  for (const Gap& gap : gaps) {
    if (!(gap.push > 0)) continue;
    const auto [part, neighbour, joint] = share_of(hand, proxy, gap);
    if (part > 0) {
      const double rest = 1 - part;
      pushing.push_back(part_of(gap, rest, gap.segment, joint + (gap.point - joint) / rest));
      pushing.push_back(part_of(gap, part, neighbour, joint));
    } else {
      pushing.push_back(gap);
    }
  }
}

}  // namespace lumbrical
