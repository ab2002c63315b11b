/// Measures the tables of pre-integration again as the papers do: time, and errors against exact integrals. Prints
/// Markdown.
///
///     preintegration_tables [--json FILE] [--quick]

#include "bench/paper_report.h"
#include "src/optics/antiderivative_table.h"
#include "src/optics/cylindrical_atlas.h"
#include "src/optics/polynomial_table.h"
#include "src/optics/preintegration_table.h"
#include "src/support/threads.h"

#include <algorithm>
#include <array>
#include <iostream>
#include <random>
#include <string>

namespace {

using namespace tetravox::bench;
using namespace tetravox::optics;
using tetravox::LengthSpacing;
using tetravox::OpacityModel;
using tetravox::OpticalFunction;
using tetravox::PreintegrationSettings;

/// As in meshes: scalars that do not differ much, and half of the lengths below an eighth of the longest.
void draw_short_segment(std::mt19937& random, double place[3]) {
  draw_segment(random, place);
  place[1] = std::clamp(place[0] + 0.5 * (place[1] - 0.5), 0.0, 1.0);
  place[2] *= place[2] * place[2];
}

/// Of table3d, at the paper's sizes.
void time_full_tables(int rounds, Report& report) {
  report.begin("full_table_seconds",
               "Seconds of a full table, 64 steps an entry (Roettger and Ertl 2002, table 2: software)",
               {"size", "straightforward", "incremental", "times faster"});
  const OpticalFunction function = make_functions(10.0)[1].function;
  for (const auto& [scalars, lengths] : {std::array{64, 32}, std::array{128, 64}, std::array{256, 128}}) {
    PreintegrationSettings settings;
    settings.scalars = scalars;
    settings.lengths = lengths;
    settings.length_spacing = LengthSpacing::kUniform;
    PreintegrationTable table;
    const auto build = [&](bool use_incremental) {
      settings.use_incremental = use_incremental;
      return median_seconds(rounds, [&] { build_preintegration_table(source_of(function), settings, table); });
    };
    const double anew = build(false), incremental = build(true);
    const std::string side = std::to_string(scalars);
    report.add({side + " x " + side + " x " + std::to_string(lengths), anew, incremental, anew / incremental});
  }
}

/// Errors of the entries themselves.
void measure_bits_and_steps(bool is_quick, Report& report) {
  report.begin("entry_errors",
               "Errors of the entries of a 64 x 64 x 32 table by bits and steps (Roettger and Ertl 2002, table 1, in "
               "software)",
               {"function", "bits", "steps", "RMS", "maximum"});
  constexpr int kScalars = 64, kLengths = 32;
  for (const NamedFunction& named : make_functions(10.0)) {
    const Samples samples = sample_entries(named.function, is_quick ? 2000 : 20000, kScalars, kLengths);
    for (const int bits : {8, 12, 16, 32})
      for (const int steps : {1, 4, 16, 64, 256}) {
        PreintegrationSettings settings;
        settings.scalars = kScalars;
        settings.lengths = kLengths;
        settings.length_spacing = LengthSpacing::kUniform;
        settings.bits = bits;
        settings.steps = steps;
        settings.use_incremental = false;
        PreintegrationTable table;
        build_preintegration_table(source_of(named.function), settings, table);
        const Errors errors =
            samples.measure([&](float a, float b, float l) { return eval_preintegration_table(table, a, b, l); });
        report.add({named.name, bits, steps, errors.rms, errors.largest});
      }
  }
}

/// What is left of the exact integral by each approximation, at 512 x 512.
void measure_polynomials(bool is_quick, Report& report) {
  report.begin(
      "polynomial_errors",
      "Errors of separable opacity and polynomial chromaticity, 512 x 512 (Guthe et al. 2002, figures 3, 4, 7)",
      {"function", "depth of the longest", "opacity", "degree", "RMS", "maximum"});
  for (const double depth : {1.0, 4.0, 16.0})
    for (const NamedFunction& named : make_functions(depth)) {
      const Samples samples(named.function, is_quick ? 2000 : 20000, draw_segment);
      for (const OpacityModel opacity : {OpacityModel::kLinear, OpacityModel::kExponential})
        for (const int degree : {0, 1, 2, 4}) {
          PreintegrationSettings settings;
          settings.scalars = 512;
          settings.degree = degree;
          settings.opacity = opacity;
          PolynomialTable table;
          build_polynomial_table(source_of(named.function), settings, table);
          const Errors errors =
              samples.measure([&](float a, float b, float l) { return eval_polynomial_table(table, a, b, l); });
          report.add({named.name, depth, name_of(opacity), degree, errors.rms, errors.largest});
        }
    }
}

void time_polynomials(int rounds, Report& report) {
  report.begin("set_up_seconds", "Seconds of setting up 512 x 512 (Guthe et al. 2002, table 4: software)",
               {"table", "straightforward", "incremental"});
  const OpticalFunction function = make_functions(10.0)[1].function;
  for (const int degree : {1, 2, 4}) {
    PreintegrationSettings settings;
    settings.scalars = 512;
    settings.degree = degree;
    const auto [anew, incremental] = time_polynomial(rounds, function, settings);
    report.add({"polynomial, n = " + std::to_string(degree), anew, incremental});
  }
  report.add({"antiderivatives", time_antiderivatives(rounds, function), "-"});
}

/// How lengths should be spaced, by how deep the longest segment is.
void measure_spacings(bool is_quick, Report& report) {
  report.begin("spacing_errors", "Errors by the spacing of lengths, viridis:ramp, 256 x 256 x 64",
               {"depth of the longest", "spacing", "RMS", "maximum"});
  for (const double depth : {1.0, 10.0, 100.0, 1000.0, 10000.0}) {
    const NamedFunction named = make_functions(depth)[0];
    const Samples samples(named.function, is_quick ? 2000 : 20000, draw_short_segment);
    for (const LengthSpacing spacing : {LengthSpacing::kUniform, LengthSpacing::kLogarithmic}) {
      PreintegrationSettings settings;
      settings.scalars = 256;
      settings.length_spacing = spacing;
      PreintegrationTable table;
      build_preintegration_table(source_of(named.function), settings, table);
      const Errors errors =
          samples.measure([&](float a, float b, float l) { return eval_preintegration_table(table, a, b, l); });
      report.add({depth, name_of(spacing), errors.rms, errors.largest});
    }
  }
}

/// The three methods at sizes of about the same memory.
void measure_methods(bool is_quick, Report& report) {
  report.begin("method_errors", "Errors and memory of the methods (depth of the longest segment: 10)",
               {"function", "method", "size", "MB", "RMS", "maximum"});
  for (const NamedFunction& named : make_functions(10.0)) {
    const Samples samples(named.function, is_quick ? 2000 : 20000, draw_short_segment);
    const PreintegrationSource source = source_of(named.function);
    const auto add = [&](const std::string& method, const std::string& size, std::uint64_t bytes,
                         const Errors& errors) {
      report.add({named.name, method, size, static_cast<double>(bytes) / 1e6, errors.rms, errors.largest});
    };
    for (const int scalars : {64, 128, 256})
      for (const LengthSpacing spacing : {LengthSpacing::kUniform, LengthSpacing::kLogarithmic}) {
        PreintegrationSettings settings;
        settings.scalars = scalars;
        settings.lengths = scalars / 2;
        settings.length_spacing = spacing;
        PreintegrationTable table;
        build_preintegration_table(source, settings, table);
        add("table3d, " + name_of(spacing), std::to_string(scalars) + ", " + std::to_string(scalars / 2), table.bytes(),
            samples.measure([&](float a, float b, float l) { return eval_preintegration_table(table, a, b, l); }));
      }
    for (const int scalars : {128, 512})
      for (const int degree : {1, 2, 4}) {
        PreintegrationSettings settings;
        settings.scalars = scalars;
        settings.degree = degree;
        PolynomialTable table;
        build_polynomial_table(source, settings, table);
        add("polynomial=" + std::to_string(degree), std::to_string(scalars), table.bytes(),
            samples.measure([&](float a, float b, float l) { return eval_polynomial_table(table, a, b, l); }));
      }
    for (const auto& [planes, tile] : {std::array{33, 32}, std::array{65, 64}, std::array{129, 128}}) {
      PreintegrationSettings settings;
      settings.planes = planes;
      settings.tile = tile;
      CylindricalAtlas atlas;
      build_cylindrical_atlas(source, settings, atlas);
      add("cylindrical", std::to_string(planes) + ", " + std::to_string(tile), atlas.bytes(),
          samples.measure([&](float a, float b, float l) { return eval_cylindrical_atlas(atlas, a, b, l); }));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::string json_file;
  bool is_quick = false;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--quick") {
      is_quick = true;
    } else if (argument == "--json" && i + 1 < argc) {
      json_file = argv[++i];
    } else {
      std::cerr << "usage: preintegration_tables [--json FILE] [--quick]\n";
      return 2;
    }
  }
  const int rounds = is_quick ? 1 : 5;
  Report report;
  std::cout << "# Tables of pre-integration, made by " << tetravox::support::hardware_threads() << " threads\n";
  time_full_tables(rounds, report);
  measure_bits_and_steps(is_quick, report);
  measure_polynomials(is_quick, report);
  time_polynomials(rounds, report);
  measure_spacings(is_quick, report);
  measure_methods(is_quick, report);
  report.note("threads", tetravox::support::hardware_threads());
  if (json_file.empty() || report.write(json_file)) return 0;
  std::cerr << "preintegration_tables: cannot write " << json_file << "\n";
  return 1;
}
