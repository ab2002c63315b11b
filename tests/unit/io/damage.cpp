#include "tests/unit/io/damage.h"

#include "src/support/timer.h"
#include "tetravox/io.h"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <thread>

namespace tetravox::test {

namespace {

namespace fs = std::filesystem;

constexpr double kSlowest = 10.0;  // seconds for one file, on a busy machine
constexpr std::uint64_t kMemory = std::uint64_t{1} << 30;

bool are_equal(const Dataset& a, const Dataset& b) {
  const auto equal = [](const auto& x, const auto& y) { return std::equal(x.begin(), x.end(), y.begin(), y.end()); };
  const GridShape &s = a.grid.shape, &t = b.grid.shape;
  return equal(a.mesh.points, b.mesh.points) && equal(a.mesh.cell_types, b.mesh.cell_types) &&
         equal(a.mesh.connectivity, b.mesh.connectivity) && equal(a.mesh.scalars, b.mesh.scalars) &&
         a.info.arrays.size() == b.info.arrays.size() && a.is_grid() == b.is_grid() && s.dimensions == t.dimensions &&
         s.origin == t.origin && s.spacing == t.spacing && s.direction == t.direction &&
         s.coordinates == t.coordinates && equal(a.grid.values, b.grid.values);
}

/// Calls `work(i)` for all cases, two at a time.
template <class Work>
void for_all(std::size_t count, const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto loop = [&] {
    for (std::size_t i; (i = next++) < count;) work(i);
  };
  std::thread other(loop);
  loop();
  other.join();
}

Case place_case(const Sample& sample, const fs::path& directory) {
  Case placed;
  placed.directory = directory.string();
  placed.file = sample.main_file.empty() ? directory.string() : (directory / sample.main_file).string();
  if (!sample.solution_file.empty()) placed.solution_file = (directory / sample.solution_file).string();
  return placed;
}

}  // namespace

Outcome read_case(const Case& damaged) {
  ReadOptions options;
  options.grid_file = damaged.solution_file;
  options.timeout = kSlowest;
  options.memory_limit = kMemory;
  Outcome outcome;
  const support::Timer timer;
  try {
    outcome.dataset = read_dataset(damaged.file, options);
  } catch (const Error& error) {
    outcome.error = error;
  }
  outcome.seconds = timer.seconds();
  return outcome;
}

void check_outcome(const Case& damaged, const Outcome& outcome, const std::optional<Dataset>& whole) {
  EXPECT_LT(outcome.seconds, kSlowest) << damaged.name;
  if (outcome.error) {
    const std::string message = outcome.error->what();
    EXPECT_NE(message.find(damaged.directory), std::string::npos) << damaged.name << ": names no file: " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << damaged.name << ": more than a line: " << message;
    EXPECT_NE(outcome.error->code(), ErrorCode::kInternal) << damaged.name << ": " << message;
    EXPECT_NE(outcome.error->code(), ErrorCode::kTimeout) << damaged.name << ": " << message;
  } else if (damaged.must_fail_or_equal && whole) {
    EXPECT_TRUE(are_equal(*outcome.dataset, *whole)) << damaged.name << ": a part of the data came";
  }
}

std::size_t check_all(const std::vector<Case>& cases, const std::optional<Dataset>& whole) {
  std::mutex mutex;
  std::size_t errors = 0;
  for_all(cases.size(), [&](std::size_t i) {
    const Outcome outcome = read_case(cases[i]);
    const std::lock_guard lock(mutex);
    check_outcome(cases[i], outcome, whole);
    errors += outcome.error ? 1 : 0;
  });
  return errors;
}

Case whole_case(const Sample& sample, const fs::path& directory) {
  sample.write(directory);
  return place_case(sample, directory);
}

Case make_case(const Sample& sample, const fs::path& whole, const fs::path& parent, const std::string& name,
               const std::string& victim, const std::string& content) {
  const fs::path directory = parent / name;
  fs::copy(whole, directory, fs::copy_options::recursive);
  write_text(directory / victim, content);
  Case damaged = place_case(sample, directory);
  damaged.name = sample.name + " " + victim + " " + name;
  return damaged;
}

std::vector<std::size_t> cut_positions(std::size_t size, std::size_t count) {
  std::vector<std::size_t> cuts;
  for (std::size_t i = 0; i < count; ++i) cuts.push_back(size * i / count);
  for (const std::size_t from_end : {1, 3, 9, 21})
    if (from_end < size) cuts.push_back(size - from_end);
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  return cuts;
}

void check_hostile(std::span<const Hostile> all, std::span<const Sample* const> samples) {
  const TemporaryDirectory directory;
  std::vector<Case> cases;
  for (const Hostile& hostile : all) {
    const auto sample =
        std::find_if(samples.begin(), samples.end(), [&](const Sample* s) { return s->name == hostile.sample; });
    ASSERT_NE(sample, samples.end()) << hostile.sample;
    const fs::path whole = directory.path() / ("whole-" + hostile.sample);
    if (!fs::exists(whole)) (*sample)->write(whole);
    std::string text = read_text((whole / hostile.victim).string());
    const std::size_t at = text.find(hostile.from);
    ASSERT_NE(at, std::string::npos) << hostile.sample << ": no " << hostile.from;
    text.replace(at, hostile.from.size(), hostile.to);
    const std::string name = "hostile-" + std::to_string(cases.size());
    cases.push_back(make_case(**sample, whole, directory.path(), name, hostile.victim, text));
    cases.back().name += " '" + hostile.from + "' -> '" + hostile.to + "'";
  }
  std::vector<Outcome> outcomes(cases.size());
  for_all(cases.size(), [&](std::size_t i) { outcomes[i] = read_case(cases[i]); });
  for (std::size_t i = 0; i < cases.size(); ++i) {
    EXPECT_TRUE(outcomes[i].error) << cases[i].name << ": was read as if nothing were wrong";
    check_outcome(cases[i], outcomes[i], std::nullopt);
  }
}

}  // namespace tetravox::test
