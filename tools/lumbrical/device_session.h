// The device of `lumbrical run --sink`: which one, what people are told of it, and the guard that outlives
// it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lumbrical/loop.h"
#include "lumbrical/model.h"
#include "output.h"

namespace lumbrical::tool {

class DeviceSession {
 public:
  DeviceSession();
  ~DeviceSession();
  DeviceSession(const DeviceSession&) = delete;
  DeviceSession& operator=(const DeviceSession&) = delete;

  /// Reads the profile, starts the guard and the loop's sink (sink_uri.h). It drives one hand of the session,
  /// that of `models[hand]`; refused where that can't be told, or is of the wrong side.
  Status open(const std::string& uri, const std::vector<Model>& models, std::size_t& hand);

  [[nodiscard]] DeviceLoop& loop();
  /// After each step, of what is worth telling.
  void note(const LoopStep& step);

  /// The certificate and the profile's name as text for a recording's metadata.
  [[nodiscard]] std::string certificate_text() const;

  /// Fades, tells the device, ends the sink's thread. Call before json() and add_rows().
  void close();
  /// Whether the session ended with forces reaching the device, where they were meant to.
  [[nodiscard]] bool forces_flow() const;
  /// What went wrong with the device, a sentence each, the worst first; empty if nothing did.
  [[nodiscard]] std::vector<std::string> trouble() const;
  /// Ticks since the start whose angles were missing, or not believed.
  [[nodiscard]] std::uint64_t ticks_without_angles() const;
  [[nodiscard]] Json json() const;
  void add_rows(Table& table) const;

 private:
  [[nodiscard]] Json certificate_json() const;

  struct Told;
  std::unique_ptr<Told> told_;
};

}  // namespace lumbrical::tool
