// See scene_views.h.
#include "recording/scene_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "model/primitive.h"
#include "model/swept_polygon.h"
#include "recording/foxglove_parts.h"

namespace lumbrical {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;

struct Colour {
  double r, g, b, a;
};
constexpr Colour kSkin = {0.85, 0.63, 0.4, 0.6}, kThing = {0.6, 0.64, 0.68, 1}, kForce = {0.84, 0.37, 0, 1};
constexpr double kThickness = 0.002;  // [m] of an arrow's shaft
constexpr double kLeastForce = 1e-3;  // [N] that has an arrow

Offset<foxglove::Color> paint(FlatBufferBuilder& builder, const Colour& colour) {
  return foxglove::CreateColor(builder, colour.r, colour.g, colour.b, colour.a);
}

// Of those felt apart, counted over them.
std::string frame_of(std::size_t apart) { return "object " + std::to_string(apart); }

// Some direction across a unit vector.
Vec3 across(Vec3 unit) {
  const Vec3 other = std::fabs(unit.x) < 0.8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return unit_or(cross(other, unit), {0, 0, 1});
}

Quat with_x_along(Vec3 x) {
  const Vec3 y = across(x);
  return quat_from_axes(x, y, cross(x, y));
}

Quat with_z_along(Vec3 z) {
  const Vec3 x = across(z);
  return quat_from_axes(x, cross(z, x), z);
}

/// The parts of an entity, as they come.
struct Parts {
  FlatBufferBuilder& builder;
  std::vector<Offset<foxglove::ArrowPrimitive>> arrows;
  std::vector<Offset<foxglove::SpherePrimitive>> spheres;
  std::vector<Offset<foxglove::CylinderPrimitive>> cylinders;
  std::vector<Offset<foxglove::TriangleListPrimitive>> triangles;
};

void add_sphere(Vec3 centre, double radius, Parts& parts) {
  const auto pose = to_fb(parts.builder, Pose{centre, {}});
  const auto size = to_fb(parts.builder, 2 * radius * Vec3{1, 1, 1});
  const auto colour = paint(parts.builder, kSkin);
  parts.spheres.push_back(foxglove::CreateSpherePrimitive(parts.builder, pose, size, colour));
}

// The cone that touches both spheres; there is none where one holds the other.
void add_cone(Vec3 centre1, double radius1, Vec3 centre2, double radius2, Parts& parts) {
  const double distance = norm(centre2 - centre1);
  if (!(distance > std::fabs(radius1 - radius2))) return;
  const Vec3 axis = (1 / distance) * (centre2 - centre1);
  const double sine = (radius1 - radius2) / distance, cosine = std::sqrt(1 - sine * sine);
  const Vec3 bottom = centre1 + radius1 * sine * axis, top = centre2 + radius2 * sine * axis;
  const double widest = std::max(radius1, radius2);
  const auto pose = to_fb(parts.builder, Pose{0.5 * (bottom + top), with_z_along(axis)});
  const auto size = to_fb(parts.builder, Vec3{2 * widest * cosine, 2 * widest * cosine, norm(top - bottom)});
  const auto colour = paint(parts.builder, kSkin);
  parts.cylinders.push_back(foxglove::CreateCylinderPrimitive(parts.builder, pose, size, radius1 / widest,
                                                              radius2 / widest, colour));
}

void add_triangles(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& indices,
                   const Colour& of, Parts& parts) {
  std::vector<Offset<foxglove::Point3>> corners;
  corners.reserve(points.size());
  for (const Vec3& p : points) corners.push_back(foxglove::CreatePoint3(parts.builder, p.x, p.y, p.z));
  const auto pose = to_fb(parts.builder, Pose{});
  const auto all_corners = parts.builder.CreateVector(corners);
  const auto all_indices = parts.builder.CreateVector(indices);
  const auto colour = paint(parts.builder, of);
  parts.triangles.push_back(
      foxglove::CreateTriangleListPrimitive(parts.builder, pose, all_corners, colour, 0, all_indices));
}

// A palm is round along its edges and flat on both sides.
void add_palm(const SweptPolygon& palm, Parts& parts) {
  const std::uint32_t count = palm.corner_count;
  if (count == 0) return;
  std::vector<Vec3> points;
  std::vector<std::uint32_t> indices;
  for (const double side : {1.0, -1.0}) {
    const auto first = static_cast<std::uint32_t>(points.size());
    for (std::uint32_t i = 0; i < count; ++i)
      points.push_back(palm.corner[i] + side * palm.radius * palm.normal);
    for (std::uint32_t i = 1; i + 1 < count; ++i)
      for (const std::uint32_t corner : {0u, side > 0 ? i : i + 1, side > 0 ? i + 1 : i})
        indices.push_back(first + corner);
  }
  add_triangles(points, indices, kSkin, parts);
  for (std::uint32_t i = 0; i < count; ++i) {
    add_sphere(palm.corner[i], palm.radius, parts);
    add_cone(palm.corner[i], palm.radius, palm.corner[(i + 1) % count], palm.radius, parts);
  }
}

void add_phalanges(const Primitives& hand, Parts& parts) {
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    if (!hand.present[i]) continue;
    const Primitive& whole = hand.capsule[i];
    add_cone(whole.end1, whole.radius1, whole.end2, whole.radius2, parts);
    add_sphere(whole.end1, whole.radius1, parts);
    if (i % 3 == 2 || !hand.present[i + 1]) add_sphere(whole.end2, whole.radius2, parts);
  }
}

