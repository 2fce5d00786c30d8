// See lumbrical/ways_out.h.
#include "lumbrical/ways_out.h"

#include <signal.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdint>

#include "base/steady_clock.h"

namespace lumbrical {
namespace {

constexpr std::array<int, 4> kStops = {SIGINT, SIGTERM, SIGQUIT, SIGHUP};

// All that end a process unless it says otherwise, but for those above, the operator's, those the program
// ignores, and SIGBUS, which may be mended.
struct Death {
  int signal;
  bool may_be_work = false;    // of a program that handles it: no death then
  struct sigaction before {};  // what the process does by itself
};
std::array<Death, 13> deaths = {{{SIGSEGV},
                                 {SIGFPE},
                                 {SIGILL},
                                 {SIGABRT},
                                 {SIGSYS},
                                 {SIGTRAP},
                                 {SIGXCPU},
                                 {SIGPWR},
                                 {SIGSTKFLT},
                                 {SIGALRM, true},
                                 {SIGVTALRM, true},
                                 {SIGPROF, true},
                                 {SIGIO, true}}};
struct sigaction bus_errors_before {};

std::atomic<bool> stop_asked{false};
std::atomic<std::int64_t> asked_at{0};  // [ns]
static_assert(decltype(stop_asked)::is_always_lock_free && decltype(asked_at)::is_always_lock_free,
              "handlers write them, on whichever thread");

std::atomic<void (*)()> last_act{nullptr};
std::atomic<bool> dying{false};
std::atomic<bool (*)(const void*) noexcept> mend_page{nullptr};

// A stack that has run over can't carry a handler.
alignas(16) std::array<std::byte, 65536> spare_stack;

extern "C" void die(int signal) {
  if (last_act != nullptr) dying = true;  // before it is taken: who finds none then waits for it
  if (void (*const act)() = last_act.exchange(nullptr); act != nullptr) {
    act();
  } else if (dying) {  // another thread is at it
    const timespec pause{3, 0};
    nanosleep(&pause, nullptr);
  }
  std::signal(signal, SIG_DFL);
  raise(signal);
}

extern "C" void mend_or_die(int signal, siginfo_t* info, void*) {
  const int error = errno;
  if (bool (*const mend)(const void*) noexcept = mend_page;
      mend != nullptr && info->si_code == BUS_ADRERR && mend(info->si_addr)) {
    errno = error;
    return;
  }
  die(signal);
}

// One Ctrl-C often arrives twice (once for the process, once for its group): only a signal that comes a
// second or more after the first is somebody losing patience, and kills as usual.
extern "C" void request_stop(int signal) {
  const int error = errno;
  const std::int64_t now = steady_ns();
  if (!stop_asked) {
    asked_at = now;
    stop_asked = true;
  } else if (in_seconds(now - asked_at) >= 1) {
    die(signal);
  }
  errno = error;
}

std::atomic<DeviceSink*> fading_sink{nullptr};

// The thread that crashed makes no more commands; the sink's thread fades them out meanwhile.
void fade() {
  DeviceSink* const sink = fading_sink;
  if (sink == nullptr) return;
  sink->press_stop(true);
  for (int i = 0; i < 400 && !sink->is_safe() && sink->state() != SafetyState::disconnected; ++i) {
    const timespec pause{0, 5000000};
    nanosleep(&pause, nullptr);
  }
}

struct sigaction action_of(int signal) {
  struct sigaction action {};
  sigaction(signal, nullptr, &action);
  return action;
}

void take_bus_errors() {
  const struct sigaction now = action_of(SIGBUS);
  if (now.sa_sigaction == mend_or_die) return;
  bus_errors_before = now;
  struct sigaction action {};
  action.sa_sigaction = mend_or_die;
  action.sa_flags = SA_NODEFER | SA_ONSTACK | SA_SIGINFO;
  sigaction(SIGBUS, &action, nullptr);
}

void take(Death& death) {
  const struct sigaction now = action_of(death.signal);
  if (now.sa_handler == die || (death.may_be_work && now.sa_handler != SIG_DFL)) return;
  death.before = now;
  struct sigaction action {};
  action.sa_handler = die;
  action.sa_flags = SA_NODEFER | SA_ONSTACK;
  sigaction(death.signal, &action, nullptr);
}

void take_deaths() {
  stack_t stack{};
  sigaltstack(nullptr, &stack);
  if ((stack.ss_flags & SS_DISABLE) != 0) {  // another one would do
    stack = {};
    stack.ss_sp = spare_stack.data();
    stack.ss_size = spare_stack.size();
    sigaltstack(&stack, nullptr);
  }
  for (Death& death : deaths) take(death);
  take_bus_errors();
}

// But what someone else has taken since.
void give_back_deaths() {
  for (const Death& death : deaths) {
    if (action_of(death.signal).sa_handler == die) sigaction(death.signal, &death.before, nullptr);
  }
  if (mend_page == nullptr && action_of(SIGBUS).sa_sigaction == mend_or_die)
    sigaction(SIGBUS, &bus_errors_before, nullptr);
}

}  // namespace

StopSignals::StopSignals() {
  stop_asked = false;
  struct sigaction action {};
  action.sa_handler = request_stop;
  action.sa_flags = SA_RESTART | SA_NODEFER;
  for (std::size_t i = 0; i < kStops.size(); ++i) {
    sigaction(kStops[i], nullptr, &before_[i]);
    const bool unwanted = kStops[i] == SIGHUP && before_[i].sa_handler == SIG_IGN;  // nohup
    if (!unwanted) sigaction(kStops[i], &action, nullptr);
  }
}

StopSignals::~StopSignals() {
  // What is left then takes a moment, in which the second of two signals must not kill.
  if (stop_asked) return;
  for (std::size_t i = 0; i < kStops.size(); ++i) sigaction(kStops[i], &before_[i], nullptr);
}

void mend_bus_errors(bool (*mend)(const void*) noexcept) {
  mend_page = mend;
  take_bus_errors();
}

bool stop_requested() { return stop_asked; }

void before_dying(void (*act)()) {
  last_act = act;
  if (act != nullptr) {
    take_deaths();
  } else {
    give_back_deaths();
  }
}

void fade_before_dying(DeviceSink* sink) {
  fading_sink = sink;
  before_dying(sink != nullptr ? fade : nullptr);
}

}  // namespace lumbrical
