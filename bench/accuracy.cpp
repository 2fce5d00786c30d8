// Holds every law, at every precision there is, against the reference, over a million pairs: errors and
// times, as a table and as JSON.
//
//   accuracy [--pairs N] [--seed S] [--threads T] [--check N] [--out FOLDER]
//
// N pairs in all, alike of every shape and angle class; of all of them --check N are also done in fifty
// digits. The pairs are the same for any number of threads. Without --out the table goes to standard output.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "accuracy_pairs.h"
#include "accuracy_table.h"
#include "base/floating_point.h"
#include "borders/pair_contact.h"
#include "machine.h"
#include "origin.h"
#include "read_number.h"
#include "timing.h"
#include "usage.h"

namespace {

using namespace lumbrical;
using namespace lumbrical::bench;

constexpr double kPointArea = 1e-4;

// ---- What is measured
// ---------------------------------------------------------------------------------------------

/// One way to compute a contact: false where there is none.
struct Evaluator {
  const char* name;
  std::function<bool(const Pair&, Law, Contact&)> collide;
};

// One pair at a time; in a tick pairs share their lanes and cost less (pair_bench).
bool collide_exactly(const Pair& pair, Law law, Contact& contact) {
  const ContactQuery query{kPointArea, nullptr, exact_kernels(widest_isa())};
  Primitive primitive = pair.primitive;
  primitive.law = law;
  return collide(primitive, query, {pair.corners[0], pair.corners[1], pair.corners[2]}, contact);
}

/// A further precision is one more line here.
const Evaluator kEvaluators[] = {
    {"exact", collide_exactly},
};

struct NamedLaw {
  Law law;
  const char* name;
};
constexpr NamedLaw kLaws[] = {{Law::field, "field"},
                              {Law::column, "column"},
                              {Law::max_depth, "max-depth"},
                              {Law::centroid, "centroid"},
                              {Law::point, "point"}};

/// What is compared, and the power of R it is measured in. The first three are the same under every law.
struct Quantity {
  const char* law;
  const char* name;
  int power;
};
constexpr Quantity kQuantities[] = {{"every", "area", 2},          {"every", "area's first moment", 3},
                                    {"every", "dl_max", 1},        {"field", "volume", 3},
                                    {"field", "first moment", 4},  {"column", "volume", 3},
                                    {"column", "first moment", 4}, {"max-depth", "volume", 3},
                                    {"centroid", "volume", 3},     {"point", "volume / area", 1}};
constexpr std::size_t kQuantityCount = std::size(kQuantities);

bool is_moment(const Quantity& quantity) { return std::string(quantity.name).ends_with("moment"); }

struct Cell {
  Form form;
  Angle angle;
};
constexpr Cell kCells[] = {{Form::sphere, Angle::any},      {Form::cylinder, Angle::any},
                           {Form::cylinder, Angle::lying},  {Form::cylinder, Angle::upright},
                           {Form::capsule, Angle::any},     {Form::capsule, Angle::lying},
                           {Form::capsule, Angle::upright}, {Form::cone, Angle::any},
                           {Form::cone, Angle::lying},      {Form::cone, Angle::upright}};

struct Options {
  std::size_t pairs = 10000, check = 40;
  std::uint64_t seed = 1;
  unsigned threads = std::max(1u, std::thread::hardware_concurrency());
  std::string out;
};

// ---- One pair
// -----------------------------------------------------------------------------------------------------

/// Errors of one pair and one evaluator, absolute over the power of R and relative.
struct PairErrors {
  std::array<float, kQuantityCount> absolute{}, relative{};
  float missed = 0;  ///< [R^2] contacted area where the evaluator sees none
};

/// What the reference says of a pair, and of itself.
struct Expected {
  reference::Contact<long double> contact;
  double area_error = 0, field_error = 0, column_error = 0;
};

Vec3 from_reference(const reference::Vector<long double>& a) {
  return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
}

PairErrors compare(const Pair& pair, const reference::Contact<long double>& expected,
                   const Evaluator& evaluator) {
  PairErrors errors;
  const long double r = pair.radius;
  std::size_t next = 0;
  const auto add = [&](long double difference, long double value) {
    // A NaN is the largest error there is.
    const long double size = std::isnan(difference) ? HUGE_VALL : std::fabs(difference);
    errors.absolute[next] = static_cast<float>(size / std::pow(r, kQuantities[next].power));
    errors.relative[next] = value > 0 ? static_cast<float>(size / value) : 0;
    ++next;
  };
  const auto moment = [&](double amount, Vec3 centre, const reference::Load<long double>& load) {
    // About the reference's own centre. What acts nowhere has no centre.
    add(amount * static_cast<long double>(amount > 0 ? norm(centre - from_reference(load.centre)) : 0), 0);
  };
  Contact contact[std::size(kLaws)];
  for (std::size_t i = 0; i < std::size(kLaws); ++i) {
    contact[i] = {};
    if (!evaluator.collide(pair, kLaws[i].law, contact[i])) contact[i] = {};
  }
  const Contact& first = contact[0];
  const bool touches = first.area > 0;
  const auto& area = expected.area.amount;
  if (!touches) errors.missed = static_cast<float>(area / (r * r));
  add(first.area - area, area);
  moment(first.area, first.centroid, expected.area);
  add(touches ? first.depth - expected.deepest : 0, expected.deepest);
  add(first.volume - expected.field.amount, expected.field.amount);
  moment(first.volume, first.centre, expected.field);
  add(contact[1].volume - expected.column.amount, expected.column.amount);
  moment(contact[1].volume, contact[1].centre, expected.column);
  add(contact[2].volume - area * expected.deepest, area * expected.deepest);
  add(contact[3].volume - area * expected.at_centroid, area * expected.at_centroid);
  add(touches ? contact[4].volume / kPointArea - expected.deepest : 0, expected.deepest);
  return errors;
}

/// The pair of this number that touches, the same whoever asks for it.
Pair touching_pair(const Options& options, std::size_t cell, std::size_t index, Expected& expected) {
  test::Random random((options.seed * 1000003 + cell) * 1000000007 + index);
  for (;;) {
    const Pair pair = draw_pair(kCells[cell].form, kCells[cell].angle, random);
    expected.contact =
        reference::contact<long double>(to_reference(pair.primitive), to_reference(pair.corners));
    if (!expected.contact.touches) continue;
    const auto relative_to = [&](const reference::Load<long double>& load, int power) {
      return static_cast<double>(load.error) / std::pow(pair.radius, power);
    };
    expected.area_error = relative_to(expected.contact.area, 2);
    expected.field_error = relative_to(expected.contact.field, 3);
    expected.column_error = relative_to(expected.contact.column, 3);
    return pair;
  }
}

// ---- All of them
// --------------------------------------------------------------------------------------------------

struct Samples {
  std::vector<Pair> pairs;
  std::vector<Expected> expected;
};

/// Calls work(i) for 0 <= i < count on several threads.
void in_parallel(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> workers;
  for (unsigned t = 0; t < threads; ++t) {
    workers.emplace_back([&] {
      const FloatingPointGuard guard;
      for (std::size_t i = next++; i < count; i = next++) work(i);
    });
  }
  for (std::thread& worker : workers) worker.join();
}

Samples draw_samples(const Options& options, std::size_t cell, std::size_t count) {
  Samples samples{std::vector<Pair>(count), std::vector<Expected>(count)};
  in_parallel(count, options.threads, [&](std::size_t i) {
    samples.pairs[i] = touching_pair(options, cell, i, samples.expected[i]);
  });
  return samples;
}

void note_reference(const Options& options, const Samples& samples, Report& report) {
  for (const Expected& expected : samples.expected) {
    report.estimated_area = std::max(report.estimated_area, expected.area_error);
    report.estimated_field = std::max(report.estimated_field, expected.field_error);
    report.estimated_column = std::max(report.estimated_column, expected.column_error);
  }
  const std::size_t checks = std::min(options.check / std::size(kCells), samples.pairs.size());
  std::vector<std::array<double, 4>> off(checks);
  in_parallel(checks, options.threads, [&](std::size_t i) {
    const Pair& pair = samples.pairs[i];
    const auto& seen = samples.expected[i].contact;
    const auto exact =
        reference::contact<reference::Multi>(to_reference(pair.primitive), to_reference(pair.corners));
    const auto error = [&](long double got, const reference::Multi& wanted, int power) {
      return std::fabs(static_cast<double>(got - wanted)) / std::pow(pair.radius, power);
    };
    off[i] = {error(seen.area.amount, exact.area.amount, 2), error(seen.field.amount, exact.field.amount, 3),
              error(seen.column.amount, exact.column.amount, 3), error(seen.deepest, exact.deepest, 1)};
  });
  report.checked += checks;
  for (const auto& errors : off) {
    report.checked_area = std::max(report.checked_area, errors[0]);
    report.checked_field = std::max(report.checked_field, errors[1]);
    report.checked_column = std::max(report.checked_column, errors[2]);
    report.checked_depth = std::max(report.checked_depth, errors[3]);
  }
}

/// Median over repeats of the time the first of the pairs take one after the other, per pair.
double nanoseconds_per_pair(const Evaluator& evaluator, Law law, const std::vector<Pair>& all) {
  using Clock = std::chrono::steady_clock;
  const FloatingPointGuard guard;
  const std::span<const Pair> pairs(all.data(), std::min<std::size_t>(all.size(), 4000));
  std::vector<double> times;
  double sum = 0;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const auto start = Clock::now();
    for (const Pair& pair : pairs) {
      Contact contact;
      if (evaluator.collide(pair, law, contact)) sum += contact.volume;
    }
    times.push_back(std::chrono::duration<double, std::nano>(Clock::now() - start).count());
  }
  if (!(sum >= 0)) std::fprintf(stderr, "volumes sum up to %g\n", sum);
  return percentile(times, 0.5) / static_cast<double>(pairs.size());
}

