#pragma once

/// Damaged files, and what must become of them: an error that names a file and takes one line, or, where only values
/// changed, a dataset that keeps all promises (read_dataset has validated it); within seconds.

#include "tests/unit/io/sample_files.h"
#include "tetravox/dataset.h"
#include "tetravox/error.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tetravox::test {

/// One damaged file: where it lies, and what the tests need to know.
struct Case {
  std::string name;
  std::string directory;  ///< which an error must name
  std::string file;
  std::string solution_file;
  bool must_fail_or_equal = false;  ///< truncated: an error, or exactly the undamaged dataset
};

/// What became of a case.
struct Outcome {
  std::optional<Dataset> dataset;
  std::optional<Error> error;
  double seconds = 0.0;
};

Outcome read_case(const Case& damaged);

/// Expects what the head of this file says.
void check_outcome(const Case& damaged, const Outcome& outcome, const std::optional<Dataset>& whole);

/// Reads all cases, two at a time, and checks what became of them; returns how many ended in an error.
std::size_t check_all(const std::vector<Case>& cases, const std::optional<Dataset>& whole);

/// The undamaged files of a sample, in `directory`.
Case whole_case(const Sample& sample, const std::filesystem::path& directory);

/// A copy of the undamaged files, below `parent`, with one of them replaced.
Case make_case(const Sample& sample, const std::filesystem::path& whole, const std::filesystem::path& parent,
               const std::string& name, const std::string& victim, const std::string& content);

/// Places to cut a file of this size at: evenly spread, and near its end.
std::vector<std::size_t> cut_positions(std::size_t size, std::size_t count);

/// A replacement in a sample's file that must end in an error.
struct Hostile {
  std::string sample;
  std::string victim;
  std::string from;
  std::string to;
};

/// Expects an error of every replacement; the samples are looked up by name.
void check_hostile(std::span<const Hostile> all, std::span<const Sample* const> samples);

template <class AnySample>
void check_hostile(std::span<const Hostile> all, const std::vector<AnySample>& samples) {
  std::vector<const Sample*> pointers;
  for (const AnySample& sample : samples) pointers.push_back(&sample);
  check_hostile(all, std::span<const Sample* const>(pointers));
}

}  // namespace tetravox::test