// Where a segment's force acts: the centre of its pressure, or the joint at its base.
std::array<Vec3, kSegmentCount> places_of_forces(const Model& model, Scratch& scratch) {
  std::array<Vec3, kSegmentCount> sum{};
  std::array<double, kSegmentCount> weight{};
  const auto add = [&](std::span<const Contact> contacts, const Primitives& hand, const Pose& X_WO) {
    for (const Contact& contact : contacts) {
      const std::size_t segment = hand.primitive[contact.primitive].segment;
      sum[segment] += contact.volume * transform(X_WO, contact.centre);
      weight[segment] += contact.volume;
    }
  };
  if (model.world == nullptr) add(find_contacts(model, scratch), *scratch.primitives, {});
  for (std::size_t i = 0; i < model.apart.size(); ++i) {
    const std::span<const Contact> contacts = find_contacts(model, scratch, i);
    add(contacts, *scratch.apart->primitives, scratch.object_output[i].pose);
  }
  std::array<Vec3, kSegmentCount> place{};
  for (std::size_t s = 0; s < kSegmentCount; ++s)
    place[s] = weight[s] > 0 ? (1 / weight[s]) * sum[s] : scratch.primitives->base_joint[s];
  return place;
}

void add_forces(const ActuatorFrame& output, const std::array<Vec3, kSegmentCount>& places, Parts& parts) {
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    const Vec3 force = output.segment[s].force;
    const double newtons = norm(force);
    if (!(newtons >= kLeastForce)) continue;
    const double length = kArrowScale * newtons, head = std::min(length, 3 * kThickness);
    const auto pose = to_fb(parts.builder, Pose{places[s], with_x_along((1 / newtons) * force)});
    const auto colour = paint(parts.builder, kForce);
    parts.arrows.push_back(foxglove::CreateArrowPrimitive(parts.builder, pose, length - head, kThickness,
                                                          head, 2 * kThickness, colour));
  }
}

Offset<foxglove::SceneEntity> entity(const std::string& id, const std::string& frame, bool goes_along,
                                     std::uint64_t time, const Parts& parts) {
  FlatBufferBuilder& builder = parts.builder;
  const foxglove::Time stamp = to_fb(time);
  const foxglove::Duration for_good{0, 0};
  const auto frame_id = builder.CreateString(frame), name = builder.CreateString(id);
  const auto arrows = builder.CreateVector(parts.arrows);
  const auto spheres = builder.CreateVector(parts.spheres);
  const auto cylinders = builder.CreateVector(parts.cylinders);
  const auto triangles = builder.CreateVector(parts.triangles);
  return foxglove::CreateSceneEntity(builder, &stamp, frame_id, name, &for_good, goes_along, 0, arrows, 0,
                                     spheres, cylinders, 0, triangles);
}

void begin(FlatBufferBuilder& builder) {
  builder.Clear();
  builder.ForceDefaults(true);
}

}  // namespace

Status check_drawable(const Scene& scene, std::size_t most_bytes) {
  std::size_t bytes = 100;
  for (const SceneObject& object : scene.objects)
    bytes += 36 * object.mesh.vertices.size() + 12 * object.mesh.triangles.size() + object.name.size() + 500;
  if (bytes <= most_bytes) return {};
  const auto in_mebibytes = [](std::size_t size) { return std::to_string((size + (1u << 20) - 1) >> 20); };
  return Status::error("the objects are too large to be drawn by others, " + in_mebibytes(bytes) +
                       " MiB of at most " + in_mebibytes(most_bytes) +
                       "; leave out the scene, or use coarser meshes");
}

