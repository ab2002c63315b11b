#pragma once

/// What the programs of `make papers` share: tables as Markdown and JSON, transfer functions, errors of entries.

#include "src/optics/antiderivative_table.h"
#include "src/optics/polynomial_table.h"
#include "src/optics/segment_domain.h"
#include "src/optics/segment_integral.h"
#include "src/support/timer.h"
#include "tetravox/transfer_function.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <random>
#include <string>
#include <vector>

namespace tetravox::bench {

using Json = nlohmann::ordered_json;

inline constexpr ValueRange kRange{0.0, 1.0};
inline constexpr double kLongest = 1.0;

/// Numbers as people read them: three digits that count.
inline std::string format(double number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", number);
  return text.data();
}

/// A table on the page and in the file.
class Report {
 public:
  void begin(const std::string& key, const std::string& title, const std::vector<std::string>& columns) {
    key_ = key;
    columns_ = columns;
    json_[key] = {{"title", title}, {"rows", Json::array()}};
    std::cout << "\n## " << title << "\n\n|";
    for (const std::string& column : columns) std::cout << " " << column << " |";
    std::cout << "\n|";
    for (std::size_t i = 0; i < columns.size(); ++i) std::cout << "---|";
    std::cout << "\n";
  }
  void add(const std::vector<Json>& cells) {
    Json row;
    std::cout << "|";
    for (std::size_t i = 0; i < cells.size(); ++i) {
      row[columns_[i]] = cells[i];
      std::cout << " "
                << (cells[i].is_number_float() ? format(cells[i].get<double>())
                    : cells[i].is_string()     ? cells[i].get<std::string>()
                                               : cells[i].dump())
                << " |";
    }
    std::cout << std::endl;
    json_[key_]["rows"].push_back(row);
  }
  /// Puts a number of the whole run beside the tables.
  void note(const std::string& key, const Json& value) { json_[key] = value; }
  /// Whether the file could be written.
  bool write(const std::string& file) const {
    std::ofstream out(file);
    out << json_.dump(1) << "\n";
    return static_cast<bool>(out.flush());
  }

 private:
  Json json_;
  std::string key_;
  std::vector<std::string> columns_;
};

struct NamedFunction {
  std::string name;
  OpticalFunction function;
};

/// A ramp and five peaks, whose extinction makes the longest segment as deep as `depth` where it is densest.
inline std::vector<NamedFunction> make_functions(double depth) {
  std::vector<NamedFunction> functions;
  for (const char* preset : {"viridis:ramp", "rainbow:peaks=5"}) {
    OpticalFunction function = make_optical_function(make_preset(preset, {kRange, false, false}), kLongest, 1e-3);
    double largest = 0.0;
    for (const OpticalPoint& point : function.points) largest = std::max(largest, point.extinction);
    for (OpticalPoint& point : function.points) point.extinction *= depth / (largest * kLongest);
    functions.push_back({preset, function});
  }
  return functions;
}

inline optics::PreintegrationSource source_of(const OpticalFunction& function) {
  return {function, {}, kRange, kLongest};
}

/// Of some rounds.
inline double median_seconds(int rounds, const std::function<void()>& work) {
  std::vector<double> seconds;
  for (int i = 0; i < rounds; ++i) {
    const support::Timer timer;
    work();
    seconds.push_back(timer.seconds());
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[seconds.size() / 2];
}

/// Seconds of setting up 512 x 512 coefficients of a polynomial.
struct SetUpSeconds {
  double straightforward = 0.0, incremental = 0.0;
};
inline SetUpSeconds time_polynomial(int rounds, const OpticalFunction& function, PreintegrationSettings settings) {
  optics::PolynomialTable table;
  const auto build = [&](bool use_incremental) {
    settings.use_incremental = use_incremental;
    return median_seconds(rounds, [&] { optics::build_polynomial_table(source_of(function), settings, table); });
  };
  return {build(false), build(true)};
}
inline double time_antiderivatives(int rounds, const OpticalFunction& function) {
  optics::AntiderivativeTable table;
  return median_seconds(10 * rounds,
                        [&] { optics::build_antiderivative_table(function, {}, kRange, kLongest, table); });
}

struct Errors {
  double rms = 0.0, largest = 0.0;
};

/// Of premultiplied colour and opacity, at segments drawn at random.
class Samples {
 public:
  Samples(const OpticalFunction& function, int count, const std::function<void(std::mt19937&, double[3])>& draw) {
    const optics::SegmentIntegral exact(function, kRange);
    std::mt19937 random(11);
    for (int i = 0; i < count; ++i) {
      Sample sample;
      draw(random, sample.place);
      sample.exact = exact.integrate(sample.place[0], sample.place[1], sample.place[2]);
      samples_.push_back(sample);
    }
  }

  Errors measure(const std::function<optics::SegmentColor(float, float, float)>& look_up) const {
    Errors errors;
    for (const Sample& sample : samples_) {
      const optics::SegmentColor found =
          look_up(static_cast<float>(sample.place[0]), static_cast<float>(sample.place[1]),
                  static_cast<float>(sample.place[2]));
      const std::array<float, 4> numbers{found.red, found.green, found.blue, found.opacity};
      for (std::size_t c = 0; c < 4; ++c) {
        const double wanted = c < 3 ? sample.exact.color[c] : sample.exact.opacity;
        const double error = std::abs(static_cast<double>(numbers[c]) - wanted);
        errors.largest = std::max(errors.largest, error);
        errors.rms += error * error / (4.0 * static_cast<double>(samples_.size()));
      }
    }
    errors.rms = std::sqrt(errors.rms);
    return errors;
  }

 private:
  struct Sample {
    double place[3] = {};  // scalars, length
    optics::Slab exact;
  };
  std::vector<Sample> samples_;
};

/// Anywhere.
inline void draw_segment(std::mt19937& random, double place[3]) {
  std::uniform_real_distribution<double> unit;
  place[0] = unit(random);
  place[1] = unit(random);
  place[2] = unit(random) * kLongest;
}

/// Of a table of that size: its own entries.
inline Samples sample_entries(const OpticalFunction& function, int count, int scalars, int lengths) {
  return {function, count, [=](std::mt19937& random, double place[3]) {
            const auto node = [&](int nodes) {
              return static_cast<double>(random() % static_cast<unsigned>(nodes)) / (nodes - 1);
            };
            place[0] = node(scalars);
            place[1] = node(scalars);
            place[2] = node(lengths) * kLongest;
          }};
}

}  // namespace tetravox::bench
