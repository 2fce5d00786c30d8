#include "proxy/hand_pull.h"

#include <algorithm>
#include <cmath>

namespace lumbrical {
namespace {

// How much stiffer joints are about axes that they don't have.
constexpr double kLocked = 20;

// By how many times the wrist's spring a palm that balances all pushes resists by its field.
constexpr double kPalmFirmer = 20;

// [m/N] A gap gives way by so much, so that a finger between two walls is held by a finite force.
constexpr double kGapCompliance = 2e-6;

// Newton's steps, the least share of one that is tried, and what is no more energy than before.
constexpr int kMostTrials = 100;
constexpr double kLeastShare = 1e-6, kRounding = 1e-12;

constexpr std::size_t kOfFinger = 9, kOfWrist = 6, kFingers = kPhalanxCount / 3,
                      kMostMoves = kOfFinger * kFingers + kOfWrist;
using Moves = std::array<double, kMostMoves>;
using Matrix = std::array<Moves, kMostMoves>;  // its lower half

/// Which moves there are: the bends of the fingers that have gaps, then the shift and the turn of the wrist.
struct Asked {
  std::array<std::size_t, kFingers> place{};  // of a finger's bends
  std::array<std::size_t, kFingers> finger{};
  std::size_t fingers = 0;

  explicit Asked(std::span<const Gap> gaps) {
    std::array<bool, kFingers> has_gaps{};
    for (const Gap& gap : gaps)
      if (gap.segment != kPalmSegment) has_gaps[gap.segment / 3u] = true;
    for (std::size_t i = 0; i < kFingers; ++i) {
      if (!has_gaps[i]) continue;
      place[i] = kOfFinger * fingers;
      finger[fingers++] = i;
    }
  }
  [[nodiscard]] std::size_t wrist() const { return kOfFinger * fingers; }
  [[nodiscard]] std::size_t size() const { return wrist() + kOfWrist; }
  /// Calls visit(vector of a hand's move, its place in Moves).
  template <class Move, class Visit>
  void for_each(Move& move, const Visit& visit) const {
    for (std::size_t i = 0; i < fingers; ++i)
      for (std::size_t k = 0; k < 3; ++k) visit(move.bend[3 * finger[i] + k], kOfFinger * i + 3 * k);
    visit(move.shift, wrist());
    visit(move.turn, wrist() + 3);
  }
};

void put(Vec3 v, double* at) {
  at[0] = v.x;
  at[1] = v.y;
  at[2] = v.z;
}

Moves moves_of(const HandMove& move, const Asked& asked) {
  Moves moves;
  asked.for_each(move, [&](Vec3 v, std::size_t place) { put(v, &moves[place]); });
  return moves;
}

// The roots of how far each move gives way [m/N, 1/(N m)]: moves divided by them are what springs of one
// stiffness pull back. The wrist gives way only to what the hand does not balance by itself, and to that no
// faster than the palm's field, which the pull knows nothing of, answers.
HandMove give_of(double stiffness, double balanced) {
  const double firmer = 1 + kPalmFirmer * balanced, shift = std::sqrt((1 - balanced) / (firmer * stiffness)),
               turn = shift / kHandLever, bend = 1 / (std::sqrt(stiffness) * kFingerLever),
               locked = bend / std::sqrt(kLocked);
  HandMove give{{shift, shift, shift}, {turn, turn, turn}, {}};
  // About x joints flex, about y the first joint of a finger spreads, about z nothing turns.
  for (std::size_t i = 0; i < kPhalanxCount; ++i) give.bend[i] = {bend, i % 3 == 0 ? bend : locked, locked};
  return give;
}

/// How a gap widens with the moves: of the finger's joints up to its segment, and of the wrist.
struct Row {
  std::size_t first = 0, bends = 0, wrist = 0;  // of Moves
  std::array<double, kOfFinger + kOfWrist> part{};
  double width = 0;  // where the springs have all their way
  double open = 0;   // where they are now

