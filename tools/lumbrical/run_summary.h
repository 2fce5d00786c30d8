// What `lumbrical run` tells when a session has ended.
#pragma once

#include <string>
#include <vector>

#include "device_session.h"
#include "late_ticks.h"
#include "lumbrical/model.h"
#include "lumbrical/scene_file.h"
#include "output.h"
#include "run_session.h"

namespace lumbrical::tool {

struct RunSummary {
  const SceneFile& scene_file;
  const std::vector<Model>& models;  ///< of the hands
  const RunStatistics& run;
  const LateReport& late;
  const EffortReport& effort;
  const DeviceSession* device = nullptr;
  bool paced = false;
  std::string recording;  ///< empty: none
};

Json run_json(const RunSummary& summary);
std::string run_text(const RunSummary& summary);

}  // namespace lumbrical::tool
