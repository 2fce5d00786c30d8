// See lumbrical/clearance.h. The hand's skin is taken for spheres along phalanges and over the palm; each
// asks for the nearest triangle, and only what may be nearer than the nearest so far is looked at.
#include "lumbrical/clearance.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "base/floating_point.h"
#include "base/named.h"
#include "index/sphere_tree.h"
#include "index/triangle_distance.h"
#include "model/corners.h"
#include "model/swept_polygon.h"
#include "stages/hand_pose.h"

namespace lumbrical {
namespace {

constexpr std::size_t kMostSamples = 1000;
constexpr int kAlongPhalanx = 6, kAcrossPalm = 6;  // steps between spheres: 5 to 15 mm
constexpr double kTouch = 0.001;                   // [m] deep

struct SkinSphere {
  Vec3 centre;
  double radius;
  int segment;
};

/// The hand of one sample as spheres, its joints beside them; false where it can't be felt with.
bool pose_spheres(const Scene& scene, const DeviceFrame& frame, Primitives& posed,
                  std::vector<SkinSphere>& spheres) {
  spheres.clear();
  if (check_input(frame) != 0 || (frame.flags & kTrackingLost) != 0) return false;
  static_cast<void>(place_hand(scene.hand, scene.settings, frame, posed));
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    if (!posed.present[i]) continue;
    const Primitive& phalanx = posed.capsule[i];
    for (int k = 0; k <= kAlongPhalanx; ++k) {
      const double t = static_cast<double>(k) / kAlongPhalanx;
      spheres.push_back({(1 - t) * phalanx.end1 + t * phalanx.end2,
                         (1 - t) * phalanx.radius1 + t * phalanx.radius2, static_cast<int>(i)});
    }
  }
  if (!posed.joints.has(kPalm)) return !spheres.empty();
  const SweptPolygon palm = place_palm(scene.hand.palm, posed.joints.pose[kPalm]);
  Vec3 middle;
  for (std::size_t i = 0; i < palm.corner_count; ++i) middle += palm.corner[i] / palm.corner_count;
  for (std::size_t i = 0; i < palm.corner_count; ++i) {
    const Vec3 a = palm.corner[i] - middle;
    const Vec3 b = palm.corner[(i + 1) % palm.corner_count] - middle;
    for (int u = 0; u <= kAcrossPalm; ++u) {
      for (int v = 0; u + v <= kAcrossPalm; ++v)
        spheres.push_back({middle + (u * a + v * b) / kAcrossPalm, palm.radius, kPalmSegment});
    }
  }
  return !spheres.empty();
}

/// An object's triangles with a tree of their own.
struct ObjectSurface {
  Triangles triangles;
  SphereTree tree;
  TreeLayout layout;

  explicit ObjectSurface(const Mesh& mesh) {
    const Mesh* const meshes[] = {&mesh};
    triangles = gather_triangles(meshes, std::vector<std::vector<bool>>(1), 1);
    tree = build_tree(triangles, Execution{});
    layout = layout_of(tree.head);
  }

  /// Makes `approach` nearer where a triangle lies nearer to the sphere.
  void ask(const SkinSphere& sphere, Approach& approach) const {
    if (tree.head.leaf_count == 0 || approach.distance == 0) return;
    const std::size_t level = tree.head.level_count;  // at least 1: there is a leaf
    for (std::size_t block = 0; block < layout.blocks[level - 1]; ++block)
      descend(level, block, sphere, approach);
  }

