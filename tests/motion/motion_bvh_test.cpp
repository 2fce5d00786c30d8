// BVH skeletons: which joints are a hand's, how channels pose them, and what is refused.
#include <gtest/gtest.h>

#include <cmath>

#include "motion_samples.h"
#include "random.h"

namespace lumbrical::test {
namespace {

struct Style {
  const char* prefix = "RightHand";  // before a finger's name
  const char* suffix = "";
  bool metacarpals = false;  // a joint "InHand" before each finger but the thumb
  bool repeats_offsets = false;
  int extra_joints = 0;  // beyond the tip
};

// The hand's joints as a chain of offsets without rotations, in centimetres.
std::string skeleton_of(const Poses& poses, const Style& style, std::string& values) {
  const auto offset = [&](Vec3 from, int joint) { return poses[joint].position - from; };
  const auto text = [](Vec3 v) { return list({100 * v.x, 100 * v.y, 100 * v.z}) + " "; };
  const auto spaced = [&](Vec3 v) {
    std::string numbers = text(v);
    for (char& c : numbers) c = c == ',' ? ' ' : c;
    return numbers;
  };
  std::string bvh;
  const auto open = [&](const std::string& name, Vec3 at) {
    bvh += "JOINT " + name + "\n{\nOFFSET " + spaced(at) + "\nCHANNELS " +
           (style.repeats_offsets ? "6 Xposition Yposition Zposition " : "3 ") +
           "Zrotation Xrotation Yrotation\n";
    values += (style.repeats_offsets ? spaced(at) : std::string()) + "0 0 0 ";
  };
  const char* const names[] = {"Thumb", "Index", "Middle", "Ring", "Pinky"};
  for (int f = 0; f < kFingerCount; ++f) {
    const int first = f == 0 ? kThumbMetacarpal : 2 + 5 * f;
    Vec3 at = poses[kWrist].position;
    int braces = 0;
    if (style.metacarpals && f > 0) {
      open(std::string("RightInHand") + names[f], offset(at, first - 1));
      at = poses[first - 1].position;
      ++braces;
    }
    for (int k = 0; k < 3 + style.extra_joints; ++k, ++braces) {
      open(style.prefix + std::string(names[f]) + std::to_string(k + 1) + style.suffix,
           k < 4 ? offset(at, first + k) : Vec3{});
      if (k < 4) at = poses[first + k].position;
    }
    bvh +=
        "End Site\n{\nOFFSET " + spaced(style.extra_joints == 0 ? offset(at, first + 3) : Vec3{}) + "\n}\n";
    for (; braces > 0; --braces) bvh += "}\n";
  }
  return bvh;
}

std::string bvh_file(const Poses& poses, const Style& style = {}, int frames = 2) {
  std::string values;
  const std::string fingers = skeleton_of(poses, style, values);
  const Vec3 wrist = poses[kWrist].position;
  std::string place = list({100 * wrist.x, 100 * wrist.y, 100 * wrist.z});
  for (char& c : place) c = c == ',' ? ' ' : c;
  std::string text =
      "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation "
      "Yrotation\n"
      "JOINT " +
      std::string(style.prefix) + style.suffix +
      "\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n" + fingers +
      "}\n}\nMOTION\nFrames: " + std::to_string(frames) + "\nFrame Time: 0.01\n";
  for (int i = 0; i < frames; ++i) text += place + " 0 0 0 0 0 0 " + values + "\n";
  return text;
}

MotionOptions centimetres(std::optional<Side> side = {}) {
  MotionOptions options;
  options.unit = 0.01;
  options.side = side;
  return options;
}

void expect_joints(const Motion& motion, const Poses& poses, bool metacarpals) {
  for (int j = 0; j < kJointCount; ++j) {
    const bool derived = j == kPalm || (!metacarpals && (j == kIndexMetacarpal || j == kMiddleMetacarpal ||
                                                         j == kRingMetacarpal || j == kLittleMetacarpal));
    if (derived) continue;
    EXPECT_LT(norm(position(motion.samples[0].frame, j) - poses[j].position), 2e-6) << joint_name(j);
  }
}

TEST(MotionBvh, FindsTheHandInSkeletonsOfManyNames) {
  const Poses poses = bent_hand(Side::right, 0.3);
  for (const Style& style :
       {Style{}, Style{"mixamorig:RightHand", "", false, false, 2}, Style{"r_", "", true, false, 0},
        Style{"Avatar:right_", "_joint", false, true, 0}, Style{"Hand_", "_R", true, true, 1}}) {
    SCOPED_TRACE(style.prefix);
    const Motion motion = parse_good(bvh_file(poses, style), centimetres());
    EXPECT_EQ(motion.format, "bvh");
    EXPECT_EQ(motion.side, Side::right);
    ASSERT_EQ(motion.samples.size(), 2u);
    EXPECT_EQ(motion.samples[1].time, 0.01);
    expect_joints(motion, poses, style.metacarpals);
  }
}

TEST(MotionBvh, ASkeletonThatDoesNotSayItsSideIsTheOneAskedFor) {
  const Poses poses = bent_hand(Side::left, 0.5);
  const Style style{"Hand", "", false, false, 0};
  EXPECT_EQ(parse_good(bvh_file(poses, style), centimetres(Side::left)).side, Side::left);
}

TEST(MotionBvh, ASkeletonThatDoesNotSayItsSideIsToldByTheBendOfItsFingers) {
  const Style nameless{"Hand", "", false, false, 0};
  for (const Side side : {Side::right, Side::left}) {
    SCOPED_TRACE(side_name(side));
    const std::string file = bvh_file(bent_hand(side, 0.5), nameless);
    const Motion motion = parse_good(file, centimetres());
    EXPECT_EQ(motion.side, side);
    const Vec3 dorsal = rotate(orientation(motion.samples[1].frame, kWrist), {0, 1, 0});
    EXPECT_GT(dorsal.y, 0.9) << "the hand was made with its back upwards";
    const std::string other(side_name(other_side(side)));
    expect_refused(file,
                   "as a " + other + " hand its fingers would bend backwards; set the side to " +
                       std::string(side_name(side)),
                   centimetres(other_side(side)));
  }
}

TEST(MotionBvh, ASideInNamesThatTheBendContradictsIsRefused) {
  const std::string file = bvh_file(bent_hand(Side::left, 0.5), Style{});
  for (const auto side : {std::optional<Side>(), std::optional(Side::right)})
    expect_refused(file, "as a right hand its fingers would bend backwards; its joints' names say right",
                   centimetres(side));
}

TEST(MotionBvh, AFlatHandIsTheOneThatNamesOrElseTheCallerSay) {
  const Poses flat = bent_hand(Side::left, 0);
  const Style nameless{"Hand", "", false, false, 0};
  EXPECT_EQ(parse_good(bvh_file(flat, Style{"LeftHand"}), centimetres()).side, Side::left);
  EXPECT_EQ(parse_good(bvh_file(flat, nameless), centimetres(Side::left)).side, Side::left);
  EXPECT_EQ(parse_good(bvh_file(flat, nameless), centimetres()).side, Side::right);
}

// The second file's hand as one more joint of the first one's root.
std::string with_other_hand(std::string text, const std::string& other) {
  const std::size_t joint = other.find("JOINT"), end = other.find("}\nMOTION");
  text.insert(text.find("}\nMOTION"), other.substr(joint, end - joint));
  std::size_t values = other.rfind('\n', other.size() - 2);
  for (int of_root = 0; of_root < 6; ++of_root) values = other.find(' ', values + 1);
  const std::string row = other.substr(values, other.size() - 1 - values);
  for (std::size_t line = text.find('\n', text.find("Frame Time")) + 1; line < text.size();) {
    const std::size_t line_end = text.find('\n', line);
    text.insert(line_end, row);
    line = line_end + row.size() + 1;
  }
  return text;
}

TEST(MotionBvh, OfTwoHandsOneIsTakenAndTheOtherIsTold) {
  const Style right{"RightHand", "", false, false, 0}, left{"LeftHand", "", false, false, 0};
  const std::string one = bvh_file(bent_hand(Side::right, 0.3), right);
  const std::string both = with_other_hand(one, bvh_file(bent_hand(Side::left, 0.3), left));
  EXPECT_EQ(parse_good(one, centimetres()).other_frames, 0u);
  for (const Side side : {Side::right, Side::left}) {
    const Motion motion = parse_good(both, centimetres(side));
    EXPECT_EQ(motion.side, side);
    EXPECT_EQ(motion.other_frames, 2u);
    EXPECT_NE(motion.other_side, side);
  }
}

// Both hands, the joints of each named with its own prefix; the wrists' names do not matter.
std::string two_hands(const char* of_right, const char* of_left) {
  const std::string right = bvh_file(bent_hand(Side::right, 0.3), Style{of_right});
  const std::string left = bvh_file(bent_hand(Side::left, 0.3), Style{of_left});
  const auto wrist = [](const char* prefix) { return "JOINT " + std::string(prefix) + "\n"; };
  return with_other_hand(replaced(right, wrist(of_right), "JOINT a\n"),
                         replaced(left, wrist(of_left), "JOINT b\n"));
}

TEST(MotionBvh, ASmallLetterBeforeACapitalTellsTheSide) {
  const std::string both = two_hands("r", "l");
  for (const Side side : {Side::right, Side::left}) {
    const Motion motion = parse_good(both, centimetres(side));
    EXPECT_EQ(motion.side, side);
    EXPECT_EQ(motion.other_frames, 2u);
    expect_joints(motion, bent_hand(side, 0.3), false);
  }
  const Motion lone = parse_good(bvh_file(bent_hand(Side::right, 0.3), Style{"daz:rHand"}), centimetres());
  EXPECT_EQ(lone.other_frames, 0u);
}

TEST(MotionBvh, OfTwoHandsThatTellNoSideNoneIsDroppedInSilence) {
  for (const auto side : {std::optional<Side>(), std::optional(Side::left)})
    expect_refused(two_hands("One", "Two"), "'onethumb1' and 'twothumb1' both begin the thumb",
                   centimetres(side));
}

TEST(MotionBvh, ChannelsTurnInTheOrderInWhichTheyStand) {
  // The root turns by 90 degrees about z, then about its own x: the fingers, along -z, come to point along
  // +x.
  const Poses poses = bent_hand(Side::right, 0.2);
  const std::string file = bvh_file(poses, {}, 1);
  const Vec3 wrist = poses[kWrist].position;
  std::string place = list({100 * wrist.x, 100 * wrist.y, 100 * wrist.z});
  for (char& c : place) c = c == ',' ? ' ' : c;
  const Motion turned = parse_good(replaced(file, place + " 0 0 0 ", place + " 90 -90 0 "), centimetres());
  for (const int j : {kThumbTip, kIndexTip, kLittleProximal}) {
    const Vec3 p = poses[j].position - wrist;
    // Rz(90) Rx(-90) p
    const Vec3 x_turned{p.x, p.z, -p.y};
    const Vec3 expected = wrist + Vec3{-x_turned.y, x_turned.x, x_turned.z};
    EXPECT_LT(norm(position(turned.samples[0].frame, j) - expected), 2e-6) << joint_name(j);
  }
}

// A hand that rests, without a channel: a frame of it takes nothing of the file.
std::string resting_hand(std::size_t frames) {
  std::string text = bvh_file(bent_hand(Side::right, 0.3), {}, 0);
  for (std::size_t at; (at = text.find("CHANNELS")) != text.npos;) text.erase(at, text.find('\n', at) - at);
  return replaced(text, "Frames: 0", "Frames: " + std::to_string(frames)) + std::string(2 * frames, '\n');
}

TEST(MotionBvh, OfNextToNothingMakesNoEndlessMotion) {
  EXPECT_EQ(parse_good(resting_hand(1000), centimetres()).samples.size(), 1000u);
  expect_refused(resting_hand(100'000), "65536 frames", centimetres());
}

// A hand whose bones all rest turned some way, as exporters leave them: every joint has rotations of its own,
// in an order of its own, and its offset stands in the axes of the joint above.
struct TurnedSkeleton {
  test::Random random;
  double unit = 0.01;  // [m]
  std::string hierarchy{}, values{};

  using Axes = std::array<Vec3, 3>;  // columns
  static Vec3 in(const Axes& axes, Vec3 v) { return {dot(axes[0], v), dot(axes[1], v), dot(axes[2], v)}; }

  // Rodrigues, about the x, y or z that earlier rotations have turned.
  static Axes turned(const Axes& axes, std::size_t about, double degrees) {
    const double angle = degrees * 3.14159265358979323846 / 180;
    const Vec3 k = axes[about];
    Axes result;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 v = axes[i];
      result[i] = std::cos(angle) * v + std::sin(angle) * cross(k, v) + (1 - std::cos(angle)) * dot(k, v) * k;
    }
    return result;
  }
  std::string numbers(Vec3 v) const {
    std::ostringstream text;
    text.precision(12);
    text << v.x / unit << ' ' << v.y / unit << ' ' << v.z / unit << ' ';
    return text.str();
  }
  // Opens a joint at `at` [m, world] below one at `above` with these axes, and turns it at random.
  void open(const std::string& name, Vec3 at, Vec3 above, Axes& axes, bool root = false) {
    constexpr const char* kOrders[] = {"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"};
    const std::string order = kOrders[random.bits() % 6];
    const Vec3 offset = root ? Vec3{} : in(axes, at - above);
    hierarchy += (root ? "ROOT " : "JOINT ") + name + "\n{\nOFFSET " + numbers(offset) + "\nCHANNELS " +
                 (root ? "6 Xposition Yposition Zposition" : "3");
    if (root) values += numbers(at);
    for (const char axis : order) {
      const double angle = random.between(-170, 170);
      hierarchy += std::string(" ") + axis + "rotation";
      values += list({angle}) + " ";
      axes = turned(axes, static_cast<std::size_t>(axis - 'X'), std::stod(list({angle})));
    }
    hierarchy += "\n";
  }
  std::string file(const Poses& poses) {
    Axes wrist = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    const Vec3 origin = poses[kWrist].position;
    open("hand.R", origin, {}, wrist, true);
    const char* const names[] = {"thumb", "index", "middle", "ring", "little"};
    for (int f = 0; f < kFingerCount; ++f) {
      const int first = f == 0 ? kThumbMetacarpal : 2 + 5 * f;
      Axes axes = wrist;
      Vec3 at = origin;
      for (int k = 0; k < 3; ++k) {
        open(std::string(names[f]) + "." + std::to_string(k + 1) + ".R", poses[first + k].position, at, axes);
        at = poses[first + k].position;
      }
      hierarchy +=
          "End Site\n{\nOFFSET " + numbers(in(axes, poses[first + 3].position - at)) + "\n}\n}\n}\n}\n";
    }
    return "HIERARCHY\n" + hierarchy + "}\nMOTION\nFrames: 1\nFrame Time: 0.0083333\n" + values + "\n";
  }
};

TEST(MotionBvh, PosesBonesThatRestTurnedWithChannelsOfAnyOrderAndUnit) {
  test::Random random(31);
  for (int round = 0; round < 60; ++round) {
    SCOPED_TRACE(round);
    const Poses poses = bent_hand(Side::right, random.between(0, 1));
    constexpr double kUnits[] = {0.001, 0.01, 0.0254, 1};
    TurnedSkeleton skeleton{test::Random(random.bits()), kUnits[round % 4]};
    MotionOptions options;
    options.unit = skeleton.unit;
    const Motion motion = parse_good(skeleton.file(poses), options);
    EXPECT_EQ(motion.side, Side::right);
    expect_joints(motion, poses, false);
  }
}

TEST(MotionBvh, SaysWhatIsMissingAndWhere) {
  const std::string file = bvh_file(bent_hand(Side::right, 0.3));
  expect_refused(file, "set it: cm");
  const MotionOptions options = centimetres();
  expect_refused(replaced(file, "RightHandRing1", "RightHandRong1"), "ring", options);
  expect_refused(file, "no joint of a left hand is named after the thumb", centimetres(Side::left));
  expect_refused(replaced(file, "OFFSET 0 0 0", "OFFSET 0 x 0"), "file:4:", options);
  expect_refused(replaced(file, "Zrotation", "Wrotation"), "no channel", options);
  expect_refused(replaced(file, "CHANNELS 6", "CHANNELS 9"), "0 to 6 channels", options);
  expect_refused(replaced(file, "Frames: 2", "Frames: 3"), "more than the file holds", options);
  expect_refused(replaced(file, "Frames: 2", "Frames: 1"), "goes on behind the frames counted", options);
  expect_refused(replaced(file, "Frames: 2", "Frames: 4000000000"), "more than the file holds", options);
  expect_refused(replaced(file, "Frame Time: 0.01", "Frame Time: 0"), "frame time", options);
  expect_refused(replaced(file, "MOTION", "MOVIE"), "expected", options);
  expect_refused(replaced(file, "MOTION\n", "MOTION\n1e400 "), "expected", options);
  MotionOptions metres;
  metres.unit = 1;
  expect_refused(file, "set the file's unit", metres);
  std::string deep = "HIERARCHY\n";
  for (int i = 0; i < 5000; ++i) deep += "JOINT a\n{\n";
  expect_refused(deep, "no skeleton", options);
}

TEST(MotionBvh, SurvivesACutAtEveryPlace) {
  const std::string file = bvh_file(bent_hand(Side::right, 0.3));
  for (std::size_t size = 0; size < file.size(); ++size) {
    Motion motion;
    const Status status = parse(file.substr(0, size), motion, centimetres());
    EXPECT_TRUE(!status.ok() || size + 8 > file.size()) << size;
  }
}

TEST(MotionFile, NamesCapturesThatAreNotReadAndWhatToConvertThemTo) {
  const struct {
    const char *name, *content, *format, *advice;
  } cases[] = {
      {"pose.pkl", "\x80\x04", "MANO", "21 joints"},
      {"grab.npz", "PK", "MANO", "21 joints"},
      {"mano_hand_pose_trajectory.jsonl", "{\"mano_pose\": [0]}\n{}", "MANO", "21 joints"},
      {"umetrack_hand_pose_trajectory.jsonl", "{\"hand_poses\": {\"0\": {\"wrist_xform\": {}}}}\n{}",
       "UmeTrack", "21 joints"},
      {"hand.FBX", "Kaydara FBX Binary", "FBX", "export BVH"},
      {"walk.c3d", "\x02P", "C3D", "21 joints"},
      {"hand.csv",
       "\xFF\xFE"
       "0",
       "UTF-16", "save it in UTF-8"},
      {"hand.csv", "\x1f\x8b\b", "compressed", "gunzip"},
      {"hands.json", "PK\3\4", "archive", "unzip"},
  };
  for (const auto& [name, content, format, advice] : cases) {
    Motion motion;
    const std::string message = parse_motion(content, name, {}, motion).message();
    EXPECT_NE(message.find(format), std::string::npos) << message;
    EXPECT_NE(message.find(advice), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace lumbrical::test
