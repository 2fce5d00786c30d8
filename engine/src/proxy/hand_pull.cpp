#include "proxy/hand_pull.h"

#include <cmath>

namespace lumbrical {
namespace {

// How much stiffer joints are about axes that they don't have.
constexpr double kLocked = 20;

// [m/N] A gap gives way by so much, so that a finger between two walls is held by a finite force.
constexpr double kGapCompliance = 2e-6;

constexpr int kMostSweeps = 100;

/// The two moves of the wrist, then the joints'.
constexpr std::size_t kMoves = 2 + kPhalanxCount;
using Moves = std::array<Vec3, kMoves>;

Vec3 times(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

// How far each move gives way [m/N, 1/(N m)]; the wrist only to what the hand does not balance by itself.
Moves compliance_of(double stiffness, double balanced) {
  Moves moves;
  const double shift = (1 - balanced) / stiffness, turn = shift / (kHandLever * kHandLever),
               bend = 1 / (stiffness * kFingerLever * kFingerLever);
  moves[0] = {shift, shift, shift};
  moves[1] = {turn, turn, turn};
  // About x joints flex, about y the first joint of a finger spreads, about z nothing turns.
  for (std::size_t i = 0; i < kPhalanxCount; ++i)
    moves[2 + i] = {bend, i % 3 == 0 ? bend : bend / kLocked, bend / kLocked};
  return moves;
}

/// How a gap widens with the moves: of the wrist, and of the finger's joints up to its segment.
struct Row {
  std::size_t first = 2, last = 2;  // of Moves, beside the wrist's
  std::array<Vec3, 5> part;         // of the wrist, then of those
  double width = 0, diagonal = 0;

  [[nodiscard]] double widened(const Moves& x) const {
    double sum = dot(part[0], x[0]) + dot(part[1], x[1]);
    for (std::size_t k = first; k < last; ++k) sum += dot(part[2 + k - first], x[k]);
    return sum;
  }
  void push(double force, const Moves& compliance, Moves& x) const {
    for (std::size_t k = 0; k < 2; ++k) x[k] += force * times(compliance[k], part[k]);
    for (std::size_t k = first; k < last; ++k) x[k] += force * times(compliance[k], part[2 + k - first]);
  }
};

Row row_of(const Joints& proxy, const Gap& gap, const Moves& compliance) {
  Row row;
  row.width = gap.width;
  const auto arm_from = [&](std::size_t joint) { return gap.point - proxy.pose[joint].position; };
  row.part[0] = gap.normal;
  row.part[1] = cross(arm_from(kWrist), gap.normal);
  if (gap.segment != kPalmSegment) {
    const std::size_t base = gap.segment - gap.segment % 3u;
    row.first = 2 + base;
    row.last = 2 + gap.segment + 1u;
    for (std::size_t i = base; i <= gap.segment; ++i) {
      const std::size_t joint = kPhalanxJoints[i].base;
      const Vec3 turn = cross(arm_from(joint), gap.normal);
      row.part[2 + i - base] = proxy.has(static_cast<int>(joint))
                                   ? rotate(conjugate(proxy.pose[joint].orientation), turn)
                                   : Vec3{};
    }
  }
  Moves alone{};
  row.push(1, compliance, alone);
  row.diagonal = row.widened(alone) + kGapCompliance;
  return row;
}

// As much of a vector as is no longer than `most`.
bool shorten(double most, Vec3& v) {
  const double length = norm(v);
  if (!(length > most)) return false;
  v = (most / length) * v;
  return true;
}

}  // namespace

bool shorten(double stiffness, HandMove& move) {
  const double most = kStrongestPull / stiffness;
  bool shortened = shorten(most, move.shift);
  shortened = shorten(most / kHandLever, move.turn) || shortened;
  for (Vec3& bend : move.bend) shortened = shorten(most / kFingerLever, bend) || shortened;
  return shortened;
}

HandMove pull(const Joints& proxy, const HandMove& wanted, double stiffness, double balanced,
              std::span<Gap> gaps) {
  const Moves compliance = compliance_of(stiffness, balanced);
  Moves x;
  x[0] = wanted.shift;
  x[1] = wanted.turn;
  for (std::size_t i = 0; i < kPhalanxCount; ++i) x[2 + i] = wanted.bend[i];
  FixedList<Row, kMostGapsPerSegment * kSegmentCount> rows;
  for (Gap& gap : gaps) gap.stiffness = 1 / rows.push_back(row_of(proxy, gap, compliance)).diagonal;
  // Gauss and Seidel's, each force kept from pulling.
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double change = 0, largest = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Row& row = rows.begin()[i];
      double& push = gaps[i].push;
      const double open = row.width + row.widened(x) + kGapCompliance * push;
      const double force = max(0, push - open / row.diagonal), step = force - push;
      if (step == 0) continue;
      row.push(step, compliance, x);
      push = force;
      change = max(change, std::fabs(step));
      largest = max(largest, force);
    }
    if (!(change > 1e-10 * largest)) break;
  }
  HandMove move{x[0], x[1], {}};
  for (std::size_t i = 0; i < kPhalanxCount; ++i) move.bend[i] = x[2 + i];
  return move;
}

}  // namespace lumbrical
