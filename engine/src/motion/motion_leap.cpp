// LeapJS recordings (protocol 6): frames as objects, or packed into arrays whose first describes the layout.
#include <nlohmann/json.hpp>

#include "base/set_bits.h"
#include "motion/motion_formats.h"
#include "motion/motion_points.h"

namespace lumbrical {
namespace {

using nlohmann::json;

// No member that is read has a longer name, and every record would hold a copy of it.
constexpr std::size_t kLongestName = 15;

// A record ["id","timestamp",{"hands":[["id",...]]},...] names the fields of its packed values. A field that
// is an object names a member and the layout of what is in it: [[...]] a list of records, [...] one record.
json unpack_record(const json& layout, const json& packed);

json unpack_member(const json& layout, const json& packed) {
  const bool is_list = layout.is_array() && layout.size() == 1 && layout[0].is_array();
  if (!is_list) return unpack_record(layout, packed);
  json list = json::array();
  if (!packed.is_array()) return list;
  for (const json& record : packed) list.push_back(unpack_record(layout[0], record));
  return list;
}

json unpack_record(const json& layout, const json& packed) {
  json record = json::object();
  if (!layout.is_array() || !packed.is_array()) return record;
  for (std::size_t i = 0; i < layout.size() && i < packed.size(); ++i) {
    if (layout[i].is_string()) {
      const std::string& name = layout[i].get_ref<const std::string&>();
      if (name.size() <= kLongestName) record[name] = packed[i];
    } else if (layout[i].is_object() && layout[i].size() == 1) {
      const auto member = layout[i].begin();
      if (member.key().size() <= kLongestName)
        record[member.key()] = unpack_member(member.value(), packed[i]);
    }
  }
  return record;
}

bool is_layout(const json& frame) { return frame.is_array() && !frame.empty() && frame[0].is_string(); }

// The hand that is followed: its id while it is seen, then the next of the same side. Its side may be told
// only by a later frame, or by none.
struct Followed {
  std::optional<Side> side;
  std::optional<double> id;
};

std::optional<double> id_of(const json& hand) {
  double id = 0;
  return read_number(find_member(hand, "id"), id) ? std::optional(id) : std::nullopt;
}

std::optional<Side> side_of(const json& hand) {
  const json* type = find_member(hand, "type");
  if (type && *type == "right") return Side::right;
  if (type && *type == "left") return Side::left;
  return {};
}

const json* choose_hand(const json& frame, Followed& followed) {
  const json* hands = find_member(frame, "hands");
  if (!hands || !hands->is_array()) return nullptr;
  const json* chosen = nullptr;
  for (const json& hand : *hands) {
    const std::optional<double> id = id_of(hand);
    if (!id) continue;
    const std::optional<Side> side = side_of(hand);
    if (id == followed.id) {
      if (!followed.side) followed.side = side;
      return &hand;
    }
    const bool fits = !followed.side || !side || *side == *followed.side;
    if (fits && !chosen) chosen = &hand;
  }
  if (!chosen) return nullptr;
  if (!followed.side) followed.side = side_of(*chosen);
  followed.id = id_of(*chosen);
  return chosen;
}

// Hands beside the chosen one: nothing may be dropped in silence.
void count_others(const json& frame, const json* chosen, Motion& motion) {
  const json* hands = find_member(frame, "hands");
  if (!hands || !hands->is_array()) return;
  const json* other = nullptr;
  for (const json& hand : *hands) {
    if (&hand != chosen && hand.is_object() && !other) other = &hand;
  }
  if (!other) return;
  if (motion.other_frames++ == 0) motion.other_side = side_of(*other).value_or(Side::left);
}

// 0 thumb to 4 little finger; -1 where the file does not tell. Without a type, ids are ten times the hand's
// plus it.
int finger_type(const json& pointable, double hand_id) {
  double type = 0, id = 0;
  if (!read_number(find_member(pointable, "type"), type)) {
    if (!read_number(find_member(pointable, "id"), id)) return -1;
    type = id - 10 * hand_id;
  }
  for (int f = 0; f < kFingerCount; ++f) {
    if (type == f) return f;
  }
  return -1;
}

Status read_joint(const std::string& name, const std::string& where, const json& finger, const char* field,
                  double unit, int joint, HandPoints& points) {
  if (!read_position(find_member(finger, field), unit, points.position[joint])) {
    return refuse(name,
                  where + "\"" + field + "\" must be three numbers (LeapJS protocol 6 or later is needed)");
  }
  points.known |= 1u << joint;
  return {};
}

// Leap's thumb has a metacarpal of no length: its "mcp" is the base of the thumb, its "pip" the joint that
// anatomy calls metacarpophalangeal. So every finger's moving joints are mcp, pip, dip, tip.
Status read_finger(const std::string& name, const std::string& where, const json& pointable, int finger,
                   double unit, HandPoints& points, Motion& motion) {
  const int first = finger == 0 ? kThumbMetacarpal : 2 + 5 * finger;
  const char* tip = find_member(pointable, "btipPosition") ? "btipPosition" : "tipPosition";
  const char* const fields[4] = {"mcpPosition", "pipPosition", "dipPosition", tip};
  for (int i = 0; i < 4; ++i) {
    Status status = read_joint(name, where, pointable, fields[i], unit, first + i, points);
    if (!status.ok()) return status;
  }
  if (finger > 0 && find_member(pointable, "carpPosition")) {
    Status status = read_joint(name, where, pointable, "carpPosition", unit, first - 1, points);
    if (!status.ok()) return status;
  }
  double width = 0;
  if (!find_member(pointable, "width")) return {};
  if (!read_number(find_member(pointable, "width"), width) || width < 0 ||
      !(0.5 * width * unit <= kLargestRadius)) {
    return refuse(name, where + "\"width\" must be between 0 and 400 mm; set the file's unit");
  }
  for (int i = 0; i < 4; ++i) {
    if (motion.radius[first + i] == 0) motion.radius[first + i] = 0.5 * width * unit;
  }
  return {};
}

// All five fingers of the hand, each once; `complete` tells whether they are there.
Status read_fingers(const std::string& name, const std::string& where, const json& frame, double hand_id,
                    double unit, HandPoints& points, bool& complete, Motion& motion) {
  std::uint32_t seen = 0;
  const json* pointables = find_member(frame, "pointables");
  complete = false;
  if (!pointables || !pointables->is_array()) return {};
  for (const json& pointable : *pointables) {
    double owner = 0;
    const json* tool = find_member(pointable, "tool");
    if (tool && *tool == true) continue;
    if (!read_number(find_member(pointable, "handId"), owner) || owner != hand_id) continue;
    const int finger = finger_type(pointable, hand_id);
    if (finger < 0 || has_bit(seen, finger)) continue;
    seen |= 1u << finger;
    const std::string at = where + ": " + std::string(finger_name(finger)) + ": ";
    Status status = read_finger(name, at, pointable, finger, unit, points, motion);
    if (!status.ok()) return status;
  }
  complete = seen == (1u << kFingerCount) - 1;
  return {};
}

// No points where the hand is lost.
Status read_frame(const std::string& name, const std::string& where, const json& source, double unit,
                  Followed& followed, HandPoints& points, Motion& motion) {
  points = {};
  const json* hand = choose_hand(source, followed);
  count_others(source, hand, motion);
  if (!hand) return {};
  Vec3 palm_normal;
  if (!read_position(find_member(*hand, "direction"), 1, points.forward) ||
      !read_position(find_member(*hand, "palmNormal"), 1, palm_normal)) {
    return refuse(name, where + ": the hand's \"direction\" and \"palmNormal\" must be three numbers each");
  }
  points.dorsal = -palm_normal;
  if (find_member(*hand, "wrist")) {
    Status status = read_joint(name, where + ": ", *hand, "wrist", unit, kWrist, points);
    if (!status.ok()) return status;
  }
  bool complete = false;
  Status status = read_fingers(name, where, source, *followed.id, unit, points, complete, motion);
  if (!complete) points = {};
  return status;
}

// Where no frame told a side: palm and knuckles are turned the same whichever hand is built, and show it.
void build_untold(std::vector<HandPoints>& hands, Motion& motion) {
  build_hands(Side::right, hands, motion);
  if (right_handedness(motion) < 0) build_hands(Side::left, hands, motion);
}

}  // namespace

Status parse_leap(const json& root, std::size_t size, const std::string& name, const MotionOptions& options,
                  Motion& motion) {
  motion.format = "leapjs";
  const json& frames = *find_member(root, "frames");
  if (frames.is_string()) return refuse(name, "the LeapJS frames are LZ-compressed; save them uncompressed");
  if (frames.is_array() && frames.empty()) return refuse(name, "\"frames\" is empty; record the hand again");
  if (!frames.is_array()) return refuse(name, "\"frames\" must be an array of frames");
  if (static_cast<double>(frames.size()) > max(kMostShortFrames, static_cast<double>(size) / kShortFrame))
    return refuse(name, "more than 65536 frames of less than 32 bytes; save the hands too");
  const bool packed = is_layout(frames[0]);
  const double unit = options.unit > 0 ? options.unit : 0.001;
  Followed followed{options.side, {}};
  double start = 0;
  std::vector<HandPoints> hands;
  for (std::size_t i = packed ? 1 : 0; i < frames.size(); ++i) {
    const std::string where = "frame " + std::to_string(i);
    const json unpacked = packed ? unpack_record(frames[0], frames[i]) : json();
    const json& source = packed ? unpacked : frames[i];
    double stamp = 0;
    if (!read_number(find_member(source, "timestamp"), stamp)) {
      return refuse(name, where + ": \"timestamp\" must be a number [microseconds]");
    }
    if (motion.samples.empty()) start = stamp;
    HandPoints hand;
    Status status = read_frame(name, where, source, unit, followed, hand, motion);
    if (status.ok()) status = append_points(name, where, 1e-6 * (stamp - start), hand, hands, motion);
    if (!status.ok()) return status;
  }
  if (followed.side)
    build_hands(*followed.side, hands, motion);
  else
    build_untold(hands, motion);
  return {};
}

}  // namespace lumbrical
