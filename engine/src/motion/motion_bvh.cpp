// BVH (Biovision) skeletons: the joints of one hand are found by their names, posed, and taken as points.
#include <algorithm>
#include <numbers>
#include <span>

#include "base/elementary.h"
#include "motion/motion_formats.h"
#include "motion/motion_points.h"

namespace lumbrical {
namespace {

constexpr double kRadian = std::numbers::pi / 180;
constexpr std::size_t kMostNodes = 4096;  // a whole body with hands has about 80
constexpr std::size_t kNone = SIZE_MAX;

enum class ChannelKind : std::uint8_t { position, rotation };
struct Channel {
  ChannelKind kind;
  int axis;  // 0 x, 1 y, 2 z
};

struct Node {
  std::string name;          // lower case, without what stands before a colon; "end site" ends a chain
  std::optional<Side> side;  // that the name tells
  std::size_t parent = kNone;
  Vec3 offset;
  std::vector<Channel> channels;
  bool adds_offset = true;  // its position channels come on top of the offset
};

// The nodes, parents first, and the numbers behind them.
struct Skeleton {
  std::vector<Node> nodes;
  std::size_t channel_count = 0;
};

struct BvhReader {
  TextCursor cursor;
  const std::string& name;
  [[nodiscard]] Status fault(const std::string& what) const { return text_error(name, cursor.place(), what); }
  Status expect(std::string_view keyword) {
    const std::string_view word = cursor.word_across_lines();
    return lower_case(word) == keyword ? Status()
                                       : fault(in_quotes(word) + " where '" + std::string(keyword) +
                                               "' is expected; export it again");
  }
  Status number(double& value) {
    const std::string_view word = cursor.word_across_lines();
    const char* const wrong = word.empty() ? "is missing: the file ends" : read_finite(word, value);
    return wrong == nullptr ? Status()
                            : fault("number " + in_quotes(word) + " " + wrong + "; export it again");
  }
};

std::string_view without_namespace(std::string_view name) { return name.substr(name.rfind(':') + 1); }

// "righthandindex1", "index_01_r", "r_index1", "hand.l"
std::optional<Side> side_in_words(const std::string& name) {
  if (name.find("right") != name.npos) return Side::right;
  if (name.find("left") != name.npos) return Side::left;
  const auto is_part = [&name](char letter) {
    for (std::size_t i = 0; i < name.size(); ++i) {
      const bool starts = i == 0 || name[i - 1] == '_' || name[i - 1] == '.' || name[i - 1] == '-';
      const bool ends =
          i + 1 == name.size() || name[i + 1] == '_' || name[i + 1] == '.' || name[i + 1] == '-';
      if (name[i] == letter && starts && ends) return true;
    }
    return false;
  };
  if (is_part('r')) return Side::right;
  return is_part('l') ? std::optional(Side::left) : std::nullopt;
}

// "rThumb1", "lHand": with capitals only, for "ring" begins with an r too.
std::optional<Side> side_in_capitals(std::string_view name) {
  if (name.size() < 2 || name[1] < 'A' || name[1] > 'Z') return std::nullopt;
  if (name[0] == 'r') return Side::right;
  return name[0] == 'l' ? std::optional(Side::left) : std::nullopt;
}

std::optional<Side> side_in_name(std::string_view name) {
  const std::optional<Side> side = side_in_words(lower_case(name));
  return side ? side : side_in_capitals(name);
}

Status read_channels(BvhReader& reader, Node& node) {
  double count = 0;
  if (Status status = reader.number(count); !status.ok()) return status;
  if (!(count >= 0 && count <= 6)) return reader.fault("a joint has 0 to 6 channels; export it again");
  for (int i = 0; i < static_cast<int>(count); ++i) {
    const std::string word = lower_case(reader.cursor.word_across_lines());
    const bool position = word.size() == 9 && word.substr(1) == "position";
    const bool rotation = word.size() == 9 && word.substr(1) == "rotation";
    const std::size_t axis = std::string_view("xyz").find(word.substr(0, 1));
    if (!(position || rotation) || axis > 2)
      return reader.fault(in_quotes(std::string_view(word)) + " is no channel");
    node.channels.push_back(
        {position ? ChannelKind::position : ChannelKind::rotation, static_cast<int>(axis)});
  }
  return {};
}

Status read_offset(BvhReader& reader, Node& node) {
  for (double* const value : {&node.offset.x, &node.offset.y, &node.offset.z})
    if (Status status = reader.number(*value); !status.ok()) return status;
  return {};
}

// From "HIERARCHY" to the word "MOTION".
Status read_hierarchy(BvhReader& reader, Skeleton& skeleton) {
  if (Status status = reader.expect("hierarchy"); !status.ok()) return status;
  std::size_t open = kNone;
  for (;;) {
    const std::string word = lower_case(reader.cursor.word_across_lines());
    Status status;
    if (word == "motion" && open == kNone) return {};
    if (word == "root" || word == "joint" || word == "end") {
      if (skeleton.nodes.size() == kMostNodes)
        return reader.fault("more than 4096 joints; this is no skeleton");
      Node node;
      const std::string_view name = without_namespace(reader.cursor.word());
      node.name = word == "end" ? "end site" : lower_case(name);
      if (word != "end") node.side = side_in_name(name);
      node.parent = open;
      reader.cursor.skip_line();  // a name may have blanks
      open = skeleton.nodes.size();
      skeleton.nodes.push_back(std::move(node));
      status = reader.expect("{");
    } else if (open == kNone) {
      status = reader.fault(in_quotes(std::string_view(word)) +
                            " where 'ROOT' or 'MOTION' is expected; export it again");
    } else if (word == "offset") {
      status = read_offset(reader, skeleton.nodes[open]);
    } else if (word == "channels") {
      status = read_channels(reader, skeleton.nodes[open]);
    } else if (word == "}") {
      open = skeleton.nodes[open].parent;
    } else {
      status = reader.fault(in_quotes(std::string_view(word)) + " is unknown in a joint; export it again");
    }
    if (!status.ok()) return status;
  }
}

// ---- Which joints are the hand's ----

int finger_of(const std::string& name) {
  constexpr struct {
    const char* word;
    int finger;
  } kWords[] = {{"thumb", 0}, {"index", 1}, {"pointer", 1}, {"middle", 2}, {"mid", 2},
                {"ring", 3},  {"pinky", 4}, {"pinkie", 4},  {"little", 4}};
  for (const auto& [word, finger] : kWords)
    if (name.find(word) != name.npos) return finger;
  return -1;
}

// Its own name tells, or that of the nearest joint above it that does.
std::optional<Side> side_of(const Skeleton& skeleton, std::size_t node) {
  for (; node != kNone; node = skeleton.nodes[node].parent)
    if (const auto side = skeleton.nodes[node].side) return side;
  return std::nullopt;
}

// A finger's nodes from its base to the end of its chain.
std::vector<std::size_t> chain_from(const Skeleton& skeleton, std::size_t base) {
  std::vector<std::size_t> chain = {base};
  for (std::size_t i = base + 1; i < skeleton.nodes.size(); ++i)
    if (skeleton.nodes[i].parent == chain.back()) chain.push_back(i);
  return chain;
}

bool names_metacarpal(const std::string& name) {
  return name.find("meta") != name.npos || name.find("carpal") != name.npos ||
         name.find("inhand") != name.npos || (!name.empty() && name.back() == '0');
}

struct HandNodes {
  std::array<std::size_t, kJointCount> node;
  HandNodes() { node.fill(kNone); }
};

Status take_chain(const std::string& name, const Skeleton& skeleton, int finger,
                  std::span<const std::size_t> chain, HandNodes& hand) {
  const bool metacarpal = finger > 0 && names_metacarpal(skeleton.nodes[chain[0]].name);
  if (chain.size() < (metacarpal ? 5u : 4u)) {
    return refuse(name, "the " + std::string(finger_name(finger)) + " (" +
                            in_quotes(skeleton.nodes[chain[0]].name) +
                            " and beyond) has too few joints: three and the end of its tip are needed");
  }
  const std::size_t first = static_cast<std::size_t>(finger == 0 ? int{kThumbMetacarpal} : 2 + 5 * finger);
  if (metacarpal) hand.node[first - 1] = chain[0];
  for (std::size_t i = 0; i < 4; ++i) hand.node[first + i] = chain[i + (metacarpal ? 1 : 0)];
  return {};
}

std::size_t depth_of(const Skeleton& skeleton, std::size_t node) {
  std::size_t depth = 0;
  for (; node != kNone; node = skeleton.nodes[node].parent) ++depth;
  return depth;
}

// The deepest joint that all of the fingers hang on.
std::size_t common_parent(const Skeleton& skeleton, std::span<const std::size_t> bases) {
  std::size_t common = skeleton.nodes[bases[0]].parent;
  for (const std::size_t base : bases) {
    std::size_t other = skeleton.nodes[base].parent;
    while (common != other) {
      if (common == kNone || other == kNone) return kNone;
      std::size_t& deeper = depth_of(skeleton, common) > depth_of(skeleton, other) ? common : other;
      deeper = skeleton.nodes[deeper].parent;
    }
  }
  return common;
}

bool hangs_on(const Skeleton& skeleton, std::size_t node, std::size_t above) {
  while (node != kNone && node != above) node = skeleton.nodes[node].parent;
  return node == above;
}

// Of two hands whose names tell no side one would be dropped in silence.
Status refuse_second(const std::string& name, const Skeleton& skeleton, int finger, std::size_t base) {
  for (std::size_t i = base + 1; i < skeleton.nodes.size(); ++i) {
    if (finger_of(skeleton.nodes[i].name) != finger || hangs_on(skeleton, i, base)) continue;
    return refuse(name, in_quotes(skeleton.nodes[base].name) + " and " + in_quotes(skeleton.nodes[i].name) +
                            " both begin the " + std::string(finger_name(finger)) +
                            " of a hand; rename one hand's joints with left, the other's with right");
  }
  return {};
}

// Where a finger of the hand of that side begins.
Status find_base(const std::string& name, const Skeleton& skeleton, std::optional<Side> side, int finger,
                 std::size_t& base) {
  base = kNone;
  for (std::size_t i = 0; i < skeleton.nodes.size() && base == kNone; ++i)
    if (finger_of(skeleton.nodes[i].name) == finger && side_of(skeleton, i) == side) base = i;
  if (base != kNone) return side ? Status() : refuse_second(name, skeleton, finger, base);
  const std::string of_side = side ? " of a " + std::string(side_name(*side)) + " hand" : "";
  return refuse(name,
                "no joint" + of_side + " is named after the " + std::string(finger_name(finger)) +
                    "; a hand's joints are found by thumb, index, middle, ring, little or pinky in their "
                    "names");
}

// The hand of one side; none of a known side: `side` is empty.
Status find_hand(const std::string& name, const Skeleton& skeleton, std::optional<Side> side,
                 HandNodes& hand) {
  std::vector<std::size_t> bases;
  for (int finger = 0; finger < kFingerCount; ++finger) {
    std::size_t base = kNone;
    Status status = find_base(name, skeleton, side, finger, base);
    if (status.ok()) status = take_chain(name, skeleton, finger, chain_from(skeleton, base), hand);
    if (!status.ok()) return status;
    bases.push_back(base);
  }
  hand.node[kWrist] = common_parent(skeleton, bases);
  if (hand.node[kWrist] == kNone)
    return refuse(name, "the fingers hang on no common joint, so there is no wrist");
  return {};
}

// ---- Frames ----

Vec3 turned(const std::array<Vec3, 3>& axes, Vec3 v) { return axes[0] * v.x + axes[1] * v.y + axes[2] * v.z; }

// Where every node is, and how it is turned: the columns of its rotation.
struct Posture {
  std::vector<Vec3> position;
  std::vector<std::array<Vec3, 3>> axes;
};

// Turns the axes about one of their own, as rotations are written: outermost first.
void turn(std::array<Vec3, 3>& axes, int about, double degrees) {
  const SinCos angle = sin_cos(degrees * kRadian);
  const std::size_t b = (static_cast<std::size_t>(about) + 1) % 3, c = (b + 1) % 3;
  const Vec3 u = axes[b], v = axes[c];
  axes[b] = u * angle.cos + v * angle.sin;
  axes[c] = v * angle.cos - u * angle.sin;
}

void pose(const Skeleton& skeleton, std::span<const double> values, Posture& posture) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < skeleton.nodes.size(); ++i) {
    const Node& node = skeleton.nodes[i];
    std::array<Vec3, 3> axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    Vec3 origin;
    if (node.parent != kNone) {
      axes = posture.axes[node.parent];
      origin = posture.position[node.parent];
    }
    const std::array<Vec3, 3> above = axes;
    std::array<double, 3> moved{};
    bool moves = false;
    for (const Channel channel : node.channels) {
      const double value = values[at++];
      if (channel.kind == ChannelKind::rotation) {
        turn(axes, channel.axis, value);
      } else {
        moved[static_cast<std::size_t>(channel.axis)] = value;
        moves = true;
      }
    }
    Vec3 local = moves && !node.adds_offset ? Vec3{} : node.offset;
    if (moves) local += Vec3{moved[0], moved[1], moved[2]};
    posture.position[i] = origin + turned(above, local);
    posture.axes[i] = axes;
  }
}

