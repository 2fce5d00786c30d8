#include "proxy/core_pushes.h"

#include "base/shortened.h"

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

// [s] In which what hopped from one segment to another follows.
constexpr double kHopTime = 0.02;
constexpr double kNothingLeft = 1e-9;  // [N] as good as nothing

// What pushes make each joint carry; and of each finger what all its pushes come to.
struct Pushed {
  std::array<Vec3, kPhalanxCount> carried{};
  std::array<double, kFingerCount> size{};  // [N]
};
Pushed pushed_by(const PushList& pushing) {
  Pushed pushed;
  for (const Gap& gap : pushing) {
    if (gap.segment == kPalmSegment) continue;
    const std::size_t first = gap.segment - gap.segment % 3u;
    for (std::size_t i = first; i <= gap.segment; ++i) pushed.carried[i] += gap.push * gap.normal;
    pushed.size[first / 3] += gap.push;
  }
  return pushed;
}

// Of what a joint carries, what has come from or gone to another segment, and not with the finger's whole.
Vec3 hopped(Vec3 change, Vec3 change_of_whole) {
  const double size = norm(change), explained = norm(change_of_whole);
  return size > explained ? (1 - explained / size) * change : Vec3{};
}

// [N] What the pads let through of a finger's pushes is no more than it feels.
double felt_by(const HandForces& forces, std::size_t first) {
  double sum = 0;
  for (std::size_t i = first; i < first + 3; ++i) sum += norm(forces.segment[i].force);
  return sum;
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

void hand_on(const PushList& pushing, const Primitives& hand, double rate, bool anew, ProxyState& kept,
             HandForces& forces) {
  const auto [now, size] = pushed_by(pushing);
  const double left = 1 - min(1, 1 / (rate * kHopTime));
  for (std::size_t first = 0; first < kPhalanxCount; first += 3) {
    const double most = min(size[first / 3], felt_by(forces, first));
    const Vec3 whole = now[first] - kept.carried[first];
    for (std::size_t i = first + 1; i < first + 3; ++i) {
      const Vec3 hop = hopped(now[i] - kept.carried[i], whole);
      Vec3& late = kept.late[i];
      late = shortened(left * (late - hop), most);
      if (anew || norm(late) < kNothingLeft || !hand.present[i] || !hand.present[i - 1]) {
        late = {};
        continue;
      }
      forces.segment[i].force += late;
      forces.segment[i - 1].force -= late;
      forces.segment[i - 1].torque -= cross(hand.base_joint[i] - hand.base_joint[i - 1], late);
    }
  }
  kept.carried = now;
}

}  // namespace lumbrical
