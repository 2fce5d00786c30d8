// See inspect_scene.h.
#include "inspect_scene.h"

#include <vector>

#include "approach_text.h"
#include "commands.h"
#include "lumbrical/clearance.h"
#include "lumbrical/scene_file.h"
#include "output.h"
#include "winding_text.h"

namespace lumbrical::tool {
namespace {

// What a model would list of them.
std::vector<World::Object> objects_of(SceneFile& scene_file) {
  std::vector<World::Object> objects;
  for (SceneObject& object : scene_file.scene.objects) {
    World::Object& listed = objects.emplace_back();
    listed.name = object.name;
    listed.triangle_count = static_cast<std::uint32_t>(object.mesh.triangles.size());
    listed.winding = wind_outwards(object.mesh, object.winding);
  }
  return objects;
}

// A hand of the scene, and where it is.
struct PlacedHand {
  const Motion& motion;
  Clearance clearance;
};

std::vector<PlacedHand> placed_hands(const SceneFile& file) {
  std::vector<PlacedHand> hands;
  hands.push_back({file.motion, find_clearance(file.scene, file.motion, file.seconds)});
  if (!file.second) return hands;
  Scene scene = file.scene;
  scene.hand = file.second->hand;
  hands.push_back({file.second->motion, find_clearance(scene, file.second->motion, file.seconds)});
  return hands;
}

}  // namespace

bool is_scene(const std::string& path) { return path.size() > 5 && path.ends_with(".json"); }

int inspect_scene(const std::string& path, bool json) {
  SceneFile scene_file;
  if (Status status = load_scene_file(path, scene_file); !status.ok()) return fail(status);
  const std::vector<World::Object> objects = objects_of(scene_file);
  const std::vector<PlacedHand> hands = placed_hands(scene_file);
  if (json) {
    Json printed = to_json(hands[0].clearance, scene_file.scene);
    for (std::size_t i = 0; i < objects.size(); ++i) {
      printed["objects"][i]["triangles"] = objects[i].triangle_count;
      printed["objects"][i]["winding"] = to_json(objects[i].winding);
    }
    if (hands.size() > 1) printed["second_hand"] = to_json(hands[1].clearance, scene_file.scene);
    if (scene_file.aligned) printed["aligned"] = pose_json(scene_file.placement.pose);
    if (scene_file.touching) printed["touching"] = true;
    return print_json(printed);
  }
  Table table;
  table.add("objects", grouped(hands[0].clearance.object.size()));
  add_windings(objects, table);
  if (scene_file.aligned) table.add("aligned", pose_text(scene_file.placement.pose));
  if (scene_file.touching) table.add("", kTouching);
  for (const PlacedHand& hand : hands) {
    table.add("hand", hands.size() > 1 ? std::string(side_name(hand.motion.side)) : hand_text(hand.motion));
    bool first = true;
    for (const std::string& sentence : approach_sentences(hand.clearance, scene_file.scene)) {
      table.add(first ? "where things are" : "", sentence);
      first = false;
    }
  }
  return print_text(table.text());
}

}  // namespace lumbrical::tool