// Some write the whole place of a joint into its position channels, others what comes on top of its offset.
// The first frame tells: bones keep their length.
void tell_offsets(Skeleton& skeleton, std::span<const double> first_frame) {
  std::size_t at = 0;
  for (Node& node : skeleton.nodes) {
    std::array<double, 3> moved{};
    for (const Channel channel : node.channels) {
      const double value = first_frame[at++];
      if (channel.kind == ChannelKind::position) moved[static_cast<std::size_t>(channel.axis)] = value;
    }
    const Vec3 place{moved[0], moved[1], moved[2]};
    node.adds_offset = !(norm(place - node.offset) < norm(place));
  }
}

Status read_motion_header(BvhReader& reader, const Skeleton& skeleton, std::size_t& frame_count,
                          double& period) {
  Status status = reader.expect("frames:");
  double count = 0;
  if (status.ok()) status = reader.number(count);
  if (status.ok()) status = reader.expect("frame");
  if (status.ok()) status = reader.expect("time:");
  if (status.ok()) status = reader.number(period);
  if (!status.ok()) return status;
  // A number takes two bytes at least.
  const double bytes = static_cast<double>(reader.cursor.remaining()), most = bytes / 2 + 1;
  if (!(count >= 1 && count * static_cast<double>(std::max<std::size_t>(skeleton.channel_count, 1)) <= most))
    return reader.fault("the frames counted are none, or more than the file holds; export it again");
  if (count > max(kMostShortFrames, bytes / kShortFrame))
    return reader.fault("more than 65536 frames of less than 32 bytes; export the fingers' channels too");
  if (!(period > 0 && period <= 10)) return reader.fault("the frame time must be above 0 and at most 10 s");
  frame_count = static_cast<std::size_t>(count);
  return {};
}

