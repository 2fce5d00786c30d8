// What becomes of patches that several bodies have found: lists made by hand, of a hand whose parts share
// space as wanted.
#include "samples/overlaps.h"

#include <gtest/gtest.h>

#include <optional>

#include "lumbrical/shapes.h"
#include "pressed_hand.h"
#include "sampled_hand.h"
#include "samples/sampled_forces.h"

namespace lumbrical::test {
namespace {

using Found = std::array<std::vector<FoundPatches>, Bodies::kMostFingers + 1>;

/// Three tiles of different fingers: the middle one shares space with both others, they with each other not.
struct Row {
  std::size_t first, middle, last;
};
std::optional<Row> find_row(Rivals& rivals, const Bodies& bodies) {
  const auto meet = [&](std::size_t a, std::size_t b) { return (rivals.of(a) >> b & 1u) != 0; };
  const std::size_t count = palm_number(bodies);
  const std::uint64_t tiles = parts_of(bodies);
  for (std::size_t middle = 0; middle < count; ++middle) {
    for (std::size_t last = (body_of(middle) + 1) * Bodies::kTilesApart; last < count; ++last) {
      if ((tiles >> middle & tiles >> last & 1u) == 0 || !meet(middle, last)) continue;
      for (std::size_t first = 0; first < body_of(middle) * Bodies::kTilesApart; ++first) {
        if ((tiles >> first & 1u) != 0 && meet(first, middle) && !meet(first, last))
          return Row{first, middle, last};
      }
    }
  }
  return std::nullopt;
}

FoundPatches tile_alone(std::size_t part, std::uint32_t block) {
  return {static_cast<std::uint16_t>(kind::kTile + part % Bodies::kTilesApart), 1, block};
}

/// A hand above a plane of small triangles, and what parting lists comes to.
class Parting {
 public:
  Parting() : model_(model_at(scene(), 1e-4)), scratch_(make_scratch(model_)), random_(5) {
    size_overlaps(model_, overlaps_);
  }
  void pose() {
    State state;
    tick(model_, state, scratch_, dropped_hand(model_.hand, random_, 0, 1, 0.2, 0.005, 0.02));
    rivals_.emplace(*scratch_.primitives, bodies());
  }
  [[nodiscard]] const Bodies& bodies() const { return scratch_.samples->bodies; }
  [[nodiscard]] const Patches& patches() const { return *model_.patches; }
  [[nodiscard]] Rivals& rivals() { return *rivals_; }
  const Overlaps& part(const Found& found) {
    std::array<std::span<const FoundPatches>, Bodies::kMostFingers + 1> spans;
    std::copy(found.begin(), found.end(), spans.begin());
    EXPECT_TRUE(part_overlaps(model_, cuts_, bodies(), *rivals_,
                              std::span(spans).first(bodies().finger_count + 1), overlaps_));
    return overlaps_;
  }

 private:
  static Scene scene() {
    Scene scene = sampled_scene(default_hand(Side::right), {{"plane", make_plane(0.2, 200)}});
    scene.settings.felt_once = FeltOnce::by_samples;
    return scene;
  }
  Model model_;
  Scratch scratch_;
  Random random_;
  Overlaps overlaps_;
  CutPatches cuts_;
  std::optional<Rivals> rivals_;
};

TEST(Overlaps, APatchSharedWithABodyThatLeavesItToAThirdOneIsNotLost) {
  Parting parting;
  std::size_t rows = 0, shared = 0;
  for (int pose = 0; pose < 200 && shared < 20; ++pose) {
    parting.pose();
    const auto row = find_row(parting.rivals(), parting.bodies());
    if (!row) continue;
    ++rows;
    for (std::uint32_t block = 0; block < parting.patches().block.size(); ++block) {
      Found found;
      found[body_of(row->middle)] = {tile_alone(row->middle, block)};
      found[body_of(row->last)] = {tile_alone(row->last, block)};
      if (parting.part(found).together_begin.back() != 1) continue;  // one of them is deeper throughout
      ++shared;
      found[body_of(row->first)] = {
          {static_cast<std::uint16_t>(kAcrossSkin * kind::kCount + kind::kBlockInside +
                                      row->first % Bodies::kTilesApart),
           1, parting.patches().first_samples[0] + block}};
      const Overlaps& overlaps = parting.part(found);
      EXPECT_TRUE(overlaps.left[body_of(row->middle)].empty());
      EXPECT_EQ(overlaps.left[body_of(row->last)].size() + overlaps.together_begin.back(), 1u)
          << "block " << block << " in pose " << pose;
      if (shared >= 20) break;
    }
  }
  EXPECT_GT(rows, 0u);
  EXPECT_GE(shared, 20u);
}

}  // namespace
}  // namespace lumbrical::test
