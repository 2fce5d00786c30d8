// See output.h.
#include "output.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "commands.h"

namespace lumbrical::tool {

std::string printable(std::string_view text, bool lines) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const unsigned char next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0;
    const bool c1 = byte == 0xc2 && next >= 0x80 && next <= 0x9f;  // in UTF-8
    if (!c1 && byte >= 0x20 && byte != 0x7f) {
      result += text[i];
    } else if (byte == '\n') {
      result += lines ? "\n" : "\\n";
    } else {
      const unsigned code = c1 ? next : byte;
      result += {'\\', 'x', kDigits[code >> 4], kDigits[code & 15]};
      i += c1 ? 1 : 0;
    }
  }
  return result;
}

namespace {

bool json_wanted = false, result_printed = false;
std::string first_failure;

}  // namespace

void failures_as_json() { json_wanted = true; }

int finish(int exit_code) {
  if (exit_code == kDone || !json_wanted || result_printed) return exit_code;
  print_json({{"error", first_failure}, {"exit_code", exit_code}});
  return exit_code;
}

int fail(std::string_view message) {
  if (first_failure.empty()) first_failure = message;
  std::fprintf(stderr, "%s\n", printable(message).c_str());
  return kUnreadable;
}

void warn(std::string_view message) { std::fprintf(stderr, "warning: %s\n", printable(message).c_str()); }

int fail(const Status& status) { return fail(status.message()); }

int print_text(std::string_view unchecked) {
  result_printed = true;
  const std::string text = printable(unchecked, true);
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if ((std::fflush(stdout) == 0 && written) || errno == EPIPE) return kDone;
  return fail("standard output: can't write the result; is the disk full?");
}

Json parse_json(std::string_view text) {
  constexpr int kDeepest = 100;
  bool too_deep = false;
  const auto look = [&too_deep](int depth, Json::parse_event_t, Json&) {
    too_deep = too_deep || depth > kDeepest;
    return !too_deep;
  };
  Json json = Json::parse(text, look, false);
  return too_deep ? Json(Json::value_t::discarded) : json;
}

int print_json(const Json& object) {
  // Names may come from files in any encoding; bytes that are not UTF-8 are replaced instead of throwing, and
  // what is beyond ASCII, control characters among it, is escaped.
  return print_text(object.dump(-1, ' ', true, Json::error_handler_t::replace) + '\n');
}

Json to_json(Vec3 v) { return Json::array({v.x, v.y, v.z}); }

std::string Table::text() const {
  std::size_t width = 0;
  for (const auto& [name, value] : rows) width = std::max(width, name.size());
  std::string text;
  for (const auto& [name, value] : rows)
    text += name + std::string(width - name.size() + 2, ' ') + value + '\n';
  return text;
}

std::string grouped(std::uint64_t number) {
  std::string digits = std::to_string(number);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, ",");
  return digits;
}

std::string brief(double number, int digits) {
  std::array<char, 64> text{};
  const double size = std::fabs(number);
  if (size != 0 && !(size >= 1e-4 && size < 1e9)) {
    std::snprintf(text.data(), text.size(), "%.*g", digits, number);
    return text.data();
  }
  const int whole = size < 1e-4 ? 0 : static_cast<int>(std::floor(std::log10(size)));
  std::snprintf(text.data(), text.size(), "%.*f", std::max(0, digits - 1 - whole), number);
  return text.data();
}

std::string precision_name(double precision) {
  if (!(precision > 0)) return "exact";
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.begin(), text.end(), precision, std::chars_format::scientific).ptr;
  std::string name(text.begin(), end);
  if (const std::size_t zero = name.find("e-0"); zero != std::string::npos) name.erase(zero + 2, 1);
  return name;
}

Json to_json(const VoxelReport& report) {
  return {{"voxel_size", report.voxel_size},
          {"voxels", report.voxels},
          {"entries", report.entries},
          {"wide", report.wide},
          {"bytes", report.bytes},
          {"has_distance", report.has_distance},
          {"from_cache", report.from_cache},
          {"build_seconds", report.build_seconds},
          {"note", report.note}};
}

void add_voxels(const VoxelReport& report, Table& table) {
  table.add("voxel index", grouped(report.voxels) + " voxels of " + brief(1e3 * report.voxel_size) +
                               " mm with " + grouped(report.entries) + " entries, " + grouped(report.wide) +
                               " wide triangles");
  table.add("", brief(1e-6 * static_cast<double>(report.bytes)) + " MB, " +
                    (report.from_cache ? "read in " : "built in ") + brief(1e3 * report.build_seconds) +
                    " ms");
  if (!report.note.empty()) table.add("", report.note);
}

Progress::Progress(std::string what) : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::update(std::uint64_t done, std::uint64_t all) {
  if (!terminal_ || all == 0) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_draw_) return;
  next_draw_ = now + std::chrono::milliseconds(100);
  constexpr int kWidth = 30;
  const double share = static_cast<double>(std::min(done, all)) / static_cast<double>(all);
  const int filled = static_cast<int>(share * kWidth);
  std::fprintf(stderr, "\r%s [%s%s] %3d %%\033[K", what_.c_str(), std::string(filled, '#').c_str(),
               std::string(kWidth - filled, ' ').c_str(), static_cast<int>(share * 100));
  std::fflush(stderr);
}

void TickTimes::add(std::uint32_t nanoseconds) {
  // Below 2^kSubclassBits every value has its own class; above, the leading bits choose it.
  const int shift = std::max(0, static_cast<int>(std::bit_width(nanoseconds)) - 1 - kSubclassBits);
  const std::size_t index = (static_cast<std::size_t>(shift) << kSubclassBits) + (nanoseconds >> shift);
  ++count_[index];
  ++total_;
  max_ = std::max(max_, nanoseconds);
}

double TickTimes::percentile(double share) const {
  if (total_ == 0) return 0;
  const double wanted = share * static_cast<double>(total_);
  std::uint64_t seen = 0;
  for (std::size_t index = 0; index < count_.size(); ++index) {
    seen += count_[index];
    if (static_cast<double>(seen) < wanted) continue;
    const std::size_t octave = index >> kSubclassBits;
    const std::size_t shift = octave == 0 ? 0 : octave - 1;
    const std::uint64_t above = (index - (shift << kSubclassBits) + 1) << shift;
    return std::min(static_cast<double>(above - 1), static_cast<double>(max_));
  }
  return max_;
}

}  // namespace lumbrical::tool
