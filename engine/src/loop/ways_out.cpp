// See lumbrical/ways_out.h.
#include "lumbrical/ways_out.h"

#include <signal.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <ctime>

namespace lumbrical {
namespace {

constexpr std::array<int, 4> kStops = {SIGINT, SIGTERM, SIGQUIT, SIGHUP};
// All that end a process unless it says otherwise, but for those above, the operator's, those the program
// ignores, and SIGBUS, which may be mended.
constexpr int kDeaths[] = {SIGSEGV, SIGFPE,    SIGILL,  SIGABRT, SIGSYS, SIGTRAP,  SIGXCPU,
                           SIGALRM, SIGVTALRM, SIGPROF, SIGIO,   SIGPWR, SIGSTKFLT};

volatile std::sig_atomic_t stop_asked = 0;
volatile std::time_t asked_at = 0;  // s, monotonic

std::atomic<void (*)()> last_act{nullptr};
std::atomic<bool> dying{false};
std::atomic<bool (*)(const void*) noexcept> mend_page{nullptr};

// A stack that has run over can't carry a handler.
alignas(16) std::array<std::byte, 65536> spare_stack;

extern "C" void die(int signal) {
  if (void (*const act)() = last_act.exchange(nullptr); act != nullptr) {
    dying = true;
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
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (stop_asked == 0) {
    asked_at = now.tv_sec;
    stop_asked = 1;
  } else if (now.tv_sec - asked_at > 1) {
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

void handle_bus_errors() {
  struct sigaction action {};
  action.sa_sigaction = mend_or_die;
  action.sa_flags = SA_NODEFER | SA_ONSTACK | SA_SIGINFO;
  sigaction(SIGBUS, &action, nullptr);
}

}  // namespace

StopSignals::StopSignals() {
  stop_asked = 0;
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
  if (stop_asked != 0) return;
  for (std::size_t i = 0; i < kStops.size(); ++i) sigaction(kStops[i], &before_[i], nullptr);
}

void mend_bus_errors(bool (*mend)(const void*) noexcept) {
  mend_page = mend;
  handle_bus_errors();
}

bool stop_requested() { return stop_asked != 0; }

void before_dying(void (*act)()) {
  last_act = act;
  stack_t stack{};
  stack.ss_sp = spare_stack.data();
  stack.ss_size = spare_stack.size();
  sigaltstack(&stack, nullptr);
  struct sigaction action {};
  action.sa_handler = act != nullptr ? die : SIG_DFL;
  action.sa_flags = SA_NODEFER | SA_ONSTACK;
  for (const int signal : kDeaths) sigaction(signal, &action, nullptr);
  handle_bus_errors();
}

void fade_before_dying(DeviceSink* sink) {
  fading_sink = sink;
  before_dying(sink != nullptr ? fade : nullptr);
}

}  // namespace lumbrical