  [[nodiscard]] std::size_t size() const { return bends + kOfWrist; }
  [[nodiscard]] std::size_t move(std::size_t k) const { return k < bends ? first + k : wrist + k - bends; }
  [[nodiscard]] double widened(const Moves& y) const {
    double sum = 0;
    for (std::size_t k = 0; k < size(); ++k) sum += part[k] * y[move(k)];
    return sum;
  }
  [[nodiscard]] double push() const { return max(0, -open / kGapCompliance); }  // [N]
};
using Rows = FixedList<Row, kMostGapsPerSegment * kSegmentCount>;

Row row_of(const Joints& proxy, const Gap& gap, const Asked& asked, const Moves& give, const Moves& wanted) {
  Row row;
  row.wrist = asked.wrist();
  const auto arm_from = [&](std::size_t joint) { return gap.point - proxy.pose[joint].position; };
  if (gap.segment != kPalmSegment) {
    const std::size_t base = gap.segment - gap.segment % 3u;
    row.first = asked.place[base / 3];
    for (std::size_t i = base; i <= gap.segment; ++i, row.bends += 3) {
      const std::size_t joint = kPhalanxJoints[i].base;
      if (!proxy.has(static_cast<int>(joint))) continue;
      const Vec3 turn = cross(arm_from(joint), gap.normal);
      put(rotate(conjugate(proxy.pose[joint].orientation), turn), &row.part[row.bends]);
    }
  }
  put(gap.normal, &row.part[row.bends]);
  put(cross(arm_from(kWrist), gap.normal), &row.part[row.bends + 3]);
  row.open = row.width = gap.width + row.widened(wanted);
  for (std::size_t k = 0; k < row.size(); ++k) row.part[k] *= give[row.move(k)];
  return row;
}

double square_of(const Row& row) {
  double sum = 0;
  for (std::size_t k = 0; k < row.size(); ++k) sum += row.part[k] * row.part[k];
  return sum;
}

// Cholesky's way, in place; the matrix is a unit matrix and squares. Fingers know nothing of each other: what
// is before a finger's own columns is 0.
void solve(const Asked& asked, Matrix& a, Moves& b) {
  const auto first_column = [&](std::size_t row) { return row < asked.wrist() ? row - row % kOfFinger : 0; };
  for (std::size_t i = 0; i < asked.size(); ++i) {
    for (std::size_t j = first_column(i); j <= i; ++j) {
      double sum = a[i][j];
      for (std::size_t k = std::max(first_column(i), first_column(j)); k < j; ++k) sum -= a[i][k] * a[j][k];
      a[i][j] = i == j ? std::sqrt(sum) : sum / a[j][j];
    }
    for (std::size_t k = first_column(i); k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (std::size_t i = asked.size(); i-- > 0;) {
    b[i] /= a[i][i];
    for (std::size_t k = first_column(i); k < i; ++k) b[k] -= a[i][k] * b[i];
  }
}

// Newton's step: to where it would be best if just the gaps pushed that push now.
Moves step_from(const Asked& asked, const Moves& y, const Rows& rows) {
  Matrix curvature;
  Moves step;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    std::fill_n(curvature[i].begin(), i, 0);
    curvature[i][i] = 1;
    step[i] = -y[i];
  }
  for (const Row& row : rows) {
    if (!(row.open < 0)) continue;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const double scaled = row.part[i] / kGapCompliance;
      step[row.move(i)] -= row.open * scaled;
      for (std::size_t j = 0; j <= i; ++j) curvature[row.move(i)][row.move(j)] += scaled * row.part[j];
    }
  }
  solve(asked, curvature, step);
  return step;
}

// What the springs and the gaps that push have in them, times 2.
double energy(const Asked& asked, const Moves& y, const Rows& rows) {
  double sum = 0;
  for (std::size_t i = 0; i < asked.size(); ++i) sum += y[i] * y[i];
  for (const Row& row : rows) sum += row.open < 0 ? row.open * row.open / kGapCompliance : 0;
  return sum;
}

// Sets how open the gaps are; true if others push than before.
bool place(const Moves& y, Rows& rows) {
  bool others = false;
  for (Row& row : rows) {
    const bool pushed = row.open < 0;
    row.open = row.width + row.widened(y);
    others = others || (row.open < 0) != pushed;
  }
  return others;
}

Moves plus(const Asked& asked, const Moves& y, double share, const Moves& step) {
  Moves sum;
  for (std::size_t i = 0; i < asked.size(); ++i) sum[i] = y[i] + share * step[i];
  return sum;
}

// The moves of least energy, which has one least place and is smooth there: when no gap begins or ceases to
// push in a whole step it is reached. A shorter one keeps two sets of gaps from taking turns.
Moves least_energy(const Asked& asked, Rows& rows) {
  Moves y{};
  double before = energy(asked, y, rows);
  for (int i = 0; i < kMostTrials; ++i) {
    const Moves step = step_from(asked, y, rows);
    double share = 1;
    Moves there = plus(asked, y, share, step);
    const bool others = place(there, rows);
    double now = energy(asked, there, rows);
    while (others && now > (1 + kRounding) * before && share > kLeastShare) {
      share /= 2;
      there = plus(asked, y, share, step);
      place(there, rows);
      now = energy(asked, there, rows);
    }
    y = there;
    if (!others || !(now < before)) break;
    before = now;
  }
  return y;
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
  const Asked asked(gaps);
  const Moves give = moves_of(give_of(stiffness, balanced), asked), all_the_way = moves_of(wanted, asked);
  Rows rows;
  bool closes = false;
  for (Gap& gap : gaps) {
    const Row& row = rows.push_back(row_of(proxy, gap, asked, give, all_the_way));
    gap.stiffness = 1 / (square_of(row) + kGapCompliance);
    closes = closes || row.open < 0;
  }
  if (!closes) return wanted;
  const Moves y = least_energy(asked, rows);
  for (std::size_t i = 0; i < rows.size(); ++i) gaps[i].push = rows.begin()[i].push();
  HandMove move = wanted;
  asked.for_each(move, [&](Vec3& v, std::size_t k) {
    v += {give[k] * y[k], give[k + 1] * y[k + 1], give[k + 2] * y[k + 2]};
  });
  return move;
}

}  // namespace lumbrical