 private:
  // `level` counts down: at 0 a block's spheres are triangles', above they bound a leaf or a block each.
  void descend(std::size_t level, std::size_t block, const SkinSphere& sphere, Approach& approach) const {
    std::size_t first = 0;  // block of the level; the last level lies first
    for (std::size_t above = tree.head.level_count; above > level; --above) first += layout.blocks[above - 1];
    const SphereBlock& spheres = blocks_of(tree.lines.data())[first + block];
    std::array<std::pair<double, std::uint32_t>, SphereBlock::kWidth> near;
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < SphereBlock::kWidth; ++i) {
      if (!(spheres.r[i] >= 0)) continue;  // an empty place
      const Vec3 centre = tree.head.origin + Vec3{spheres.x[i], spheres.y[i], spheres.z[i]};
      const double away = norm(sphere.centre - centre) - static_cast<double>(spheres.r[i]) - sphere.radius;
      near[count++] = {away, i};
    }
    std::sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count));
    for (std::size_t k = 0; k < count && near[k].first < approach.distance; ++k) {
      const std::size_t number = block * SphereBlock::kWidth + near[k].second;
      if (level == 0) {
        measure(number, sphere, approach);
      } else if (level > 1) {
        descend(level - 1, number, sphere, approach);
      } else {
        for (std::size_t b = 0; b < tree.head.blocks_per_leaf; ++b)
          descend(0, number * tree.head.blocks_per_leaf + b, sphere, approach);
      }
    }
  }

  void measure(std::size_t place, const SkinSphere& sphere, Approach& approach) const {
    const std::uint32_t triangle = numbers_of(tree.lines.data(), layout)[place];
    const Corners corners = corners_of(triangles, triangle);
    if (cross(corners.b - corners.a, corners.c - corners.a) == Vec3{}) return;  // no one feels it
    const NearestPoint nearest = nearest_point(sphere.centre, corners.a, corners.b, corners.c);
    const double away = std::sqrt(nearest.square), distance = max(0, away - sphere.radius);
    if (!(distance < approach.distance)) return;
    approach.distance = distance;
    approach.segment = sphere.segment;
    approach.object = sphere.centre - nearest.gap;
    approach.hand =
        away > 0 ? sphere.centre - (min(away, sphere.radius) / away) * nearest.gap : sphere.centre;
  }
};

std::size_t samples_until(const Motion& motion, double seconds) {
  std::size_t count = std::min<std::size_t>(1, motion.samples.size());
  while (count < motion.samples.size() && motion.samples[count].time <= seconds) ++count;
  return count;
}

/// Calls visit(sample, posed hand, its spheres) for the samples that show a hand.
template <class Visit>
void for_each_pose(const Scene& scene, const Motion& motion, double seconds, const Visit& visit) {
  const std::size_t count = samples_until(motion, seconds), looked_at = std::min(count, kMostSamples);
  const auto posed = std::make_unique<Primitives>();
  std::vector<SkinSphere> spheres;
  for (std::size_t i = 0; i < looked_at; ++i) {
    const MotionSample& sample = motion.samples[looked_at < 2 ? 0 : i * (count - 1) / (looked_at - 1)];
    if (pose_spheres(scene, sample.frame, *posed, spheres)) visit(sample, *posed, spheres);
  }
}

void find_approach(const Scene& scene, const Motion& motion, double seconds, const Mesh& mesh,
                   Approach& approach) {
  const ObjectSurface surface(mesh);
  for_each_pose(scene, motion, seconds,
                [&](const MotionSample& sample, const Primitives&, const std::vector<SkinSphere>& spheres) {
                  for (const SkinSphere& sphere : spheres) {
                    const double before = approach.distance;
                    surface.ask(sphere, approach);
                    if (approach.distance < before) approach.time = sample.time;
                  }
                });
}

/// Where the hand would hold something, at the moment its fingertips are closest together.
bool find_grasp(const Scene& scene, const Motion& motion, double seconds, Vec3& grasp) {
  constexpr double kAsNarrow = 1e-6;  // [m] what is narrower by less is the same grasp, held
  constexpr std::array<Joint, 4> kTips = {kIndexTip, kMiddleTip, kRingTip, kLittleTip};
  double narrowest = 1e300;
  for_each_pose(scene, motion, seconds,
                [&](const MotionSample&, const Primitives& posed, const std::vector<SkinSphere>&) {
                  if (!posed.joints.has(kThumbTip)) return;
                  Vec3 mean;
                  for (const Joint tip : kTips) {
                    if (!posed.joints.has(tip)) return;
                    mean += posed.joints.position(tip) / kTips.size();
                  }
                  const Vec3 thumb = posed.joints.position(kThumbTip);
                  const double width = norm(mean - thumb);
                  if (!(width < narrowest - kAsNarrow)) return;
                  narrowest = width;
                  grasp = 0.5 * mean + 0.5 * thumb;
                });
  return narrowest < 1e300;
}

constexpr Named<Alignment::Target> kTargetNames[] = {
    {"centre", Alignment::Target::centre}, {"top", Alignment::Target::top},
    {"bottom", Alignment::Target::bottom}, {"left", Alignment::Target::left},
    {"right", Alignment::Target::right},   {"front", Alignment::Target::front},
    {"back", Alignment::Target::back},     {"contact", Alignment::Target::contact},
};

