// Encoding and checked decoding of the session attachment.
#include "recording/session_message.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <utility>

#include "base/message_alignment.h"
#include "model/apart_objects.h"
#include "model/ranges.h"
#include "recording_generated.h"

namespace lumbrical {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;

// The engine's arrays and the schema's structs lie alike in memory, so meshes are copied in one go.
static_assert(sizeof(fb::Vec3) == sizeof(Vec3) && sizeof(fb::Triangle) == sizeof(Triangle));

fb::Vec3 to_fb(Vec3 v) { return std::bit_cast<fb::Vec3>(v); }
Vec3 from_fb(const fb::Vec3& v) { return std::bit_cast<Vec3>(v); }
fb::Pose to_fb(const Pose& pose) { return std::bit_cast<fb::Pose>(pose); }
Pose from_fb(const fb::Pose& pose) { return std::bit_cast<Pose>(pose); }

Offset<flatbuffers::Vector<const fb::Vec3*>> to_fb(FlatBufferBuilder& builder,
                                                   const std::vector<Vec3>& points) {
  return builder.CreateVectorOfStructs(reinterpret_cast<const fb::Vec3*>(points.data()), points.size());
}

std::vector<Vec3> from_fb(const flatbuffers::Vector<const fb::Vec3*>* points) {
  std::vector<Vec3> result(points != nullptr ? points->size() : 0);
  if (!result.empty()) std::memcpy(result.data(), points->Data(), result.size() * sizeof(Vec3));
  return result;
}

Offset<fb::Finger> to_fb(FlatBufferBuilder& builder, const Finger& finger) {
  std::array<fb::AngleLimit, 4> limits;
  for (std::size_t i = 0; i < limits.size(); ++i) limits[i] = {finger.limit[i].lower, finger.limit[i].upper};
  const fb::Pose base = to_fb(finger.base);
  const auto lengths = builder.CreateVector(finger.bone_length.data(), finger.bone_length.size());
  return fb::CreateFinger(builder, &base, lengths,
                          builder.CreateVectorOfStructs(limits.data(), limits.size()));
}

Offset<fb::Hand> to_fb(FlatBufferBuilder& builder, const Hand& hand) {
  std::array<Offset<fb::Finger>, kFingerCount> fingers;
  for (std::size_t f = 0; f < kFingerCount; ++f) fingers[f] = to_fb(builder, hand.finger[f]);
  const auto radii = builder.CreateVector(hand.radius.data(), hand.radius.size());
  const auto all_fingers = builder.CreateVector(fingers.data(), fingers.size());
  const auto polygon = to_fb(builder, hand.palm.polygon);
  const fb::Pose palm_joint = to_fb(hand.palm_joint);
  return fb::CreateHand(builder, static_cast<fb::Side>(hand.side), radii, all_fingers, polygon,
                        hand.palm.height, hand.palm.thickness, &palm_joint);
}

fb::Mechanism to_fb(const Mechanism& m) {
  const auto& [mass, centre, inertia] = m.body;
  return {mass,
          to_fb(centre),
          fb::Inertia(inertia[0], inertia[1], inertia[2], inertia[3], inertia[4], inertia[5]),
          m.damping,
          to_fb(m.pivot),
          to_fb(m.axis),
          m.lower,
          m.upper,
          m.spring,
          m.rest,
          m.dry_friction,
          m.detent_force,
          m.detent_pitch};
}

Mechanism from_fb(const fb::Mechanism& m, Mobility mobility) {
  Mechanism mechanism;
  mechanism.mobility = mobility;
  const fb::Inertia& i = m.inertia();
  mechanism.body = {m.mass(), from_fb(m.centre()), {i.xx(), i.yy(), i.zz(), i.xy(), i.yz(), i.zx()}};
  mechanism.damping = m.damping();
  mechanism.pivot = from_fb(m.pivot());
  mechanism.axis = from_fb(m.axis());
  mechanism.lower = m.lower();
  mechanism.upper = m.upper();
  mechanism.spring = m.spring();
  mechanism.rest = m.rest();
  mechanism.dry_friction = m.dry_friction();
  mechanism.detent_force = m.detent_force();
  mechanism.detent_pitch = m.detent_pitch();
  return mechanism;
}

Offset<fb::Texture> to_fb(FlatBufferBuilder& builder, const Texture& texture) {
  if (is_plain(texture)) return {};
  const auto& [width, height, grey] = texture.image;
  const auto greys = builder.CreateVector(grey.data(), grey.size());
  return fb::CreateTexture(builder, width, height, greys, texture.period, texture.black, texture.white);
}

Offset<fb::Surface> to_fb(FlatBufferBuilder& builder, const Surface& surface) {
  if (is_plain(surface)) return {};
  const auto factors = builder.CreateVector(surface.friction_factor.data(), surface.friction_factor.size());
  const auto grip = to_fb(builder, surface.grip), bumps = to_fb(builder, surface.bumps);
  return fb::CreateSurface(builder, surface.crease_angle, factors, grip, bumps);
}

// Copied as bytes: the file may hold them anywhere.
template <class T>
std::vector<T> numbers_of(const flatbuffers::Vector<T>* numbers) {
  std::vector<T> result(numbers != nullptr ? numbers->size() : 0);
  if (!result.empty()) std::memcpy(result.data(), numbers->Data(), result.size() * sizeof(T));
  return result;
}

Texture from_fb(const fb::Texture* texture) {
  if (texture == nullptr) return {};
  return {{texture->width(), texture->height(), numbers_of(texture->grey())},
          texture->period(),
          texture->black(),
          texture->white()};
}

Surface from_fb(const fb::Surface* surface) {
  if (surface == nullptr) return {};
  return {surface->crease_angle(), numbers_of(surface->friction_factor()), from_fb(surface->grip()),
          from_fb(surface->bumps())};
}

std::size_t size_of(const fb::Surface* surface) {
  if (surface == nullptr) return 0;
  const auto texels = [](const fb::Texture* texture) {
    return texture != nullptr && texture->grey() != nullptr ? std::size_t{texture->grey()->size()} : 0;
  };
  const auto* const factors = surface->friction_factor();
  return sizeof(std::uint16_t) * (texels(surface->grip()) + texels(surface->bumps())) +
         sizeof(double) * (factors != nullptr ? factors->size() : 0);
}

// As a model takes it: readers take meshes as they are.
Offset<fb::Object> to_fb(FlatBufferBuilder& builder, const SceneObject& object) {
  if (object.winding != Winding::as_is) {
    SceneObject turned = object;
    wind_outwards(turned.mesh, object.winding);
    turned.winding = Winding::as_is;
    return to_fb(builder, turned);
  }
  const Mesh& mesh = object.mesh;
  const auto name = builder.CreateString(object.name);
  const auto vertices = to_fb(builder, mesh.vertices);
  const auto triangles = builder.CreateVectorOfStructs(
      reinterpret_cast<const fb::Triangle*>(mesh.triangles.data()), mesh.triangles.size());
  if (!is_apart(object)) return fb::CreateObject(builder, name, vertices, triangles);
  const fb::Pose pose = to_fb(object.pose);
  const auto material = std::bit_cast<fb::Material>(object.material);
  const fb::Mechanism mechanism = to_fb(object.mechanism);
  const auto surface = to_fb(builder, object.surface);
  const fb::Latch latch(object.mechanism.latch.object, object.mechanism.latch.opens);
  return fb::CreateObject(builder, name, vertices, triangles, &pose, &material,
                          static_cast<fb::Mobility>(object.mechanism.mobility), &mechanism,
                          object.mechanism.latch == Latch{} ? nullptr : &latch, surface);
}

Offset<fb::Settings> to_fb(FlatBufferBuilder& builder, const Settings& settings) {
  std::array<std::uint8_t, kSegmentCount> laws;
  for (std::size_t s = 0; s < kSegmentCount; ++s) laws[s] = static_cast<std::uint8_t>(settings.law[s]);
  const auto all_laws = builder.CreateVectorScalarCast<fb::Law>(laws.data(), laws.size());
  const auto precisions = builder.CreateVector(settings.precision.data(), settings.precision.size());
  const auto pad = std::bit_cast<fb::Pad>(settings.pad);
  return fb::CreateSettings(builder, all_laws, settings.stiffness, settings.rate, settings.point_area,
                            settings.max_force, settings.fade_time, settings.max_candidates, precisions,
                            settings.effort, settings.proxy_stiffness, settings.pad == Pad{} ? nullptr : &pad,
                            static_cast<fb::FeltOnce>(settings.felt_once));
}

/// Of the path, what may stand in a recording: files are looked for beside it, nowhere else. Empty where it
/// leads to no file.
std::string file_name(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  return name == "." || name == ".." ? std::string() : name;
}

/// Room the objects take in the message, rounded up.
double size_of(const Scene& scene) {
  double bytes = 0;
  for (const SceneObject& object : scene.objects) {
    const Surface& surface = object.surface;
    bytes += 24.0 * static_cast<double>(object.mesh.vertices.size()) +
             12.0 * static_cast<double>(object.mesh.triangles.size()) +
             8.0 * static_cast<double>(surface.friction_factor.size()) +
             2.0 * static_cast<double>(surface.grip.image.grey.size() + surface.bumps.image.grey.size()) +
             static_cast<double>(object.name.size()) + 500;
  }
  return bytes;
}

Status decode_finger(const fb::Finger* message, Finger& finger) {
  const auto* const lengths = message != nullptr ? message->bone_lengths() : nullptr;
  const auto* const limits = message != nullptr ? message->limits() : nullptr;
  if (lengths == nullptr || lengths->size() != 4 || limits == nullptr || limits->size() != 4 ||
      message->base() == nullptr || !is_aligned(lengths) || !is_aligned(limits))
    return Status::error("a finger of the session's hand is incomplete");
  finger.base = from_fb(*message->base());
  for (std::uint32_t i = 0; i < 4; ++i) {
    finger.bone_length[i] = lengths->Get(i);
    finger.limit[i] = {limits->Get(i)->lower(), limits->Get(i)->upper()};
  }
  return {};
}

Status decode_hand(const fb::Hand* message, Hand& hand) {
  if (message == nullptr || message->radii() == nullptr || message->radii()->size() != kJointCount ||
      message->fingers() == nullptr || message->fingers()->size() != kFingerCount ||
      message->palm_joint() == nullptr || !is_aligned(message->radii()))
    return Status::error("the session's hand is incomplete");
  if (message->side() > fb::Side::MAX) return Status::error("the session's hand is neither left nor right");
  hand.side = static_cast<Side>(message->side());
  for (std::uint32_t j = 0; j < kJointCount; ++j) hand.radius[j] = message->radii()->Get(j);
  for (std::uint32_t f = 0; f < kFingerCount; ++f) {
    if (Status status = decode_finger(message->fingers()->Get(f), hand.finger[f]); !status.ok())
      return status;
  }
  hand.palm = {from_fb(message->palm_polygon()), message->palm_height(), message->palm_thickness()};
  hand.palm_joint = from_fb(*message->palm_joint());
  return check_hand(hand);
}

Status decode_settings(const fb::Settings* message, Settings& settings) {
  if (message == nullptr || message->laws() == nullptr || message->laws()->size() != kSegmentCount ||
      message->precisions() == nullptr || message->precisions()->size() != kSegmentCount ||
      !is_aligned(message->precisions()))
    return Status::error("the session's settings are incomplete");
  for (std::uint32_t s = 0; s < kSegmentCount; ++s) {
    const auto law = static_cast<fb::Law>(message->laws()->Get(s));
    if (law > fb::Law::MAX) return Status::error("the session names an unknown law");
    settings.law[s] = static_cast<Law>(law);
    settings.precision[s] = message->precisions()->Get(s);
  }
  settings.stiffness = message->stiffness();
  settings.rate = message->rate();
  settings.point_area = message->point_area();
  settings.max_force = message->max_force();
  settings.fade_time = message->fade_time();
  settings.max_candidates = message->max_candidates();
  settings.effort = message->effort();
  settings.proxy_stiffness = message->proxy_stiffness();
  if (message->felt_once() > fb::FeltOnce::MAX)
    return Status::error("the session says in an unknown way what is felt once");
  settings.felt_once = static_cast<FeltOnce>(message->felt_once());
  if (const fb::Pad* const pad = message->pad()) settings.pad = std::bit_cast<Pad>(*pad);
  // Session time is computed from the rate before build_model sees it.
  if (!range::rate.holds(settings.rate)) return Status::error("the session's rate is out of range");
  return {};
}

// What is out of range build_model refuses.
Status decode_apart(const fb::Object& message, SceneObject& object) {
  if (message.mobility() > fb::Mobility::MAX) return Status::error("the session names an unknown mobility");
  if (message.pose() != nullptr) object.pose = from_fb(*message.pose());
  if (const fb::Material* const m = message.material()) object.material = std::bit_cast<Material>(*m);
  object.surface = from_fb(message.surface());
  const auto mobility = static_cast<Mobility>(message.mobility());
  if (message.mechanism() != nullptr) {
    object.mechanism = from_fb(*message.mechanism(), mobility);
  } else if (mobility != Mobility::fixed) {
    return Status::error("the session has an object that moves, but not how");
  }
  if (const fb::Latch* const l = message.latch()) object.mechanism.latch = {l->object(), l->opens()};
  object.mechanism = without_meaningless(object.mechanism);
  return {};
}

Status decode_objects(const fb::Session& message, std::size_t size, std::vector<SceneObject>& objects) {
  if (message.objects() == nullptr) return {};
  if (message.objects()->size() > kMostSceneObjects)
    return Status::error("the session has more than 32768 objects");
  // Many objects of a forged file may share one array, or be one object: together they must not be larger
  // than the file.
  std::size_t room = size;
  objects.reserve(message.objects()->size());
  for (const fb::Object* const object : *message.objects()) {
    SceneObject& out = objects.emplace_back();
    out.winding = Winding::as_is;  // it was felt like this
    const auto* const vertices = object->vertices();
    const auto* const triangles = object->triangles();
    const std::size_t needed = (vertices != nullptr ? vertices->size() * sizeof(Vec3) : 0) +
                               (triangles != nullptr ? triangles->size() * sizeof(Triangle) : 0) +
                               (object->name() != nullptr ? object->name()->size() : 0) +
                               size_of(object->surface());
    if (needed > room) return Status::error("the session's objects overlap");
    room -= needed;
    if (object->name() != nullptr) out.name = object->name()->str();
    if (Status status = decode_apart(*object, out); !status.ok()) return status;
    out.mesh.vertices = from_fb(vertices);
    if (triangles == nullptr || triangles->size() == 0) continue;
    out.mesh.triangles.resize(triangles->size());
    std::memcpy(out.mesh.triangles.data(), triangles->Data(), triangles->size() * sizeof(Triangle));
  }
  return {};
}

Status decode_world(const fb::Session& message, Scene& scene) {
  if (message.world() == nullptr) return {};
  const bool stands_still = std::any_of(scene.objects.begin(), scene.objects.end(),
                                        [](const SceneObject& object) { return !is_apart(object); });
  if (message.world()->path() == nullptr || stands_still)
    return Status::error("the session's world is neither in it nor a file");
  auto world = std::make_shared<World>();
  world->path = message.world()->path()->str();
  if (world->path != file_name(world->path))
    return Status::error("the session's world is not a file beside the recording; it names \"" + world->path +
                         "\"");
  world->content = message.world()->content();
  world->byte_count = message.world()->bytes();
  scene.world = std::move(world);
  return {};
}

}  // namespace

