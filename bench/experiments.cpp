#include "experiments.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "lumbrical/shapes.h"

namespace lumbrical::bench {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
constexpr double kHeading = 0.35;  // [rad] of leaning fingers, so that nothing lines up with the grid

Sample sample_at(Rig& rig, const Pose& X_WF, double at) {
  Sample sample;
  sample.at = at;
  sample.felt = feel(rig, X_WF);
  sample.force = sample.felt.force;
  return sample;
}

double angle_between(Vec3 a, Vec3 b) { return std::atan2(norm(cross(a, b)), dot(a, b)); }

}  // namespace

Evenness evenness_of(const Series& series) {
  Evenness evenness;
  double low = 1e300, high = 0, theory = 0;
  evenness.least = 0xffffffffu;
  for (const Sample& sample : series) {
    const double force = norm(sample.force);
    low = std::min(low, force);
    high = std::max(high, force);
    evenness.mean += force / static_cast<double>(series.size());
    theory += norm(sample.theory) / static_cast<double>(series.size());
    evenness.least = std::min(evenness.least, sample.felt.triangles);
    evenness.most = std::max(evenness.most, sample.felt.triangles);
  }
  evenness.bias = theory > 0 ? evenness.mean / theory - 1 : 0;
  evenness.peak_to_peak = (high - low) / evenness.mean;
  for (std::size_t i = 1; i < series.size(); ++i) {
    const Vec3 before = series[i - 1].force, after = series[i].force;
    evenness.largest_step =
        std::max(evenness.largest_step, std::fabs(norm(after) - norm(before)) / evenness.mean);
    evenness.largest_jump = std::max(evenness.largest_jump, norm(after - before) / evenness.mean);
    if (norm(before) > 0 && norm(after) > 0)
      evenness.largest_turn = std::max(evenness.largest_turn, angle_between(before, after));
  }
  return evenness;
}

double undivided_force(Law law, double tilt, double depth) {
  if (law == Law::point) return 0;
  const PosedFinger finger = one_phalanx();
  const Pose pose{{0, 0, kRadius - depth}, leaning(tilt, kHeading)};
  Rig rig = make_rig(cut_plane(1, 1, Cut::whole, 0), finger, law == Law::field ? law : Law::column);
  return norm(feel(rig, pose).force);
}

Series slide(const Slide& slide, Law law) {
  const double margin = 0.05;
  Rig rig = make_rig(graded_plane(slide.length + 2 * margin, 2 * margin, slide.edge, 11), one_phalanx(), law);
  const Quat orientation = leaning(slide.tilt, kHeading);
  const Vec3 theory{0, 0, undivided_force(law, slide.tilt, slide.depth)};
  Series series;
  const int ticks = static_cast<int>(std::lround(slide.length / kStep));
  for (int i = 0; i <= ticks; ++i) {
    const double x = kStep * i;
    series.push_back(sample_at(rig, {{x - 0.5 * slide.length, 0, kRadius - slide.depth}, orientation}, x));
    series.back().theory = theory;
  }
  return series;
}

double divided_over_undivided(Law law, double tilt, double edge, int placements) {
  const Mesh mesh = edge > 0 ? graded_plane(0.12, 0.12, edge, 21) : cut_plane(0.12, 1, Cut::whole, 0);
  Rig rig = make_rig(mesh, one_phalanx(), law);
  double sum = 0;
  for (int i = 0; i < placements; ++i) {
    // Places that fill a square of 20 mm evenly (Roberts' R2 sequence).
    const double u = std::fmod(0.7548776662466927 * i, 1), v = std::fmod(0.5698402909980532 * i, 1);
    const Vec3 place{0.02 * (u - 0.5), 0.02 * (v - 0.5), kRadius - kDepth};
    sum += norm(feel(rig, {place, leaning(tilt, kHeading)}).force) / placements;
  }
  const double whole = undivided_force(law, tilt, kDepth);
  return whole > 0 ? sum / whole : sum;
}

double lean_on_ridge(Law law) {
  Rig rig = make_rig(ridge(15 * kDegree, 0.02, 0.02, 0.001, 5), one_phalanx(), law);
  const Vec3 force = feel(rig, {{0, 0, kRadius - kDepth}, {}}).force;
  return std::atan2(-force.x, force.z);
}