// `both` tells whether the skeleton has hands of both sides.
std::optional<Side> choose_side(const Skeleton& skeleton, std::optional<Side> asked, bool& both) {
  bool right = false, left = false, unnamed = false;
  for (std::size_t i = 0; i < skeleton.nodes.size(); ++i) {
    if (finger_of(skeleton.nodes[i].name) < 0) continue;
    const std::optional<Side> side = side_of(skeleton, i);
    right |= side == Side::right;
    left |= side == Side::left;
    unnamed |= !side;
  }
  both = left && right;
  if (unnamed && !right && !left) return std::nullopt;
  return asked ? *asked : right ? Side::right : Side::left;
}

HandPoints points_of(const HandNodes& hand, const Posture& posture, double unit) {
  HandPoints points;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    if (hand.node[j] == kNone) continue;
    points.position[j] = posture.position[hand.node[j]] * unit;
    points.known |= 1u << j;
  }
  return points;
}

Status read_frames(BvhReader& reader, Skeleton& skeleton, const HandNodes& hand, double unit,
                   std::size_t frame_count, double period, std::vector<HandPoints>& frames, Motion& motion) {
  std::vector<double> values(skeleton.channel_count);
  Posture posture{std::vector<Vec3>(skeleton.nodes.size()),
                  std::vector<std::array<Vec3, 3>>(skeleton.nodes.size())};
  for (std::size_t i = 0; i < frame_count; ++i) {
    for (double& value : values)
      if (Status status = reader.number(value); !status.ok()) return status;
    if (i == 0) tell_offsets(skeleton, values);
    pose(skeleton, values, posture);
    const std::string where = "frame " + std::to_string(i);
    for (const std::size_t node : hand.node) {
      if (node == kNone || norm(posture.position[node]) * unit <= kFarthest) continue;
      return refuse(reader.name, where + ": " + in_quotes(skeleton.nodes[node].name) +
                                     " is more than 10 km away; set the unit");
    }
    Status status = append_points(reader.name, where, static_cast<double>(i) * period,
                                  points_of(hand, posture, unit), frames, motion);
    if (!status.ok()) return status;
  }
  if (reader.cursor.word_across_lines().empty()) return {};
  return reader.fault(
      "the file goes on behind the frames counted; correct the number after 'Frames:' or export it again");
}