Status encode_session(const Scene& scene, std::vector<std::uint8_t>& bytes,
                      const std::optional<Hand>& second) {
  if (size_of(scene) > 2147000000.0)
    return Status::error("the scene takes 2 GiB or more and can't be recorded; use coarser meshes");
  FlatBufferBuilder builder;
  builder.ForceDefaults(true);  // a number left out because it equals its default might have been -0
  std::vector<Offset<fb::Object>> objects;
  for (const SceneObject& object : scene.objects) objects.push_back(to_fb(builder, object));
  const auto all_objects = builder.CreateVector(objects);
  const auto hand = to_fb(builder, scene.hand);
  const auto settings = to_fb(builder, scene.settings);
  const auto second_hand = second ? to_fb(builder, *second) : Offset<fb::Hand>();
  Offset<fb::WorldFile> world;
  if (scene.world)
    world = fb::CreateWorldFile(builder, builder.CreateString(file_name(scene.world->path)),
                                scene.world->content, scene.world->byte_count);
  const fb::Vec3 gravity = to_fb(scene.gravity);
  fb::Ground ground;
  if (scene.ground) ground = std::bit_cast<fb::Ground>(*scene.ground);
  builder.Finish(fb::CreateSession(builder, kVersion, hand, all_objects, settings, world, second_hand,
                                   &gravity, scene.ground ? &ground : nullptr));
  bytes.assign(builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize());
  return {};
}

