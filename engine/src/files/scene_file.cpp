// Scene files: see lumbrical/scene_file.h. Objects and hand are put together in scene_parts.cpp.
#include "lumbrical/scene_file.h"

#include <array>
#include <utility>

#include "base/floating_point.h"
#include "files/json_file.h"
#include "files/scene_mechanics.h"
#include "files/scene_parts.h"
#include "lumbrical/world.h"
#include "model/scene_check.h"
#include "scene_bfbs_generated.h"
#include "scene_generated.h"

namespace lumbrical {
namespace {

namespace format = scene_format;

constexpr double kMaxTicks = 1e9;

Status read_table(const std::string& path, const char* root, JsonFile& file) {
  const std::span schema(format::SceneBinarySchema::data(), format::SceneBinarySchema::size());
  return read_json_file(path, {"scene.fbs", schema, root}, file);
}

bool has_field(const JsonFile& file, const char* name) {
  const TextPlace root = find_json_value(file.text, ""), value = find_json_value(file.text, name);
  return value.line != root.line || value.column != root.column;
}

// What was given for a scene, and what to do with it; null where it is of no kind that is known.
const char* other_kind(const JsonFile& file) {
  const std::string name = lower_case(file.name);
  for (const char* const ending : {".obj", ".stl", ".ply", ".off", ".gltf", ".glb"})
    if (name.ends_with(ending))
      return "this is a mesh, no scene; name it in a scene as the \"mesh\" of an object (README.md, \"A "
             "scene\")";
  if (file.text.starts_with("\x89MCAP0"))
    return "this is a recording, no scene; `lumbrical replay` feels it again";
  for (const char* const field : {"format", "frames", "jointTransforms"})
    if (has_field(file, field))
      return "this is a hand motion, no scene; name it in a scene as \"motion\": {\"file\": ...}, or give it "
             "to --motion";
  if (has_field(file, "transport") || has_field(file, "actuators"))
    return "this is a device profile, no scene; it belongs into the URI of --sink, as profile=FILE";
  return nullptr;
}

Status read_scene(const std::string& path, JsonFile& file) {
  Status status = read_table(path, "lumbrical.scene_format.Scene", file);
  if (status.ok() || file.text.empty()) return status;
  if (const char* const other = other_kind(file)) return Status::error(file.name + ": " + other);
  const bool list = file.text.starts_with('[');  // WebXR's are
  return list ? Status::error(status.message() + "; if this is a hand motion, give it to --motion") : status;
}

// A word that `parse` knows; `otherwise` says what is wrong with others.
template <class Parse, class Value>
void read_word(const flatbuffers::String* word, const std::string& path, const Parse& parse,
               const char* otherwise, FieldReader& read, Value& value) {
  if (word == nullptr) return;
  if (const std::optional<Value> parsed = parse(word->string_view())) {
    value = *parsed;
  } else {
    read.error(path, otherwise);
  }
}

void read_law(const flatbuffers::String* word, const std::string& path, FieldReader& read, Law& law) {
  read_word(word, path, parse_law,
            "is not a law; use \"field\", \"column\", \"max-depth\", \"centroid\" or \"point\"", read, law);
}

void read_segments(const format::Settings& table, FieldReader& read, Settings& settings) {
  if (table.segments() == nullptr) return;
  std::array<bool, kSegmentCount> told{};
  for (flatbuffers::uoffset_t i = 0; i < table.segments()->size(); ++i) {
    const format::SegmentSettings& entry = *table.segments()->Get(i);
    const std::string path = "settings.segments[" + std::to_string(i) + "]";
    const std::optional<int> segment = parse_segment(text_of(entry.segment()));
    if (!segment) {
      read.error(path + ".segment", "is not a hand segment; use \"index distal\", \"palm\" or the like");
    } else if (entry.law() == nullptr && !entry.precision()) {
      read.error(path, "has neither a law nor a precision");
    } else if (std::exchange(told[static_cast<std::size_t>(*segment)], true)) {
      read.error(path + ".segment", "is told a second time; keep one entry of each segment");
    } else {
      const auto number = static_cast<std::size_t>(*segment);
      read_law(entry.law(), path + ".law", read, settings.law[number]);
      read.zero_or_number(entry.precision(), path + ".precision", range::precision,
                          settings.precision[number]);
    }
  }
}

void read_pad(const format::Pad* table, FieldReader& read, Pad& pad) {
  if (table == nullptr) return;
  read.number(table->damping(), "settings.pad.damping", range::pad_damping, pad.damping);
  if (table->layers() == nullptr) return;
  if (table->layers()->size() > kPadLayers) read.error("settings.pad.layers", "has more than two");
  for (flatbuffers::uoffset_t i = 0; i < table->layers()->size() && i < kPadLayers; ++i) {
    const format::PadLayer& layer = *table->layers()->Get(i);
    const std::string path = "settings.pad.layers[" + std::to_string(i) + "]";
    read.number(layer.from(), path + ".from", range::layer_from, pad.layer[i].from);
    read.number(layer.stiffness(), path + ".stiffness", range::layer_stiffness, pad.layer[i].stiffness);
    if (!layer.from() || !layer.stiffness()) read.error(path, "needs \"from\" and \"stiffness\"");
  }
  if (read.ok()) read.check(check_pad(pad));
}

void read_settings(const format::Settings* table, FieldReader& read, Settings& settings) {
  if (table == nullptr) return;
  read.number(table->rate(), "settings.rate", range::rate, settings.rate);
  read.number(table->stiffness(), "settings.stiffness", range::stiffness, settings.stiffness);
  read.number(table->point_area(), "settings.point_area", range::point_area, settings.point_area);
  read.number(table->max_force(), "settings.max_force", range::max_force, settings.max_force);
  read.number(table->fade_time(), "settings.fade_time", range::fade_time, settings.fade_time);
  read.zero_or_number(table->proxy_stiffness(), "settings.proxy_stiffness", range::proxy_stiffness,
                      settings.proxy_stiffness);
  read_word(table->felt_once(), "settings.felt_once", parse_felt_once,
            "has to be \"never\", \"by-samples\" or \"always\"", read, settings.felt_once);
  read_pad(table->pad(), read, settings.pad);
  read.count(table->effort(), "settings.effort", range::effort, settings.effort);
  read.count(table->max_candidates(), "settings.max_candidates", range::max_candidates,
             settings.max_candidates);
  read_law(table->law(), "settings.law", read, settings.law[0]);
  settings.law.fill(settings.law[0]);
  read.zero_or_number(table->precision(), "settings.precision", range::precision, settings.precision[0]);
  settings.precision.fill(settings.precision[0]);
  read_segments(*table, read, settings);
}

void read_execution(const format::Execution* table, FieldReader& read, Execution& execution) {
  if (table == nullptr) return;
  read.count(table->tree_levels(), "execution.tree_levels", range::tree_levels, execution.tree_levels);
  read.count(table->leaf_size(), "execution.leaf_size", range::leaf_size, execution.leaf_size);
  read.number(table->cell_size(), "execution.cell_size", range::cell_size, execution.cell_size);
  read.count(table->threads(), "execution.threads", range::threads, execution.threads);
  read_word(table->broadphase(), "execution.broadphase", parse_broadphase,
            "is no search this version has; use \"auto\", \"tree\", \"grid\", \"voxel\" or \"brute\"", read,
            execution.broadphase);
}

bool says_both(const format::Motion* table, const MotionOverride& chosen) {
  const bool in_scene =
      table != nullptr && table->side() != nullptr && table->side()->string_view() == "both";
  return chosen.both || (in_scene && !chosen.side);
}

// The motion's file with the options of the scene, and of the caller above them.
Status read_motion_file(const format::Motion* table, const MotionOverride& chosen, FieldReader& read,
                        std::optional<Side> hand_side, SceneFile& result) {
  MotionOptions options;
  std::string path = chosen.file;
  options.side = hand_side;
  if (table != nullptr) {
    read.number(table->rate(), "motion.rate", {1e-3, 1e6}, options.rate);
    if (table->side() != nullptr && table->side()->string_view() != "both")
      options.side = read_side(table->side(), "motion.side", read);
    if (table->unit() != nullptr) options.unit = metres_per(read_unit(table->unit(), "motion.unit", read));
    if (path.empty() && table->file() != nullptr)
      path = beside(result.files[0], table->file()->string_view());
  }
  if (!read.ok()) return read.status();
  if (chosen.rate > 0) options.rate = chosen.rate;
  if (chosen.side) options.side = chosen.side;
  if (chosen.unit > 0) options.unit = chosen.unit;
  Status status = says_both(table, chosen)
                      ? load_both_motions(path, options, result.motion, result.second.emplace().motion)
                      : load_motion(path, options, result.motion);
  if (!status.ok()) return chosen.file.empty() ? read.of_file("motion.file", path, status) : status;
  result.files.push_back(path);
  return {};
}

Motion read_grasp(const format::Grasp& table, const Hand& hand, FieldReader& read) {
  double radius = 0.037;
  double height = 0.095;
  double seconds = 10;
  read.number(table.radius(), "motion.grasp.radius", {0.005, 0.1}, radius);
  read.number(table.height(), "motion.grasp.height", {0.01, 1}, height);
  read.number(table.seconds(), "motion.grasp.seconds", {0.5, 3600}, seconds);
  double lift = 0;
  read.number(table.lift(), "motion.grasp.lift", {0, 1}, lift);
  return make_grasp(hand, radius, height, seconds, lift);
}

void read_placement(const format::Motion* table, FieldReader& read, MotionPlacement& placement) {
  if (table == nullptr) return;
  read.number(table->scale(), "motion.scale", {1e-6, 1e6}, placement.scale);
  read.pose(table->position(), "motion.position", table->orientation(), "motion.orientation", placement.pose);
}

// Places the motion, and makes the hand that belongs to it. What the file says goes above what the motion
// knows; it says it of the described hand, whose mirror image the other one is.
Status fit(const Hand& described, const format::Hand* table, const std::string& at,
           const MotionPlacement& placement, FieldReader& read, FieldReader& hand_read, Motion& motion,
           Hand& hand) {
  if (Status status = place_motion(placement, motion); !status.ok()) {
    read.error("motion", "can't be placed: " + status.message());
    return read.status();
  }
  hand = fit_hand(described, motion);
  const bool other = described.side != hand.side;
  if (other) hand = mirrored_hand(hand);
  read_flesh(table, at, hand_read, hand);
  if (other) hand = mirrored_hand(hand);
  hand_read.check(check_hand(hand));
  return hand_read.status();
}

// Of the built-in grasp: the side that the motion or the caller says, and no word of what only files have.
void read_side_of_grasp(const format::Motion& table, const MotionOverride& chosen, FieldReader& read,
                        std::optional<Side>& side) {
  if (table.unit() != nullptr) read.error("motion.unit", "has no meaning for the built-in grasp");
  if (table.rate().has_value()) read.error("motion.rate", "has no meaning for the built-in grasp");
  if (chosen.unit > 0 || chosen.rate > 0)
    read.error(
        "motion",
        "is the built-in grasp, for which a file's unit (--unit) and rate (--motion-rate) have no meaning");
  std::optional<Side> asked = chosen.side;
  if (!asked && table.side() != nullptr) asked = read_side(table.side(), "motion.side", read);
  if (asked && side && *asked != *side)
    read.error("motion.side", "is not the side of the hand");
  else if (asked)
    side = asked;
}

// The hand's table comes from the scene file or from a file of its own; `hand_read` reads whichever it is.
Status read_hand_and_motion(const format::Scene& scene, const format::Hand* hand_table, const std::string& at,
                            const MotionOverride& chosen, FieldReader& read, FieldReader& hand_read,
                            SceneFile& result) {
  const format::Motion* const table = scene.motion();
  const bool from_file = !chosen.file.empty() || (table != nullptr && table->file() != nullptr);
  const bool grasp = chosen.file.empty() && table != nullptr && table->grasp() != nullptr;
  if (from_file && grasp) read.error("motion", "names a file and a grasp; keep one");
  if (!from_file && !grasp) read.error("motion", "is missing; name a file or a grasp");
  if (grasp && says_both(table, chosen))
    read.error("motion", "is the built-in grasp, which is of one hand; both take a capture of both");

  std::optional<Side> side;
  if (hand_table != nullptr && hand_table->side() != nullptr) {
    side = read_side(hand_table->side(), at + "side", hand_read);
  }
  if (grasp && read.ok()) read_side_of_grasp(*table, chosen, read, side);
  if (!hand_read.ok()) return hand_read.status();
  if (!read.ok()) return read.status();
  if (from_file) {
    if (Status status = read_motion_file(table, chosen, read, side, result); !status.ok()) return status;
    if (side && !result.second && *side != result.motion.side) {
      hand_read.error(at + "side", "is not the side of the motion");
      return hand_read.status();
    }
    if (!result.second || !side) side = result.motion.side;
  }

  Hand& hand = result.scene.hand;
  hand = read_hand(hand_table, at, side.value_or(Side::right), hand_read);
  if (!hand_read.ok()) return hand_read.status();
  if (grasp) result.motion = read_grasp(*table->grasp(), hand, read);
  MotionPlacement& placement = result.placement;
  read_placement(table, read, placement);
  if (!read.ok()) return read.status();
  const Hand described = hand;
  if (Status status = fit(described, hand_table, at, placement, read, hand_read, result.motion, hand);
      !status.ok() || !result.second)
    return status;
  return fit(described, hand_table, at, placement, read, hand_read, result.second->motion,
             result.second->hand);
}

// Two hands move as one: until the first of them touches, or so that the target lies midway between them.
Status find_common_shift(const SceneFile& scene_file, const Alignment& alignment, Vec3& shift) {
  const Scene& scene = scene_file.scene;
  if (Status status = find_shift(scene, scene_file.motion, scene_file.seconds, alignment, shift);
      !status.ok() || !scene_file.second)
    return status;
  Vec3 second;
  Scene other = scene;
  other.hand = scene_file.second->hand;
  if (Status status = find_shift(other, scene_file.second->motion, scene_file.seconds, alignment, second);
      !status.ok())
    return status;
  if (alignment.target != Alignment::Target::contact)
    shift = 0.5 * (shift + second);
  else if (norm(second) < norm(shift))
    shift = second;
  return {};
}

// Once hand, motion and objects are there.
Status align_motion(const format::Motion* table, const MotionOverride& chosen, FieldReader& read,
                    SceneFile& result) {
  std::optional<Alignment> alignment = chosen.align;
  if (!alignment && table != nullptr && table->align() != nullptr) {
    alignment = parse_alignment(table->align()->string_view());
    if (!alignment) {
      read.error("motion.align", std::string("must be ") + kAlignmentForms);
      return read.status();
    }
  }
  if (!alignment) return {};
  Vec3 shift;
  if (Status status = find_common_shift(result, *alignment, shift); !status.ok()) {
    read.error("motion", "can't be aligned: " + status.message());
    return read.status();
  }
  result.placement.pose.position += shift;
  result.aligned = true;
  result.touching = alignment->target == Alignment::Target::contact && norm(shift) == 0;
  Status status = place_motion({{shift, {}}, 1}, result.motion);
  if (status.ok() && result.second) status = place_motion({{shift, {}}, 1}, result.second->motion);
  return status;
}

Status read_session(const format::Scene& table, FieldReader& read, SceneFile& result) {
  read_settings(table.settings(), read, result.scene.settings);
  read_execution(table.execution(), read, result.execution);
  result.seconds = duration(result.motion);
  if (result.motion.samples.size() < 2) result.seconds = 1;
  const double longest = kMaxTicks / result.scene.settings.rate;
  if (table.settings() != nullptr && table.settings()->seconds().has_value()) {
    read.number(table.settings()->seconds(), "settings.seconds", {1e-5, longest}, result.seconds);
  } else if (!(result.seconds <= longest)) {
    read.error("motion", "lasts " + text_of(result.seconds) + " s, which is more than 1e9 ticks; give " +
                             "settings.seconds, at most " + text_of(longest));
  }
  return read.status();
}

constexpr std::size_t kMaxTriangles = std::size_t{1} << 26;  // all of them are in memory

Status read_world(const format::Scene& scene, FieldReader& read, SceneFile& result) {
  const format::Execution* const execution = scene.execution();
  const bool sized =
      execution != nullptr && (execution->cell_size().has_value() || execution->leaf_size().has_value() ||
                               execution->tree_levels().has_value());
  if (sized)
    read.error("execution",
               "gives sizes of a grid that the world file has already; leave out cell_size, "
               "leaf_size and tree_levels, or build the world with them");
  if (!read.ok()) return read.status();
  result.files.push_back(beside(result.files[0], scene.world()->string_view()));
  return read.of_file("world", result.files.back(), open_world(result.files.back(), result.scene.world));
}

bool is_given_with_mass(const SceneObject& object) {
  return object.mechanism.mobility == Mobility::given && object.mechanism.body.mass > 0;
}

Status read_things(const format::Scene& scene, FieldReader& read, SceneFile& result) {
  read_surroundings(scene, read, result.scene);
  if (scene.world() != nullptr)
    if (Status status = read_world(scene, read, result); !status.ok()) return status;
  std::size_t triangles = 0;
  const auto take = [&](SceneObject&& object, ObjectPath&& path) {
    if (scene.world() != nullptr && !is_apart(object))
      return Status::error("stands still beside a world file; put it into the world (lumbrical world)");
    triangles += object.mesh.triangles.size();
    if (triangles > kMaxTriangles)
      return Status::error(
          "brings the scene above 67,108,864 triangles; make it a world file (lumbrical world)");
    if (object.mechanism.mobility == Mobility::given) result.paths.push_back(std::move(path));
    result.scene.objects.push_back(std::move(object));
    return Status();
  };
  if (scene.world() == nullptr || scene.objects() != nullptr)
    if (Status status = read_objects(scene, read, result.files, take); !status.ok()) return status;
  read_latches(scene, read, result.scene.objects);
  read_physics(scene, read, result.physics);
  if (result.physics && scene.world() != nullptr)
    read.error("physics", "stands beside a world file, through which its bodies would fall; name objects");
  else if (result.physics &&
           std::none_of(result.scene.objects.begin(), result.scene.objects.end(), is_given_with_mass))
    read.error("physics", "moves what has \"moves\": \"given\" and a mass or density, and nothing has");
  return read.status();
}

}  // namespace

Status load_scene_objects(const std::string& path, const std::function<Status(const Execution&)>& begin,
                          const std::function<Status(SceneObject&&)>& take) {
  const FloatingPointGuard guard;
  JsonFile file;
  if (Status status = read_scene(path, file); !status.ok()) return status;
  const format::Scene& scene = *format::GetScene(file.buffer.data());
  FieldReader read(file);
  if (scene.world() != nullptr) read.error("world", "is a world file already; name objects");
  Execution execution;
  read_execution(scene.execution(), read, execution);
  if (!read.ok()) return read.status();
  if (Status status = begin(execution); !status.ok()) return status;
  std::vector<std::string> files = {path};
  return read_objects(scene, read, files,
                      [&](SceneObject&& object, ObjectPath&&) { return take(std::move(object)); });
}

Status load_scene_file(const std::string& path, SceneFile& scene_file, const MotionOverride& motion) {
  const FloatingPointGuard guard;
  JsonFile file;
  if (Status status = read_scene(path, file); !status.ok()) return status;
  const format::Scene& scene = *format::GetScene(file.buffer.data());
  FieldReader read(file);
  SceneFile result;
  result.files.push_back(path);

  const format::Hand* hand_table = scene.hand();
  JsonFile hand_file;
  if (scene.hand_file() != nullptr) {
    if (hand_table != nullptr) read.error("hand_file", "stands beside a hand; keep one");
    if (!read.ok()) return read.status();
    const std::string hand_path = beside(path, scene.hand_file()->string_view());
    Status status = read_table(hand_path, "lumbrical.scene_format.Hand", hand_file);
    if (!status.ok()) return read.of_file("hand_file", hand_path, status);
    hand_table = flatbuffers::GetRoot<format::Hand>(hand_file.buffer.data());
    result.files.push_back(hand_path);
  }
  FieldReader hand_read(scene.hand_file() != nullptr ? hand_file : file);
  const std::string at = scene.hand_file() != nullptr ? "" : "hand.";

  Status status = read_hand_and_motion(scene, hand_table, at, motion, read, hand_read, result);
  if (status.ok()) status = read_session(scene, read, result);
  if (status.ok()) status = read_things(scene, read, result);
  if (status.ok()) status = align_motion(scene.motion(), motion, read, result);
  if (!status.ok()) return status;
  scene_file = std::move(result);
  return {};
}

Status check_plain(const SceneFile& scene_file) {
  const std::string path = scene_file.files.empty() ? "scene" : scene_file.files[0];
  if (scene_file.second)
    return Status::error(
        path +
        ": motion: is of both hands, and a scene here has one; give motion.side as \"right\" or "
        "\"left\", in a file for each hand");
  if (scene_file.physics)
    return Status::error(path +
                         ": physics: only `lumbrical run` moves bodies so; leave it out, and tell each tick "
                         "where given objects are, or let them move by themselves (\"moves\": \"free\")");
  std::size_t given = 0;
  const std::vector<SceneObject>& objects = scene_file.scene.objects;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i].mechanism.mobility != Mobility::given) continue;
    const std::size_t number = given++;
    if (number >= scene_file.paths.size() || scene_file.paths[number].empty()) continue;
    return Status::error(path + ": objects[" + std::to_string(i) +
                         "].path: only `lumbrical run` moves objects along it; leave it out, and tell each "
                         "tick where the object is");
  }
  return {};
}

}  // namespace lumbrical
