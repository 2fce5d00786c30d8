// See moved_objects.h.
#include "moved_objects.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace lumbrical::tool {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr std::size_t kMostRows = 12;

bool moves(const ApartObject& object) { return object.mechanism.mobility != Mobility::fixed; }

double distance(const ApartObject& object, const Pose& pose) {
  return norm(transform(pose, object.middle) - transform(object.start, object.middle));
}

double turned(const ApartObject& object, const Pose& pose) {
  const Quat q = pose.orientation * conjugate(object.start.orientation);
  return 2 * std::atan2(norm(Vec3{q.x, q.y, q.z}), std::fabs(q.w));
}

void note(const ApartObject& object, const ObjectOutput& output, MovedObject& moved) {
  moved.peak_force = std::max(moved.peak_force, norm(output.wrench.force));
  moved.last = output.coordinate;
  moved.least = std::min(moved.least, moved.last);
  moved.most = std::max(moved.most, moved.last);
  moved.last_distance = distance(object, output.pose);
  moved.last_turned = turned(object, output.pose);
  moved.farthest = std::max(moved.farthest, moved.last_distance);
  moved.most_turned = std::max(moved.most_turned, moved.last_turned);
}

std::string push_text(const MovedObject& moved) {
  return moved.peak_force > 0 ? "pushed with up to " + brief(moved.peak_force) + " N" : "not touched";
}

std::string way_text(const ApartObject& object, const MovedObject& moved) {
  const auto length = [](double metres) { return brief(1e3 * metres) + " mm"; };
  const auto angle = [](double radians) { return brief(kDegrees * radians) + " degrees"; };
  if (has_coordinate(object.mechanism)) {
    const bool hinge = object.mechanism.mobility == Mobility::hinge;
    const auto way = [&](double q) { return hinge ? angle(q) : length(q); };
    return (hinge ? "turned from " : "slid from ") + way(moved.least) + " to " + way(moved.most) + ", " +
           way(moved.last) + " at the end";
  }
  if (moved.farthest == 0 && moved.most_turned == 0)
    return std::string("stayed where it was") +
           (object.mechanism.mobility == Mobility::given && object.mechanism.body.mass > 0
                ? ": \"physics\" in the scene moves what is given and has a mass"
                : "");
  return "moved by up to " + length(moved.farthest) + " and " + angle(moved.most_turned) + ", " +
         length(moved.last_distance) + " and " + angle(moved.last_turned) + " at the end";
}

}  // namespace

void note_objects(const Model& model, std::span<const ObjectOutput> outputs,
                  std::vector<MovedObject>& objects) {
  objects.resize(model.apart.size());
  for (std::size_t i = 0; i < std::min(objects.size(), outputs.size()); ++i)
    if (moves(model.apart[i])) note(model.apart[i], outputs[i], objects[i]);
}

void add_moved(const Model& model, std::span<const MovedObject> objects, Table& table) {
  std::size_t rows = 0, left_out = 0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const ApartObject& object = model.apart[i];
    if (!moves(object)) continue;
    if (rows == kMostRows) {
      ++left_out;
      continue;
    }
    table.add(rows == 0 ? "objects" : "",
              object.name + ": " + way_text(object, objects[i]) + "; " + push_text(objects[i]));
    ++rows;
  }
  if (left_out > 0) table.add("", grouped(left_out) + " more: --json tells of all");
}

Json moved_json(const Model& model, std::span<const MovedObject> objects) {
  Json all = Json::array();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const ApartObject& object = model.apart[i];
    const MovedObject& moved = objects[i];
    if (!moves(object)) continue;
    Json json = {{"name", object.name}, {"peak_force", moved.peak_force}};
    if (has_coordinate(object.mechanism)) {
      json["coordinate"] = {{"least", moved.least}, {"most", moved.most}, {"last", moved.last}};
    } else {
      json["distance"] = {{"most", moved.farthest}, {"last", moved.last_distance}};
      json["turned"] = {{"most", moved.most_turned}, {"last", moved.last_turned}};
    }
    all.push_back(std::move(json));
  }
  return all;
}

}  // namespace lumbrical::tool
