#include "files/cell_sort.h"

#include <algorithm>
#include <span>
#include <utility>

namespace lumbrical {
namespace {

bool is_before(const CellEntry& a, const CellEntry& b) {
  return a.cell != b.cell ? a.cell < b.cell : a.triangle < b.triangle;
}

}  // namespace

Status CellSort::open(const std::string& path, std::size_t memory) {
  capacity_ = memory / sizeof(CellEntry);
  return file_.open(path);
}

Status CellSort::add(const CellEntry& entry) {
  if (entries_.size() == capacity_)
    if (Status status = spill(); !status.ok()) return status;
  entries_.push_back(entry);
  return {};
}

Status CellSort::spill() {
  std::sort(entries_.begin(), entries_.end(), is_before);
  Run run;
  run.offset = file_.size();
  run.left = entries_.size();
  runs_.push_back(std::move(run));
  const Status status = file_.append(std::as_bytes(std::span(entries_)));
  entries_.clear();
  return status;
}

Status CellSort::merge() {
  if (runs_.empty()) {
    std::sort(entries_.begin(), entries_.end(), is_before);
    runs_.emplace_back().entries = std::move(entries_);
  } else {
    if (Status status = spill(); !status.ok()) return status;
    std::vector<CellEntry>().swap(entries_);
    for (Run& run : runs_)
      if (Status status = refill(run); !status.ok()) return status;
  }
  for (std::size_t i = 0; i < runs_.size(); ++i)
    if (!runs_[i].entries.empty()) heap_.push_back(i);
  std::make_heap(heap_.begin(), heap_.end(), [this](std::size_t a, std::size_t b) { return is_later(a, b); });
  return {};
}

bool CellSort::is_later(std::size_t a, std::size_t b) const {
  return is_before(runs_[b].entries[runs_[b].at], runs_[a].entries[runs_[a].at]);
}

Status CellSort::refill(Run& run) {
  const std::size_t share = std::max<std::size_t>(capacity_ / runs_.size(), 256);
  run.entries.resize(std::min<std::uint64_t>(run.left, share));
  run.at = 0;
  const auto bytes = std::as_writable_bytes(std::span(run.entries));
  if (Status status = file_.read(run.offset, bytes); !status.ok()) return status;
  run.offset += bytes.size();
  run.left -= run.entries.size();
  return {};
}

Status CellSort::next(CellEntry& entry, bool& end) {
  end = heap_.empty();
  if (end) return {};
  const auto by_entry = [this](std::size_t a, std::size_t b) { return is_later(a, b); };
  std::pop_heap(heap_.begin(), heap_.end(), by_entry);
  Run& run = runs_[heap_.back()];
  entry = run.entries[run.at++];
  if (run.at == run.entries.size() && run.left > 0)
    if (Status status = refill(run); !status.ok()) return status;
  if (run.at == run.entries.size()) {
    heap_.pop_back();
  } else {
    std::push_heap(heap_.begin(), heap_.end(), by_entry);
  }
  return {};
}

}  // namespace lumbrical