// `named`: by the joints' names, which tell before the caller.
Status build_told(const std::string& name, std::optional<Side> named, std::optional<Side> asked,
                  std::vector<HandPoints>& frames, Motion& motion) {
  const Side said = named ? *named : asked.value_or(Side::right);
  const std::string remedy = named ? "its joints' names say " + std::string(side_name(said)) +
                                         ": correct them, or export it again without mirroring"
                                   : set_other_side(said);
  return build_told_by_shape(name, named ? named : asked, remedy, frames, motion);
}

}  // namespace

Status parse_bvh(std::string_view content, const std::string& name, const MotionOptions& options,
                 Motion& motion) {
  motion.format = "bvh";
  if (!(options.unit > 0))
    return refuse(
        name, "BVH doesn't say its unit; set it: cm as a rule (\"unit\" of the scene's motion, or --unit)");
  BvhReader reader{TextCursor(content), name};
  Skeleton skeleton;
  if (Status status = read_hierarchy(reader, skeleton); !status.ok()) return status;
  for (const Node& node : skeleton.nodes) skeleton.channel_count += node.channels.size();
  bool both = false;
  const std::optional<Side> side = choose_side(skeleton, options.side, both);
  HandNodes hand;
  if (Status status = find_hand(name, skeleton, side, hand); !status.ok()) return status;

  std::size_t frame_count = 0;
  double period = 0;
  if (Status status = read_motion_header(reader, skeleton, frame_count, period); !status.ok()) return status;
  std::vector<HandPoints> frames;
  Status status = read_frames(reader, skeleton, hand, options.unit, frame_count, period, frames, motion);
  if (status.ok()) status = build_told(name, side, options.side, frames, motion);
  if (status.ok() && both) {
    motion.other_frames = frame_count;
    motion.other_side = other_side(motion.side);
  }
  return status;
}

}  // namespace lumbrical
