// See lumbrical/shared_memory_wire.h.
#include "lumbrical/shared_memory_wire.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cstring>
#include <string>

#include "base/floating_point.h"
#include "base/set_bits.h"
#include "base/steady_clock.h"
#include "lumbrical/math.h"
#include "lumbrical/shared_device.h"

namespace lumbrical {
namespace {

using Region = lumbrical_shared_device;
static_assert(LUMBRICAL_SHARED_ACTUATORS == kMaxActuators && LUMBRICAL_SHARED_ANGLES == kAngleCount);

constexpr timespec kGlance{0, 20000};  // between two looks for the answer

// Whoever may write to it may also shorten it, and reading it would be the end of the process.
std::string fault_of(int file) {
  struct stat region {};
  if (fstat(file, &region) != 0) return std::strerror(errno);
  if (region.st_uid != geteuid()) return "belongs to another user";
  if ((region.st_mode & (S_IWGRP | S_IWOTH)) != 0)
    return "can be written by others; create it with mode 0600";
  if (region.st_size < static_cast<off_t>(sizeof(Region))) return "is too small";
  return {};
}

class SharedMemoryWire final : public DeviceWire {
 public:
  explicit SharedMemoryWire(const DeviceProfile& profile) : profile_(profile) {}
  ~SharedMemoryWire() override { let_go(); }

  Status open() override;
  WireResult exchange(const WireCommand& command, WireAnswer& answer) override;
  WireResult read_commands(ActuatorArray& command) override;
  void close() override { let_go(); }

 private:
  void let_go() {
    if (region_ != nullptr) munmap(region_, sizeof(Region));
    if (file_ >= 0) ::close(file_);
    region_ = nullptr;
    file_ = -1;
  }
  std::string take_region();
  [[nodiscard]] bool is_gone() const;
  [[nodiscard]] WireResult gone() const;
  bool take_answer(std::uint64_t cycle, WireAnswer& answer) const;

  DeviceProfile profile_;
  Region* region_ = nullptr;
  int file_ = -1;  // its lock keeps other sessions away
  std::uint64_t session_ = 0;
};

Status SharedMemoryWire::open() {
  let_go();
  const std::string& name = profile_.transport.region;
  file_ = shm_open(name.c_str(), O_RDWR | O_CLOEXEC, 0);
  if (file_ < 0)
    return Status::error(name + ": " + (errno == ENOENT ? "no such region yet" : std::strerror(errno)));
  if (const std::string fault = take_region(); !fault.empty()) {
    let_go();
    return Status::error(name + ": " + fault);
  }
  session_ = static_cast<std::uint64_t>(steady_ns());
  return {};
}

// Why it can't be taken, if it can't. The lock falls with the process, so a guard finds it open.
std::string SharedMemoryWire::take_region() {
  if (std::string fault = fault_of(file_); !fault.empty()) return fault;
  if (flock(file_, LOCK_EX | LOCK_NB) != 0)
    return errno == EWOULDBLOCK ? "another session drives it; end that one first" : std::strerror(errno);
  void* const mapped = mmap(nullptr, sizeof(Region), PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0);
  if (mapped == MAP_FAILED) return std::strerror(errno);
  region_ = static_cast<Region*>(mapped);
  const bool known = __atomic_load_n(&region_->magic, __ATOMIC_ACQUIRE) == LUMBRICAL_SHARED_MAGIC &&
                     region_->size == sizeof(Region);
  return known ? "" : "is no region of lumbrical/shared_device.h, or not ready";
}

// A device that was started again has unlinked it and made another one.
bool SharedMemoryWire::is_gone() const {
  struct stat ours {};
  return fstat(file_, &ours) != 0 || ours.st_nlink == 0;
}

WireResult SharedMemoryWire::exchange(const WireCommand& command, WireAnswer& answer) {
  lumbrical_shared_command told{};
  told.session = session_;
  told.cycle = command.cycle;
  told.active = command.output.device_on ? 1 : 0;
  told.actuator_count = profile_.actuators.size();
  for (std::size_t i = 0; i < profile_.actuators.size(); ++i) {
    const LocalModel local = local_model_of(command, i);
    told.value[i] = command.output.command[i];
    told.angle[i] = local.angle;
    told.stiffness[i] = local.stiffness;
    told.radius[i] = local.radius;
  }
  if (is_gone()) return gone();
  answer.asked = steady_ns();
  lumbrical_shared_write(&region_->command_turn, region_->command, &told, sizeof told);
  while (!take_answer(command.cycle, answer)) {
    if (is_gone()) return gone();
    if (in_seconds(steady_ns() - answer.asked) > patience.limit())
      return {WireOutcome::missed, "no answer in " + profile_.transport.region};
    nanosleep(&kGlance, nullptr);
  }
  return {};
}

WireResult SharedMemoryWire::gone() const {
  return {WireOutcome::broken, profile_.transport.region + " was made anew, or removed"};
}

bool SharedMemoryWire::take_answer(std::uint64_t cycle, WireAnswer& answer) const {
  lumbrical_shared_feedback said;
  if (!lumbrical_shared_read(&region_->feedback_turn, region_->feedback, &said, sizeof said)) return false;
  if (said.session != session_ || said.cycle != cycle) return false;
  answer.status.ready = said.not_ready == 0;
  answer.status.fault = said.fault != 0;
  answer.status.stop = said.stop != 0;
  answer.status.has_dead_man = said.dead_man != 0;
  answer.status.dead_man = said.dead_man == 0 || said.dead_man == 2;  // in doubt released
  answer.valid = 0;
  for (std::size_t a = 0; a < answer.angle.size(); ++a) {
    const bool told = has_bit(said.valid, a) && fits_float(said.angle[a]);
    answer.angle[a] = told ? static_cast<float>(said.angle[a]) : 0;
    answer.valid |= static_cast<std::uint32_t>(told) << a;
  }
  return true;
}

// What a process that was killed has left there.
WireResult SharedMemoryWire::read_commands(ActuatorArray& command) {
  lumbrical_shared_command left;
  if (!lumbrical_shared_read(&region_->command_turn, region_->command, &left, sizeof left))
    return {WireOutcome::refused, "the command in " + profile_.transport.region + " was torn"};
  for (std::size_t i = 0; i < profile_.actuators.size(); ++i) {
    const Actuator& actuator = profile_.actuators[i];
    if (is_finite(left.value[i]) && left.cycle != 0)
      command[i] = clamp(left.value[i], actuator.lower, actuator.upper);
  }
  return {};
}

}  // namespace

Status make_shared_memory_wire(const DeviceProfile& profile, std::unique_ptr<DeviceWire>& wire) {
  const std::string& name = profile.transport.region;
  if (name.size() < 2 || name.size() > 200 || name[0] != '/' || name.find('/', 1) != std::string::npos)
    return Status::error("\"" + name + "\" is no name of shared memory; write /name");
  wire = std::make_unique<SharedMemoryWire>(profile);
  return {};
}

}  // namespace lumbrical
