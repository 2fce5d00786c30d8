// The session that a benchmark measures.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace lumbrical::bench {

/// Google Benchmark calls a benchmark several times to find how often to repeat it; sessions take longer to
/// make than that, so the last one is kept.
template <class Session>
Session& kept(const std::string& name, const std::function<void(Session&)>& make) {
  static std::unique_ptr<Session> session;
  static std::string made;
  if (made != name) {
    session.reset();  // before the next takes as much memory
    session = std::make_unique<Session>();
    make(*session);
    made = name;
  }
  return *session;
}

}  // namespace lumbrical::bench