Series follow_slope(double angle, double edge, Law law) {
  Rig rig = make_rig(bent_plane(angle, 0.06, edge, edge, 31), one_phalanx(), law);
  const double height = kRadius - kDepth, before = 0.02, after = 0.02;
  // Over a convex edge the tip's centre goes round it; in a concave one its path has a corner.
  const double round = angle > 0 ? height * angle : 0,
               corner = angle < 0 ? -height * std::tan(0.5 * angle) : 0;
  const Vec3 down{std::cos(angle), 0, -std::sin(angle)}, normal{std::sin(angle), 0, std::cos(angle)};
  Series series;
  const int first = -static_cast<int>(before / kStep), last = static_cast<int>((round + after) / kStep);
  for (int i = first; i <= last; ++i) {
    const double at = kStep * i;
    Vec3 centre{at - corner, 0, height};
    if (at > 0 && at < round) {
      centre = height * Vec3{std::sin(at / height), 0, std::cos(at / height)};
    } else if (at > 0) {
      centre = height * normal + (at - round + corner) * down;
    }
    series.push_back(sample_at(rig, {centre, leaning(60 * kDegree, kPi - kHeading)}, at));
  }
  return series;
}

Series sweep_fingertip(std::uint32_t cells, Law law) {
  const double amplitude = 0.0005;
  Rig rig = make_rig(make_height_field(0.08, cells, amplitude, 0.03), one_phalanx(), law);
  Series series;
  for (int i = 0; i <= 300; ++i) {
    const double x = kStep * i;
    const Vec3 centre{x - 0.015, 0.0013, kRadius - kDepth};
    series.push_back(sample_at(rig, {centre, leaning(45 * kDegree, kPi - kHeading)}, x));
  }
  return series;
}

Series poke(double tilt, double deepest, Law law) {
  Rig rig = make_rig(graded_plane(0.1, 0.1, 0.003, 41), one_phalanx(), law);
  Series series;
  for (int i = 0; kStep * i <= deepest; ++i) {
    const double depth = kStep * i;
    series.push_back(sample_at(rig, {{0, 0, kRadius - depth}, leaning(tilt, kHeading)}, depth));
  }
  return series;
}

Vec3 hook(Law law) {
  Rig rig = make_rig(bent_plane(0.5 * kPi, 0.1, 0.003, 0.003, 51), one_phalanx(), law);
  return feel(rig, {{kRadius - kDepth, 0, -0.015 + kRadius}, {}}).force;
}

BendResult bend(const Mesh& mesh, const Bend& bend, Law law) {
  const double half = 0.5 * bend.roll;
  const Pose X_WF{{-0.04, 0, kRadius - bend.depth}, {std::cos(half), std::sin(half), 0, 0}};
  const auto finger_at = [&](int i) {
    const double angle = bend.from + bend.step * i;
    return bent_finger(angle, bend.ratio * angle);
  };
  Rig rig = make_rig(mesh, finger_at(0), law);
  // No joint moves farther in a step than the tip of a straight finger does when both joints turn at once;
  // joints are kept in single precision.
  const double farthest = bend.step * (0.045 + bend.ratio * 0.020) + 1e-7;
  // The paper's cylinders and spheres cover the whole finger, some of it twice, whatever shares out space.
  Rig thick = make_rig(mesh, bent_finger(0, 0, kRadius + farthest), Law::point);

  BendResult result;
  const int steps = static_cast<int>(std::lround((bend.to - bend.from) / bend.step));
  for (int i = 0; i <= steps; ++i) {
    const auto before = rig.frame.joint;
    set_joints(finger_at(i), rig);
    result.series.push_back(sample_at(rig, X_WF, bend.from + bend.step * i));
    const Sample& here = result.series.back();
    result.largest_force = std::max(result.largest_force, norm(here.force));
    if (i == 0) continue;
    double displacement = 0;
    for (std::size_t k = kIndexProximal; k <= kIndexTip; ++k) {
      const auto &p = before[k].position, &q = rig.frame.joint[k].position;
      displacement = std::max(displacement, norm(Vec3{q[0], q[1], q[2]} - Vec3{p[0], p[1], p[2]}));
    }
    if (displacement > farthest) throw std::logic_error("a joint moved farther than the finger is long");
    const double change = norm(here.force - result.series[static_cast<std::size_t>(i - 1)].force);
    const double per_area = change == 0 ? 0 : change / (rig.model.settings.stiffness * displacement);
    result.largest_step = std::max(result.largest_step, change);
    // The finger's own area is less than the thicker one's, and may tell already that this step is not the
    // worst.
    if (per_area <= result.share_of_bound * here.felt.area) continue;
    thick.frame.joint = rig.frame.joint;
    const double share = per_area / feel(thick, X_WF).area;
    if (share > result.share_of_bound) {
      result.share_of_bound = share;
      result.worst_at = here.at;
    }
  }
  return result;
}

}  // namespace lumbrical::bench
