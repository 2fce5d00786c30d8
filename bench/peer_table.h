// What a run of bench_peers has found out, as a table for people and as JSON.
#pragma once

#include <string>
#include <vector>

namespace lumbrical::bench {

/// Our default rung, 1e-4, among the contenders.
inline constexpr const char* kOurs = "ours, 1e-4";

/// One contender on one scene.
struct PeerRow {
  std::string scene, contender, leaves_out;  ///< of what our tick does; empty: nothing
  std::size_t triangles = 0;                 ///< of the scene
  double touched = 0;  ///< triangles that the hand touches by brute force, mean over the poses
  double build_ms = 0;
  double median_us = 0, p99_us = 0;  ///< of a tick
  std::size_t samples = 0;           ///< ticks measured
  double times_exact = 0;            ///< its median over that of our exact tick on the same scene
  double times_ours = 0;             ///< the same over kOurs
  double contacts = 0;               ///< what it reports, mean
  double missed = -1, extra = -1;    ///< triangles, shares of `touched`; negative: it lists none
  double area_error = -1;  ///< of the hand's whole area, worst pose, relative; negative: it has none
  double force_error = 0;  ///< of the hand's whole force, worst pose, relative
  bool fitted = false;     ///< its force was scaled by the constant that fits best
};

struct PeerReport {
  std::string cpu, compiler, flags, isa, command;
  std::string origin;  ///< of the build: origin_members()
  int poses = 0;
  bool processor_time = false;  ///< else by the clock on the wall
  std::vector<PeerRow> rows;
};

std::string to_markdown(const PeerReport& report);
std::string to_json(const PeerReport& report);

}  // namespace lumbrical::bench