Status decode_session(std::span<const std::uint8_t> bytes, Scene& scene, std::optional<Hand>* second) {
  if (!can_be_verified(bytes))
    return Status::error("the session takes 2 GiB or more, which no recording holds");
  // FlatBuffers reads its numbers in place; what was read from a file is aligned already.
  std::vector<std::uint64_t> aligned;
  const std::uint8_t* data = bytes.data();
  if (reinterpret_cast<std::uintptr_t>(data) % alignof(std::uint64_t) != 0) {
    aligned.resize(bytes.size() / 8 + 1);  // never empty: memcpy wants a place
    std::memcpy(aligned.data(), bytes.data(), bytes.size());
    data = reinterpret_cast<const std::uint8_t*>(aligned.data());
  }
  constexpr flatbuffers::uoffset_t kDepth = 8, kTables = std::numeric_limits<flatbuffers::uoffset_t>::max();
  flatbuffers::Verifier verifier(data, bytes.size(), kDepth, kTables);
  if (!verifier.VerifyBuffer<fb::Session>(nullptr))
    return Status::error("the session does not fit its schema");
  const fb::Session& message = *flatbuffers::GetRoot<fb::Session>(data);
  if (message.version() != kVersion)
    return Status::error("the session is of version " + std::to_string(message.version()) +
                         ", this program reads version " + std::to_string(kVersion) +
                         "; use the program that wrote it or a newer one");

  Scene decoded;
  if (Status status = decode_hand(message.hand(), decoded.hand); !status.ok()) return status;
  if (Status status = decode_settings(message.settings(), decoded.settings); !status.ok()) return status;
  if (Status status = decode_objects(message, bytes.size(), decoded.objects); !status.ok()) return status;
  if (Status status = decode_world(message, decoded); !status.ok()) return status;
  std::optional<Hand> other;
  if (message.second_hand() != nullptr) {
    if (Status status = decode_hand(message.second_hand(), other.emplace()); !status.ok()) return status;
    if (other->side == decoded.hand.side)
      return Status::error("both hands of the session are " + std::string(side_name(other->side)) + " ones");
  }
  if (second != nullptr) *second = std::move(other);
  if (message.gravity() != nullptr) decoded.gravity = from_fb(*message.gravity());
  if (const fb::Ground* const ground = message.ground()) decoded.ground = std::bit_cast<Ground>(*ground);
  scene = std::move(decoded);
  return {};
}

}  // namespace lumbrical
