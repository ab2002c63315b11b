/// Grids at a fixed rate: against the exact picture, and against each other.

#include "src/optics/antiderivative_table.h"
#include "src/optics/slab_table.h"
#include "src/optics/steepness_table.h"
#include "src/scene/fixed_rate.h"
#include "tests/common/image_compare.h"
#include "tests/conformance/grid_rates.h"
#include "tests/conformance/grid_scenes.h"
#include "tests/reference/grid_integrator.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace tetravox::conformance {
namespace {

TEST(GridRates, ConvergeToTheExactPicture) {
  const GridSubject scene(make_hard_grids()[0].grid);
  const reference::View view{scene.camera("outside"), 64, 48};
  for (const char* function : {"smooth", "steps", "random"}) {
    const Image expected = reference::draw(scene.grid.data, {}, scene.function(function), view);
    for (const Integrator integrator : tests::kExactIntegrators) {
      double before = 1.0;
      for (const double rate : {1.0, 4.0, 16.0, 64.0}) {
        RenderSettings settings = tests::make_settings(integrator, 64, 48);
        settings.samples_per_voxel = rate;
        const tests::ImageDifference difference =
            tests::compare_images(render(scene.grid, scene.function(function), view.camera, settings), expected);
        std::printf("%s %s, %g samples a voxel: max %.2e RMS %.2e\n", function, name_of(integrator).c_str(), rate,
                    difference.max, difference.rms);
        EXPECT_LT(difference.rms, std::max(before / 4.0, 3e-4))
            << function << " " << name_of(integrator) << " " << rate;
        before = difference.rms;
      }
    }
  }
}

TEST(GridRates, NumberTypesAreReadWhereTheyLie) {
  const GridSubject doubles(make_numbers(ScalarType::kFloat64));
  EXPECT_FALSE(scene::counts_steps(doubles.grid, at_rate(1.0, Integrator::kAntiderivative)));
  for (const ScalarType type : kInPlace) {
    const GridSubject scene(make_numbers(type));
    EXPECT_TRUE(scene::counts_steps(scene.grid, at_rate(1.0, Integrator::kAntiderivative)));
    for (const auto& [name, camera] : doubles.cameras)
      for (const Integrator integrator : tests::kExactIntegrators) {
        const RenderSettings settings = at_rate(24.0, integrator);
        const OpticalFunction& function = doubles.function("smooth");
        EXPECT_TRUE(tests::images_agree(render(scene.grid, function, camera, settings),
                                        render(doubles.grid, function, camera, settings), 1e-3, 1e-4))
            << static_cast<int>(type) << " " << name << " " << name_of(integrator);
      }
  }
}

/// Negative numbers, and those at both ends of their type.
TEST(GridRates, NumbersKeepTheirSign) {
  for (const ScalarType type : {ScalarType::kInt8, ScalarType::kInt16, ScalarType::kUint8, ScalarType::kUint16}) {
    const bool is_byte = scalar_type_size(type) == 1;
    const bool is_signed = type == ScalarType::kInt8 || type == ScalarType::kInt16;
    const double span = is_byte ? 255.0 : 65535.0, first = is_signed ? -(span + 1.0) / 2.0 : 0.0;
    tests::GridOptions options;
    options.dimensions = {12, 11, 10};
    options.type = type;
    const tests::Field field = [&](const Vector3& p) { return first + span * (0.5 + 0.5 * p[0]); };
    const GridSubject scene(make_grid(options, field));
    ASSERT_EQ(scene.grid.scalar_range.min, first);
    ASSERT_EQ(scene.grid.scalar_range.max, first + span);
    const reference::View view{scene.camera("outside"), 64, 48};
    const OpticalFunction& function = scene.function("smooth");
    EXPECT_TRUE(
        tests::images_agree(render(scene.grid, function, view.camera, at_rate(16.0, Integrator::kAntiderivative)),
                            reference::draw(scene.grid.data, {}, function, view), 4e-3, 3e-4))
        << static_cast<int>(type);
  }
}

/// Of what cannot be read in place, steps start anew in each brick or are counted in cells.
TEST(GridRates, OtherGridsGoFromBrickToBrick) {
  for (const auto& [grid_name, data] : make_hard_grids()) {
    const std::string name = grid_name;
    const PreparedGrid grid = prepare_grid(data);
    const bool is_in_place = name != "uneven" && name != "cell_data" && name != "holes";
    EXPECT_EQ(scene::counts_steps(grid, at_rate(1.0, Integrator::kPartial)), is_in_place) << name;
    EXPECT_FALSE(scene::counts_steps(grid, at_rate(0.0, Integrator::kPartial))) << name;
    EXPECT_FALSE(scene::counts_steps(grid, at_rate(1.0, Integrator::kPost))) << name;
    RenderSettings filtered = at_rate(1.0, Integrator::kPartial);
    filtered.filter.kind = FilterKind::kBspline;
    EXPECT_FALSE(scene::counts_steps(grid, filtered)) << name;
  }
  const tests::Field field = tests::make_random_field(5, 2.0);
  const PreparedGrid vectors = prepare_grid(tests::make_vector_grid({}, {field, field}, 1));
  EXPECT_FALSE(scene::counts_steps(vectors, at_rate(1.0, Integrator::kPartial)));
}

/// Segments of the same ends, looked up with these rounded or integrated exactly.
TEST(GridRates, SlabsErrNoMoreThanTheTolerance) {
  for (const auto& [name, data] : make_hard_grids()) {
    const GridSubject scene(data);
    if (!scene::counts_steps(scene.grid, at_rate(1.0, Integrator::kPartial))) continue;
    for (const auto& [function_name, function] : scene.functions)
      for (const auto& [camera_name, camera] : scene.cameras)
        for (const double tolerance : {0.1, 0.02})
          for (const double rate : {0.8, 3.0}) {
            const tests::ImageDifference difference = tests::compare_images(
                render(scene.grid, function, camera, at_rate(rate, Integrator::kAntiderivative, tolerance)),
                render(scene.grid, function, camera, at_rate(rate, Integrator::kPartial, tolerance)));
            std::printf("%s %s %s, tolerance %g, rate %g: max %.2e RMS %.2e\n", name, function_name.c_str(),
                        camera_name.c_str(), tolerance, rate, difference.max, difference.rms);
            EXPECT_LE(difference.max, tolerance) << name << " " << function_name << " " << camera_name;
            EXPECT_LE(difference.rms, tolerance / 10.0) << name << " " << function_name << " " << camera_name;
          }
  }
}

double largest_of(ScalarType type) {
  const double span = scalar_type_size(type) == 1 ? 255.0 : 65535.0;
  return type == ScalarType::kInt8 || type == ScalarType::kInt16 ? std::floor(span / 2.0) : span;
}

/// What slabs may err by (optics::rounding_error).
double find_rounding_error(const PreparedGrid& grid, const OpticalFunction& function) {
  const ValueRange stored = scene::stored_range(grid);
  const auto min = static_cast<float>(stored.min), max = static_cast<float>(stored.max);
  optics::SteepnessTable steepness;
  optics::build_steepness_table(optics::build_control_point_table(function, {grid.scalar_offset, grid.scalar_scale}),
                                min, max, steepness);
  return optics::rounding_error(stored, steepness.largest_steepness(min, max), tests::diagonal_of(grid.bounds));
}

/// Integers that jump as far as their type lets them, and masks of two numbers: where slabs are looked up, places
/// between two values are rounded, too.
TEST(GridRates, RoundedPlacesErrAsMuchAsSaid) {
  const tests::Field noise = tests::make_random_field(77, 40.0);
  for (const ScalarType type : {ScalarType::kInt8, ScalarType::kUint8, ScalarType::kInt16, ScalarType::kUint16})
    for (const double most : {1.0, 255.0, 65535.0})
      for (const bool is_mask : {true, false}) {
        if (most > largest_of(type)) continue;
        tests::GridOptions options;
        options.dimensions = {21, 20, 19};
        options.type = type;
        const tests::Field field = [&](const Vector3& p) { return most * (is_mask ? std::round(noise(p)) : noise(p)); };
        const GridSubject scene(make_grid(options, field));
        for (const auto& [name, function] : scene.functions) {
          const double allowed = find_rounding_error(scene.grid, function);

          tests::ImageDifference worst;
          for (const auto& [camera_name, camera] : scene.cameras)
            for (const double rate : {0.8, 2.0}) {
              const auto draw = [&](Integrator integrator) {
                return render(scene.grid, function, camera, at_rate(rate, integrator, std::min(1.001 * allowed, 1.0)));
              };
              const tests::ImageDifference difference =
                  tests::compare_images(draw(Integrator::kAntiderivative), draw(Integrator::kPartial));
              if (difference.max > worst.max) worst = difference;
            }
          std::printf("%s 0..%g %s %s: max %.2e RMS %.2e, %.2f of what is allowed\n", scalar_type_name(type).c_str(),
                      most, is_mask ? "mask" : "noise", name.c_str(), worst.max, worst.rms, worst.max / allowed);
          EXPECT_LE(worst.max, allowed) << scalar_type_name(type) << " " << most << " " << name;
        }
      }
}

/// Slabs looked up or integrated, whole rays and clipped ones.
TEST(GridRates, InstructionSetsGiveTheSameBytes) {
  for (const ScalarType type : kInPlace) {
    const GridSubject scene(make_numbers(type));
    for (const char* function : {"smooth", "thick", "steps"})
      for (const double tolerance : {0.1, 2e-3})
        for (const bool is_clipped : {false, true}) {
          RenderSettings settings = at_rate(0.8, Integrator::kAntiderivative, tolerance);
          if (is_clipped) settings.clipping.shapes.push_back({ClipSphere{{0.1, 0.0, -0.1}, 0.6}, false});
          const Image first = render(scene.grid, scene.function(function), scene.camera("outside"), settings);
          for (const std::string& instruction_set : instruction_sets()) {
            settings.instruction_set = instruction_set;
            EXPECT_TRUE(tests::images_equal(
                render(scene.grid, scene.function(function), scene.camera("outside"), settings), first))
                << static_cast<int>(type) << " " << function << " " << tolerance << " " << instruction_set;
          }
        }
  }
}

/// So few pixels that rays side by side are many bricks apart, and steps of many cells.
TEST(GridRates, RaysFarApartMissNothing) {
  tests::GridOptions options;
  options.dimensions = {70, 66, 74};
  const GridSubject scene(make_grid(options, [](const Vector3& p) {
    return std::exp(-40.0 * ((p[0] - 0.6) * (p[0] - 0.6) + p[1] * p[1] + p[2] * p[2]));
  }));
  for (const auto& [name, camera] : scene.cameras) {
    RenderSettings settings = at_rate(16.0, Integrator::kPartial);
    settings.width = settings.height = 7;
    RenderSettings exact = settings;
    exact.samples_per_voxel = 0.0;
    EXPECT_TRUE(tests::images_agree(render(scene.grid, scene.function("smooth"), camera, settings),
                                    render(scene.grid, scene.function("smooth"), camera, exact), 4e-3, 1e-3))
        << name;
    settings.samples_per_voxel = 0.05;
    EXPECT_TRUE(tests::is_valid_picture(render(scene.grid, scene.function("smooth"), camera, settings))) << name;
  }
}

/// Rays that the clipping cuts into several parts.
TEST(GridRates, ClippedRaysAreTakenUpAgain) {
  const GridSubject scene(make_numbers(ScalarType::kUint8));
  const std::vector<ClipShape> shapes{{ClipSphere{{0.1, 0.0, -0.1}, 0.6}, false},
                                      {ClipBox{{{{-0.8, 0.9}, {-0.9, 0.8}, {-0.7, 0.9}}}}, true},
                                      {ClipSphere{{-0.5, 0.5, 0.4}, 0.3}, false}};
  for (std::size_t count = 1; count <= shapes.size(); ++count)
    for (const auto& [name, camera] : scene.cameras) {
      RenderSettings settings = at_rate(24.0, Integrator::kAntiderivative);
      settings.clipping.shapes.assign(shapes.begin(), shapes.begin() + static_cast<std::ptrdiff_t>(count));
      RenderSettings exact = settings;
      exact.samples_per_voxel = 0.0;
      exact.tolerance = 1e-4;
      EXPECT_TRUE(tests::images_agree(render(scene.grid, scene.function("smooth"), camera, settings),
                                      render(scene.grid, scene.function("smooth"), camera, exact), 3e-3, 3e-4))
          << count << " shapes, " << name;
    }
}

/// A new function, distance or tolerance asks for new slabs.
TEST(GridRates, SlabsFollowTheSettings) {
  const GridSubject scene(make_numbers(ScalarType::kUint8));
  Renderer renderer(scene.grid);
  const Camera& camera = scene.camera("outside");
  for (const char* function : {"smooth", "thick", "smooth"}) {
    renderer.set_transfer_function(scene.function(function));
    for (const double rate : {0.8, 2.0, 0.8})
      for (const double tolerance : {0.1, 0.5}) {
        const RenderSettings settings = at_rate(rate, Integrator::kAntiderivative, tolerance);
        EXPECT_TRUE(tests::images_equal(renderer.render(camera, settings),
                                        render(scene.grid, scene.function(function), camera, settings)))
            << function << " " << rate << " " << tolerance;
      }
  }
}

TEST(GridRates, SpansAreSeenWhereABrickIs) {
  const std::array<std::uint32_t, 3> counts{4, 3, 2};
  for (std::uint32_t seen = 0; seen < 24; ++seen) {
    std::vector<scene::BrickPlan> plans(24);
    plans[seen].level = 0;
    const std::vector<std::uint8_t> spans = scene::list_seen_spans(counts, plans);
    const std::uint32_t at[3] = {seen % 4, seen / 4 % 3, seen / 12};
    for (std::uint32_t brick = 0; brick < 24; ++brick)
      for (std::uint32_t span = 0; span < 8; ++span) {
        const std::uint32_t from[3] = {brick % 4, brick / 4 % 3, brick / 12};
        bool is_inside = true;
        for (std::uint32_t axis = 0; axis < 3; ++axis)
          is_inside &= at[axis] >= from[axis] && at[axis] <= from[axis] + (span >> axis & 1u);
        EXPECT_EQ((spans[brick] >> span & 1u) != 0, is_inside) << seen << " " << brick << " " << span;
      }
  }
}

TEST(GridRates, StepsAreCounted) {
  const GridSubject scene(make_numbers(ScalarType::kUint8));
  Renderer renderer(scene.grid);
  renderer.set_transfer_function(scene.function("smooth"));
  RenderStatistics once, twice;
  renderer.render(scene.camera("outside"), at_rate(2.0, Integrator::kAntiderivative, 0.1), &once);
  renderer.render(scene.camera("outside"), at_rate(4.0, Integrator::kAntiderivative, 0.1), &twice);
  EXPECT_EQ(once.rays, twice.rays);
  EXPECT_GT(once.rays, 500u);
  EXPECT_NEAR(static_cast<double>(twice.segments), 2.0 * static_cast<double>(once.segments),
              2.0 * static_cast<double>(once.rays));
}

}  // namespace
}  // namespace tetravox::conformance