/// All errors of the pairs of some cells and one evaluator, by quantity.
struct Collected {
  std::array<std::vector<float>, kQuantityCount> absolute, relative;
  std::array<float, kQuantityCount> worst{};
  std::array<std::string, kQuantityCount> worst_pair;
};

void collect(const Samples& samples, const std::vector<PairErrors>& errors, Collected& collected) {
  for (std::size_t i = 0; i < errors.size(); ++i) {
    for (std::size_t k = 0; k < kQuantityCount; ++k) {
      const float error = errors[i].absolute[k];
      collected.absolute[k].push_back(error);
      collected.relative[k].push_back(errors[i].relative[k]);
      if (error > collected.worst[k])
        collected.worst[k] = error, collected.worst_pair[k] = describe(samples.pairs[i]);
    }
  }
}

void add_rows(const char* shape, const char* angle, const Evaluator& evaluator, Collected& collected,
              Report& report) {
  for (std::size_t k = 0; k < kQuantityCount; ++k) {
    const Quantity& quantity = kQuantities[k];
    report.rows.push_back({shape, angle, evaluator.name, quantity.law, quantity.name,
                           quantity.power == 1 ? "R" : "R^" + std::to_string(quantity.power),
                           collected.absolute[k].size(), spread_of(collected.absolute[k]),
                           spread_of(collected.relative[k]), !is_moment(quantity), collected.worst_pair[k]});
  }
}

