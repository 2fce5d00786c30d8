// The ways out of a session: signals that ask for its end, and those that are the end of the process, before
// which forces have to fade.
#pragma once

#include <array>
#include <csignal>

#include "lumbrical/device_sink.h"

namespace lumbrical {

/// While it lives, SIGINT, SIGTERM, SIGQUIT and (but under nohup) SIGHUP only ask sessions, exports,
/// copies and writers of worlds for a stop; another one a second or more later ends the process
/// (before_dying). It outlives the session until its recording is closed. What the process did with them
/// before is done again when it goes, unless a stop was asked for.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

 private:
  std::array<struct sigaction, 4> before_{};
};

bool stop_requested();

/// From now on a SIGBUS at an address that `mend` knows how to mend is none (replace_lost_page of world.h: a
/// world file that is shortened while it is read gives zeros); any other is the end as usual.
void mend_bus_errors(bool (*mend)(const void* address) noexcept);

/// What is done, once, before the process dies of a signal that it can know of: a crash of any thread, an
/// uncaught exception, an alarm, a second Ctrl-C. `act` must be fit for a signal handler and return within
/// seconds. The process dies of that signal afterwards. Timers' and files' signals that it handles by itself
/// (SIGALRM, SIGVTALRM, SIGPROF, SIGIO) stay its own. nullptr: nothing is done, and what the process did with
/// all of them before is done again.
void before_dying(void (*act)());

/// Before the process dies the sink fades, for up to 2 s; nullptr: no longer. One sink of a process.
void fade_before_dying(DeviceSink* sink);

}  // namespace lumbrical
