// Ours: the fingertips are the law's own, where they are tracked; the body moves by itself.
#include <cmath>
#include <numbers>

#include "hold.h"
#include "pads.h"

namespace lumbrical::bench {
namespace {

Mesh cylinder(double radius, double half) {
  constexpr std::uint32_t kSides = 96, kRings = 8;
  Mesh mesh;
  for (std::uint32_t ring = 0; ring <= kRings; ++ring) {
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const double angle = 2 * std::numbers::pi * i / kSides;
      mesh.vertices.push_back(
          {radius * std::cos(angle), radius * std::sin(angle), half * (2.0 * ring / kRings - 1)});
    }
  }
  const auto at = [](std::uint32_t ring, std::uint32_t i) { return ring * kSides + i % kSides; };
  for (std::uint32_t i = 0; i < kSides; ++i) {
    for (std::uint32_t ring = 0; ring < kRings; ++ring) {
      mesh.triangles.push_back({at(ring, i), at(ring, i + 1), at(ring + 1, i + 1)});
      mesh.triangles.push_back({at(ring, i), at(ring + 1, i + 1), at(ring + 1, i)});
    }
    if (i < 2) continue;
    mesh.triangles.push_back({at(0, 0), at(0, i), at(0, i - 1)});
    mesh.triangles.push_back({at(kRings, 0), at(kRings, i - 1), at(kRings, i)});
  }
  return mesh;
}

DeviceFrame frame_at(std::span<const Vec3> tips) {
  std::vector<test::Pad> pads;
  for (const Vec3 tip : tips) {
    // Round a mug they come from outside, under a slope from below.
    const Vec3 away = tip.z < -kTipRadius ? Vec3{0, 0, -1} : unit_or({tip.x, tip.y, 0.0}, {0, 0, 1});
    pads.push_back({tip, away});
  }
  return test::frame_of(pads);
}

}  // namespace

HoldEngine our_holder() {
  return {"Lumbrical, 1e-4", [](const HeldBody& body, std::span<const Vec3>) {
            Scene scene = test::pad_scene();
            scene.settings.precision = every_segment(1e-4);
            scene.gravity = body.gravity;
            Mesh mesh = body.cylinder ? cylinder(body.half.x, body.half.z) : make_box(2.0 * body.half, 6);
            scene.objects.push_back(test::body_of("body", std::move(mesh), body.mass, {},
                                                  {body.friction, body.friction, 0, kCoupling}));
            const auto run = std::make_shared<test::Session>(scene);
            run->scratch.hash_stages = false;
            return Holder{[run](std::span<const Vec3> tips) { run->step(frame_at(tips)); },
                          [run] { return run->state.objects[0].pose; },
                          [run](std::size_t finger) { return run->output.segment[3 * finger + 2].force; }};
          }};
}

}  // namespace lumbrical::bench