void run_form(const Options& options, Form form, Report& report) {
  std::vector<Collected> all(std::size(kEvaluators));
  for (std::size_t cell = 0; cell < std::size(kCells); ++cell) {
    if (kCells[cell].form != form) continue;
    const char* shape = kFormNames[static_cast<int>(form)];
    const char* angle = kAngleNames[static_cast<int>(kCells[cell].angle)];
    std::fprintf(stderr, "%s, %s ...\n", shape, angle);
    const Samples samples = draw_samples(options, cell, options.pairs / std::size(kCells));
    report.pairs += samples.pairs.size();
    note_reference(options, samples, report);
    for (std::size_t e = 0; e < std::size(kEvaluators); ++e) {
      std::vector<PairErrors> errors(samples.pairs.size());
      in_parallel(errors.size(), options.threads, [&](std::size_t i) {
        errors[i] = compare(samples.pairs[i], samples.expected[i].contact, kEvaluators[e]);
      });
      for (const PairErrors& one : errors) {
        if (one.missed > 0) ++report.missed;
        report.largest_missed = std::max(report.largest_missed, static_cast<double>(one.missed));
      }
      Collected here;
      collect(samples, errors, here);
      collect(samples, errors, all[e]);
      if (form != Form::sphere) add_rows(shape, angle, kEvaluators[e], here, report);
      for (const NamedLaw& law : kLaws) {
        report.speeds.push_back({shape, angle, kEvaluators[e].name, law.name,
                                 nanoseconds_per_pair(kEvaluators[e], law.law, samples.pairs)});
      }
    }
  }
  for (std::size_t e = 0; e < std::size(kEvaluators); ++e) {
    add_rows(kFormNames[static_cast<int>(form)], "all", kEvaluators[e], all[e], report);
  }
}

