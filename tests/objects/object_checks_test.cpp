// Objects that move and can't be, and states that are not theirs, are refused in words that help.
#include <gtest/gtest.h>

#include <cmath>

#include "pads.h"

namespace lumbrical {
namespace {

using test::Session;

// No finger anywhere.
DeviceFrame no_hand() { return test::frame_of({{{0, 0, 10}}}); }

Mesh cube(double size) { return make_box({size, size, size}, 2); }

// A rough box that weight, or who is told, moves from beside the origin, where a joint holds it.
Session moved_by(Mobility mobility, Vec3 start) {
  Scene scene = test::pad_scene();
  SceneObject box = test::body_of("box", cube(0.02), 0.1, {start, {}}, {0.5, 0.5, 0, 1000});
  const MassProperties body = box.mechanism.body;
  box.mechanism = {};
  box.mechanism.mobility = mobility;
  if (moves_by_itself(box.mechanism)) box.mechanism.body = body;
  if (mobility == Mobility::hinge) box.mechanism.axis = {0, -1, 0};
  scene.objects.push_back(box);
  Session run(scene);
  const ObjectFrame told{{{0.3, -0.2, 0.1}, normalized({0.9, 0.1, -0.3, 0.2})}};
  for (int i = 0; i < 100; ++i) {
    run.step(no_hand(), {&told, mobility == Mobility::given ? std::size_t{1} : 0});
    EXPECT_TRUE(check_state(run.model, run.state).ok()) << i;
  }
  return run;
}

// Then a table would be felt where another model has it, or a door hang beside its hinge, for good.
TEST(ObjectChecks, AStateIsRefusedInWhichAnObjectIsWhereItsMobilityDoesNotLetItBe) {
  constexpr Mobility kAll[] = {Mobility::fixed, Mobility::given,  Mobility::free,
                               Mobility::hinge, Mobility::slider, Mobility::ball};
  for (const Mobility mobility : kAll) {
    const Session run = moved_by(mobility, {0.05, 0, 0});
    for (const Mobility other : kAll) {
      if (other == mobility || other == Mobility::free || mobility == Mobility::fixed) continue;
      EXPECT_FALSE(check_state(moved_by(other, {0.05, 0, 0}).model, run.state).ok())
          << mobility_name(mobility) << " as " << mobility_name(other);
    }
    const bool goes_anywhere = mobility == Mobility::given || mobility == Mobility::free;
    EXPECT_EQ(check_state(moved_by(mobility, {0.05, 0, -0.01}).model, run.state).ok(), goes_anywhere)
        << mobility_name(mobility);
  }
}

TEST(ObjectChecks, WhatCanNotBeIsRefusedByName) {
  const auto refusal = [](const auto& spoil) {
    Scene scene = test::pad_scene();
    scene.objects.push_back(test::body_of("box", cube(0.05), 0.2, {}, {0.5, 0.4, 0, 1000}));
    spoil(scene.objects[0]);
    Model model;
    return build_model(scene, {}, model).message();
  };
  EXPECT_NE(refusal([](SceneObject& o) { o.mechanism.body.mass = -1; }).find("\"box\": mass"),
            std::string::npos);
  EXPECT_NE(refusal([](SceneObject& o) { o.mechanism.body.inertia[0] = 0; }).find("inertia"),
            std::string::npos);
  EXPECT_NE(refusal([](SceneObject& o) { o.material.kinetic_friction = 0.6; }).find("kinetic"),
            std::string::npos);
  EXPECT_NE(refusal([](SceneObject& o) { o.pose.position.x = std::nan(""); }).find("pose"),
            std::string::npos);
  EXPECT_NE(refusal([](SceneObject& o) {
              o.mechanism.mobility = Mobility::hinge;
              o.mechanism.lower = 0.5;
            }).find("lower"),
            std::string::npos);
  EXPECT_NE(refusal([](SceneObject& o) {
              o.mechanism.mobility = Mobility::fixed;
              o.mechanism.body = {};
              o.material = {};
              o.pose.position.x = 0.5;
            }).find("\"box\": pose"),
            std::string::npos);
  for (const Latch latch : {Latch{0, 0.4}, Latch{7, 0.4}, Latch{1, -1}}) {
    Scene scene = test::pad_scene();
    for (const char* const name : {"door", "handle"}) {
      scene.objects.push_back(test::body_of(name, cube(0.02), 0.05, {}, {}));
      scene.objects.back().mechanism.mobility = Mobility::hinge;
    }
    scene.objects[0].mechanism.latch = latch;
    Model model;
    EXPECT_NE(build_model(scene, {}, model).message().find("\"door\": latch"), std::string::npos);
  }
  Scene crowd = test::pad_scene();
  crowd.objects.assign(kMostSceneObjects + 1, {"", cube(0.01)});
  Model model;
  EXPECT_NE(build_model(crowd, {}, model).message().find("32768"), std::string::npos);
}

TEST(ObjectChecks, WhatDoesNotActOnWhatMovesSoIsRefusedByName) {
  const auto refusal = [](Mobility mobility, const auto& set) {
    Scene scene = test::pad_scene();
    scene.objects.push_back({"box", cube(0.05)});
    Mechanism& mechanism = scene.objects[0].mechanism;
    if (mobility >= Mobility::free) mechanism = test::body_of("box", cube(0.05), 0.2, {}, {}).mechanism;
    mechanism.mobility = mobility;
    set(mechanism);
    Model model;
    return build_model(scene, {}, model).message();
  };
  const auto nothing = [](Mechanism&) {};
  const auto damping = [](Mechanism& m) { m.damping = 1; };
  const auto spring = [](Mechanism& m) { m.spring = 1; };
  const auto upper = [](Mechanism& m) { m.upper = 0.1; };
  for (const Mobility mobility : {Mobility::fixed, Mobility::given, Mobility::free, Mobility::ball}) {
    const std::string name = "\"" + std::string(mobility_name(mobility)) + "\"";
    EXPECT_EQ(refusal(mobility, nothing), "");
    EXPECT_EQ(refusal(mobility, spring),
              "object \"box\": spring acts on a hinge or slider only, and this is " + name +
                  ": leave it out, or let the object move so");
    EXPECT_NE(refusal(mobility, upper).find("upper acts on"), std::string::npos) << name;
    EXPECT_EQ(refusal(mobility, damping).empty(), mobility >= Mobility::free) << name;
  }
  EXPECT_EQ(refusal(Mobility::hinge, spring) + refusal(Mobility::slider, upper), "");
}

// Their squares and cubes leave the range of numbers, and then the motion does.
TEST(ObjectChecks, ABodyWhoseInertiaNoMotionCanBeWorkedOutWithIsRefused) {
  const auto refusal = [](const SceneObject& box) {
    Scene scene = test::pad_scene();
    scene.objects.push_back(box);
    Model model;
    return build_model(scene, {}, model).message();
  };
  for (const double moment : {1e-100, 0.9e-18, 1.1e22, 1e200}) {
    SceneObject box = test::body_of("box", cube(0.05), 0.2, {}, {});
    box.mechanism.body.inertia = {moment, moment, moment, 0, 0, 0};
    EXPECT_NE(refusal(box).find("\"box\": inertia is out of range: give moments of 1e-18"), std::string::npos)
        << moment << refusal(box);
  }
  // A mesh in a unit that is not its own.
  EXPECT_NE(refusal(test::body_of("box", cube(1e-12), 0.2, {}, {})).find("check the mesh's unit"),
            std::string::npos);
}

TEST(ObjectChecks, TheLightestBodyStaysInTheRangeOfNumbersHoweverItIsStruck) {
  Scene scene = test::pad_scene();
  SceneObject box = test::body_of("box", cube(0.05), 1e-6, {}, {0.5, 0.4, 0, 1000});
  box.mechanism.body.inertia = {1e-18, 1e-18, 1e-18, 0, 0, 0};
  for (const Mobility mobility : {Mobility::free, Mobility::hinge, Mobility::ball}) {
    box.mechanism.mobility = mobility;
    scene.objects.assign(1, box);
    Session run(scene);
    for (int i = 0; i < 400; ++i) {
      const ObjectOutput& moved = run.step(test::frame_of({{{0.02, 0.013, -0.03 + 0.0001 * i}}}));
      ASSERT_TRUE(is_finite(moved.pose.position) && is_finite(norm(run.state.objects[0].angular_velocity)))
          << mobility_name(mobility) << i;
    }
  }
}

TEST(ObjectChecks, AMeshThatEnclosesNoOneSolidIsRefusedWithWhatIsWrongAndWhatHelps) {
  const auto refusal = [](const Mesh& mesh) {
    MassProperties body;
    return mass_properties(mesh, 1000, body).message();
  };
  const auto says = [](const std::string& text, const char* words) {
    return text.find(words) != std::string::npos;
  };
  EXPECT_TRUE(says(refusal(make_plane(0.1, 3)), "not closed (12 open edges)"));
  Mesh twice = cube(0.01);
  twice.triangles.push_back(twice.triangles[0]);
  EXPECT_TRUE(says(refusal(twice), "1 triangle twice")) << refusal(twice);
  EXPECT_TRUE(says(refusal(twice), "inspect --fix"));
  Mesh walled = cube(0.01);  // a wall across it
  const Triangle a = walled.triangles[0];
  walled.vertices.push_back({0, 0, 0});
  const auto middle = static_cast<std::uint32_t>(walled.vertices.size() - 1);
  for (std::size_t k = 0; k < 3; ++k) walled.triangles.push_back({a[k], a[(k + 1) % 3], middle});
  EXPECT_TRUE(says(refusal(walled), "3 non-manifold edges")) << refusal(walled);
  Mesh twisted = cube(0.01);
  std::swap(twisted.triangles[0][1], twisted.triangles[0][2]);
  EXPECT_TRUE(says(refusal(twisted), "3 misoriented edges")) << refusal(twisted);
  Mesh turned = cube(0.01);
  for (Triangle& triangle : turned.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_TRUE(says(refusal(turned), "if it is inside out")) << refusal(turned);
  EXPECT_TRUE(says(refusal(turned), "or, in a scene file, give mass, centre and inertia")) << refusal(turned);
}

}  // namespace
}  // namespace lumbrical