Vec3 target_point(const Alignment& alignment, const Box& box) {
  using Target = Alignment::Target;
  Vec3 point = box.middle();
  if (alignment.target == Target::point) point = alignment.point;
  if (alignment.target == Target::left) point.x = box.lower.x;
  if (alignment.target == Target::right) point.x = box.upper.x;
  if (alignment.target == Target::front) point.y = box.lower.y;
  if (alignment.target == Target::back) point.y = box.upper.y;
  if (alignment.target == Target::bottom) point.z = box.lower.z;
  if (alignment.target == Target::top) point.z = box.upper.z;
  return point;
}

// Where it stands at the start; only what has to be placed is copied.
const Mesh& mesh_in_world(const SceneObject& object, Mesh& placed) {
  if (!is_apart(object)) return object.mesh;
  placed = object.mesh;
  place_mesh(object.pose, placed);
  return placed;
}

}  // namespace

Clearance find_clearance(const Scene& scene, const Motion& motion, double seconds) {
  const FloatingPointGuard guard;
  Clearance clearance;
  bool any = false;
  for_each_pose(scene, motion, seconds,
                [&](const MotionSample&, const Primitives&, const std::vector<SkinSphere>& spheres) {
                  for (const SkinSphere& sphere : spheres) clearance.hand.add(sphere.centre, sphere.radius);
                  any = true;
                });
  for (const SceneObject& object : scene.objects) {
    Mesh placed;
    const Mesh& mesh = mesh_in_world(object, placed);
    clearance.object.push_back(bounding_box(mesh));
    if (any && !mesh.triangles.empty())
      find_approach(scene, motion, seconds, mesh, clearance.approach.emplace_back());
    else
      clearance.approach.emplace_back();
  }
  if (scene.world) clearance.object.push_back(scene.world->extent);
  return clearance;
}

std::optional<Alignment> parse_alignment(std::string_view text) {
  Alignment alignment;
  const std::size_t colon = text.rfind(':');
  if (colon != std::string_view::npos) {
    alignment.object = text.substr(0, colon);
    text.remove_prefix(colon + 1);
  }
  if (const auto target = value_named(kTargetNames, text)) {
    alignment.target = *target;
    return alignment;
  }
  alignment.target = Alignment::Target::point;
  for (double Vec3::*const axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), alignment.point.*axis);
    if (error != std::errc() || !is_finite(alignment.point.*axis)) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (axis == &Vec3::z) break;
    if (text.empty() || text[0] != ',') return std::nullopt;
    text.remove_prefix(1);
  }
  return text.empty() ? std::optional(alignment) : std::nullopt;
}

namespace {

std::string names_with_triangles(const std::vector<SceneObject>& objects) {
  std::string names;
  for (const SceneObject& object : objects)
    if (!object.mesh.triangles.empty()) names += (names.empty() ? "" : ", ") + object.name;
  return names.empty() ? "none" : names;
}

}  // namespace

Status find_shift(const Scene& scene, const Motion& motion, double seconds, const Alignment& alignment,
                  Vec3& shift) {
  const FloatingPointGuard guard;
  const bool needs_object = alignment.target != Alignment::Target::point;
  const auto object =
      std::find_if(scene.objects.begin(), scene.objects.end(), [&](const SceneObject& candidate) {
        return (alignment.object.empty() || candidate.name == alignment.object) &&
               !candidate.mesh.triangles.empty();
      });
  if (object == scene.objects.end() && (needs_object || !alignment.object.empty())) {
    if (scene.world)
      return Status::error("a world file has no objects to align a motion to; give a point x,y,z");
    return Status::error("the scene has no object \"" + alignment.object +
                         "\" with triangles to align a motion to; it has " +
                         names_with_triangles(scene.objects));
  }
  if (alignment.target == Alignment::Target::contact) {
    Approach approach;
    Mesh placed;
    find_approach(scene, motion, seconds, mesh_in_world(*object, placed), approach);
    if (!(approach.distance < 1e300)) return Status::error("no sample of the motion shows a hand to align");
    const Vec3 gap = approach.object - approach.hand;
    const double length = norm(gap);
    shift = length > 0 ? ((length + kTouch) / length) * gap : Vec3{};
    return {};
  }
  Vec3 grasp;
  if (!find_grasp(scene, motion, seconds, grasp))
    return Status::error("no sample of the motion shows all fingertips; align it by contact");
  Mesh placed;
  const Box box = object == scene.objects.end() ? Box{} : bounding_box(mesh_in_world(*object, placed));
  shift = target_point(alignment, box) - grasp;
  return {};
}

}  // namespace lumbrical