// ---- The machine
// --------------------------------------------------------------------------------------------------

const char* isa_name() {
#if defined(__AVX512F__)
  return "built for AVX-512";
#elif defined(__AVX2__)
  return "built for AVX2";
#elif defined(__SSE2__)
  return "built for SSE2";
#elif defined(__aarch64__)
  return "built for AArch64";
#else
  return "built for the baseline";
#endif
}

constexpr std::size_t kMostPairs = 1000000000;

bool parse(int count, char** words, Options& options) {
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string name = words[i];
    const char* value = words[i + 1];
    bool is_read = true;
    if (name == "--pairs")
      is_read = read_number(value, kMostPairs, options.pairs);
    else if (name == "--seed")
      is_read = read_number_or_0(value, UINT64_MAX, options.seed);
    else if (name == "--threads")
      is_read = read_number(value, 1024u, options.threads);
    else if (name == "--check")
      is_read = read_number_or_0(value, kMostPairs, options.check);
    else if (name == "--out")
      options.out = value;
    else
      return false;
    if (!is_read) return false;
  }
  return count % 2 == 1 && options.pairs >= std::size(kCells);
}

}  // namespace

int main(int count, char** words) {
  Options options;
  if (!parse(count, words, options)) {
    return tell_usage("accuracy [--pairs N] [--seed S] [--threads T] [--check N] [--out FOLDER]", count,
                      words);
  }
  Report report;
  report.origin = origin_members();
  report.cpu = cpu_name();
  report.isa = isa_name();
  report.compiler = LUMBRICAL_COMPILER;
  report.flags = LUMBRICAL_COMPILER_FLAGS;
  report.command =
      "cmake --preset release && cmake --build --preset release --target "
      "accuracy\nbuild/release/bench/accuracy";
  for (int i = 1; i < count; ++i) report.command += std::string(" ") + words[i];
  for (const Form form : {Form::sphere, Form::cylinder, Form::capsule, Form::cone})
    run_form(options, form, report);
  const std::string table = to_markdown(report);
  if (options.out.empty()) {
    std::fputs(table.c_str(), stdout);
    return 0;
  }
  std::filesystem::create_directories(options.out);
  std::ofstream markdown(options.out + "/accuracy.md"), json(options.out + "/accuracy.json");
  markdown << table;
  json << to_json(report);
  markdown.close();
  json.close();
  if (!markdown.fail() && !json.fail()) return 0;
  std::fprintf(stderr, "can't write to %s\n", options.out.c_str());
  return 1;
}
