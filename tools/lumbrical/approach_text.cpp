// See approach_text.h.
#include "approach_text.h"

#include <array>
#include <cmath>

#include "lumbrical/hand.h"

namespace lumbrical::tool {
namespace {

constexpr double kSmallest = 0.005, kLargest = 3;    // [m] extents that need no question
constexpr double kHandiest = 0.1;                    // [m]
constexpr double kFewestHeld = 0.01, kMostHeld = 1;  // [m] that another unit would have to make of it

bool is_empty(const Box& box) { return box.lower.x > box.upper.x; }

double extent_of(const Box& box) {
  const Vec3 size = box.upper - box.lower;
  return max(size.x, max(size.y, size.z));
}

std::string span_text(const Box& box) {
  const auto axis = [](const char* name, double lower, double upper) {
    return std::string(name) + " " + brief(lower) + " .. " + brief(upper);
  };
  return axis("x", box.lower.x, box.upper.x) + ", " + axis("y", box.lower.y, box.upper.y) + ", " +
         axis("z", box.lower.z, box.upper.z) + " m";
}

Json span_json(const Box& box) {
  return is_empty(box) ? Json(nullptr) : Json{{"lower", to_json(box.lower)}, {"upper", to_json(box.upper)}};
}

std::string name_of(const Scene& scene, std::size_t object) {
  return object < scene.objects.size() ? scene.objects[object].name : "world";
}

// Null where the hand was not measured against the object.
const Approach* approach_to(const Clearance& clearance, std::size_t object) {
  if (object >= clearance.approach.size() || !(clearance.approach[object].distance < 1e300)) return nullptr;
  return &clearance.approach[object];
}

// [m] More is no rounding and no resting.
constexpr double kSunk = 1e-3;

// [m] How far below the ground an object begins that rests on it; of others, and where there is none, 0.
double sunk_by(const Scene& scene, std::size_t number) {
  if (!scene.ground || number >= scene.objects.size()) return 0;
  const SceneObject& object = scene.objects[number];
  if (object.mechanism.mobility != Mobility::free) return 0;
  double sunk = 0;
  for (const Vec3 vertex : object.mesh.vertices)
    sunk = max(sunk, scene.ground->offset - dot(scene.ground->normal, transform(object.pose, vertex)));
  return sunk;
}

}  // namespace

std::string hand_text(const Motion& motion) {
  const auto name = [](Side side) { return std::string(side == Side::left ? "left" : "right"); };
  std::string text = name(motion.side);
  if (motion.other_frames == 0) return text;
  text += "; " + grouped(motion.other_frames) + " frames show another one, a " + name(motion.other_side);
  return text + (motion.other_side == motion.side ? ", which is left out"
                                                  : ": --side " + name(motion.other_side) + " takes that");
}

std::string length_text(double metres) {
  return std::fabs(metres) < 1 ? brief(1000 * metres) + " mm" : brief(metres) + " m";
}

std::string likely_unit(double extent) {
  struct Mistake {
    double factor;
    const char* text;
  };
  constexpr std::array<Mistake, 6> kMistakes = {{{0.001, "mm read as m"},
                                                 {0.01, "cm read as m"},
                                                 {0.1, "mm read as cm"},
                                                 {10, "cm read as mm"},
                                                 {100, "m read as cm"},
                                                 {1000, "m read as mm"}}};
  if (extent >= kSmallest && extent <= kLargest) return {};
  std::string text;
  double best = 1e300;
  for (const Mistake& mistake : kMistakes) {
    const double corrected = extent * mistake.factor, off = std::fabs(std::log(corrected / kHandiest));
    if (!(corrected >= kFewestHeld && corrected <= kMostHeld && off < best)) continue;
    best = off;
    text = mistake.text;
  }
  return text;
}

Json pose_json(const Pose& pose) {
  const auto& [p, q] = pose;
  return {{"position", {p.x, p.y, p.z}}, {"orientation", {q.w, q.x, q.y, q.z}}};
}

std::string pose_text(const Pose& pose) {
  const std::string object = pose_json(pose).dump();
  return object.substr(1, object.size() - 2);
}

Json to_json(const Clearance& clearance, const Scene& scene) {
  Json json;
  json["hand"] = span_json(clearance.hand);
  json["objects"] = Json::array();
  for (std::size_t i = 0; i < clearance.object.size(); ++i) {
    Json object = {{"name", name_of(scene, i)}, {"box", span_json(clearance.object[i])}};
    if (!is_empty(clearance.object[i])) object["likely_unit"] = likely_unit(extent_of(clearance.object[i]));
    if (const double sunk = sunk_by(scene, i); sunk > kSunk) object["below_ground"] = sunk;
    if (const Approach* const approach = approach_to(clearance, i)) {
      object["distance"] = approach->distance;
      object["time"] = approach->time;
      object["segment"] = segment_name(approach->segment);
      object["hand"] = to_json(approach->hand);
      object["surface"] = to_json(approach->object);
    }
    json["objects"].push_back(std::move(object));
  }
  return json;
}

std::vector<std::string> approach_sentences(const Clearance& clearance, const Scene& scene) {
  std::vector<std::string> sentences;
  if (is_empty(clearance.hand)) return {"no sample of the motion shows a hand"};
  sentences.push_back("the hand passes through " + span_text(clearance.hand));
  for (std::size_t i = 0; i < clearance.object.size(); ++i) {
    const Box& box = clearance.object[i];
    const std::string name = name_of(scene, i);
    if (is_empty(box)) {
      sentences.push_back(name + " has no triangles");
      continue;
    }
    sentences.push_back(name + " lies in " + span_text(box));
    if (const std::string unit = likely_unit(extent_of(box)); !unit.empty())
      sentences.push_back(name + " is " + length_text(extent_of(box)) + " large: " + unit + "?");
    if (const double sunk = sunk_by(scene, i); sunk > kSunk)
      sentences.push_back(name + " begins " + length_text(sunk) + " below the ground, out of which it rises");
    const Approach* const approach = approach_to(clearance, i);
    if (approach == nullptr) continue;
    const std::string where =
        std::string(segment_name(approach->segment)) + ", at " + brief(approach->time) + " s";
    sentences.push_back(approach->distance > 0
                            ? name + ": nearest " + length_text(approach->distance) + ", " + where
                            : name + ": touched, first by the " + where);
  }
  return sentences;
}

}  // namespace lumbrical::tool