void draw_objects(const Scene& scene, std::uint64_t time, FlatBufferBuilder& builder) {
  begin(builder);
  std::vector<Offset<foxglove::SceneEntity>> entities;
  std::size_t apart = 0;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    std::vector<std::uint32_t> indices;
    indices.reserve(3 * object.mesh.triangles.size());
    for (const auto& triangle : object.mesh.triangles)
      indices.insert(indices.end(), triangle.begin(), triangle.end());
    Parts parts{builder, {}, {}, {}, {}};
    add_triangles(object.mesh.vertices, indices, kThing, parts);
    const bool moves = is_apart(object);
    // Names need not differ, ids must.
    const std::string id = std::to_string(i) + (object.name.empty() ? "" : " " + object.name);
    entities.push_back(entity(id, moves ? frame_of(apart++) : kWorldFrame, moves, time, parts));
  }
  const auto all = builder.CreateVector(entities);
  builder.Finish(foxglove::CreateSceneUpdate(builder, 0, all));
}

void draw_transforms(const TickRecord& record, std::uint64_t time, FlatBufferBuilder& builder) {
  begin(builder);
  const foxglove::Time stamp = to_fb(time);
  std::vector<Offset<foxglove::FrameTransform>> transforms;
  for (std::size_t i = 0; i < record.object_count; ++i) {
    const auto& [position, orientation] = record.object[i].pose;
    const auto parent = builder.CreateString(kWorldFrame), child = builder.CreateString(frame_of(i));
    const auto translation = to_fb(builder, position);
    const auto rotation = to_fb(builder, orientation);
    transforms.push_back(
        foxglove::CreateFrameTransform(builder, &stamp, parent, child, translation, rotation));
  }
  const auto all = builder.CreateVector(transforms);
  builder.Finish(foxglove::CreateFrameTransforms(builder, all));
}

void draw_hand(const Model& model, Scratch& scratch, const ActuatorFrame& output, std::uint64_t time,
               FlatBufferBuilder& builder) {
  begin(builder);
  const Primitives& placed = *scratch.primitives;
  if (placed.joints.valid == 0) {
    const foxglove::Time stamp = to_fb(time);
    const auto id = builder.CreateString("");
    const std::vector deletions = {
        foxglove::CreateSceneEntityDeletion(builder, &stamp, foxglove::SceneEntityDeletionType::ALL, id)};
    const auto all = builder.CreateVector(deletions);
    builder.Finish(foxglove::CreateSceneUpdate(builder, all));
    return;
  }
  Parts hand{builder, {}, {}, {}, {}}, forces{builder, {}, {}, {}, {}};
  add_phalanges(placed, hand);
  if (placed.joints.has(kPalm)) add_palm(place_palm(model.hand.palm, placed.joints.pose[kPalm]), hand);
  add_forces(output, places_of_forces(model, scratch), forces);
  const std::vector entities = {entity("hand", kWorldFrame, false, time, hand),
                                entity("forces", kWorldFrame, false, time, forces)};
  const auto all = builder.CreateVector(entities);
  builder.Finish(foxglove::CreateSceneUpdate(builder, 0, all));
}

Status check_scene(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint64_t> aligned;
  const auto* const message = verified<foxglove::SceneUpdate>(bytes, aligned);
  if (message == nullptr) return Status::error("a drawn scene does not fit its schema");
  if (message->entities() == nullptr) return {};
  for (const foxglove::SceneEntity* const entity : *message->entities()) {
    if (entity->id() == nullptr || entity->frame_id() == nullptr)
      return Status::error("an entity of a drawn scene has no name or frame");
    if (entity->triangles() == nullptr) continue;
    for (const foxglove::TriangleListPrimitive* const list : *entity->triangles()) {
      const std::size_t count = list->points() == nullptr ? 0 : list->points()->size();
      if (list->indices() == nullptr) continue;
      for (const std::uint32_t index : *list->indices())
        if (index >= count)
          return Status::error("a triangle of a drawn scene has a corner that is not there");
    }
  }
  return {};
}

Status check_transforms(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint64_t> aligned;
  const auto* const message = verified<foxglove::FrameTransforms>(bytes, aligned);
  if (message == nullptr || message->transforms() == nullptr)
    return Status::error("transforms do not fit their schema");
  for (const foxglove::FrameTransform* const transform : *message->transforms())
    if (transform->child_frame_id() == nullptr || transform->translation() == nullptr ||
        transform->rotation() == nullptr)
      return Status::error("a transform is incomplete");
  return {};
}

}  // namespace lumbrical
