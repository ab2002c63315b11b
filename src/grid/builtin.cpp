#include "src/grid/builtin.h"

#include "src/grid/survey.h"
#include "src/grid/visit_type.h"
#include "src/support/check.h"
#include "src/support/memory.h"
#include "src/support/threads.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <type_traits>

namespace tetravox::grid {
namespace {

using MakeField = BuiltinField (*)(const BuiltinGridRequest& request);

/// An embedded grid: how it is called, how its fields are made.
struct Builtin {
  BuiltinGridEntry entry;
  std::vector<MakeField> make_fields;
};

const std::vector<Builtin>& builtins() {
  static const std::vector<Builtin> all = {
      {{"marschner-lobb", "the test signal of Marschner and Lobb", 41, ScalarType::kFloat32, false},
       {[](const BuiltinGridRequest& request) { return make_marschner_lobb_field(request.size); }}},
      {{"hydrogen", "an orbital of a hydrogen atom: two lobes and a ring", 16, ScalarType::kUint8, false},
       {[](const BuiltinGridRequest& request) { return make_hydrogen_field(request.size); },
        [](const BuiltinGridRequest& request) { return make_hydrogen_wave(request.size); }}},
      {{"turbulence", "octaves of band-limited noise", 128, ScalarType::kUint8, true},
       {[](const BuiltinGridRequest& request) { return make_turbulence_field(request.size, request.seed); }}}};
  return all;
}

/// A value in [0, 1] as T: itself, or stretched over the range of an integer and rounded.
template <class T>
T stretch(double value) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(value);
  } else {
    // Whole steps above the lowest value, which unsigned numbers count and wrap as we want.
    using Unsigned = std::make_unsigned_t<T>;
    constexpr Unsigned kSteps = std::numeric_limits<Unsigned>::max();
    constexpr auto kLowest = static_cast<Unsigned>(std::numeric_limits<T>::lowest());
    using Wide = std::conditional_t<sizeof(T) <= 2, std::int32_t, std::uint64_t>;
    Unsigned steps = kSteps;
    if constexpr (sizeof(T) == 8)
      steps = value < 1.0 ? static_cast<Unsigned>(value * 0x1p64) : kSteps;
    else
      steps = static_cast<Unsigned>(static_cast<Wide>(value * kSteps + 0.5));
    return static_cast<T>(static_cast<Unsigned>(steps + kLowest));
  }
}

template <class T>
void fill_values(const BuiltinField& field, std::size_t size, T* values) {
  support::parallel_chunks(size, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      T* out = values + k * size * size;
      field.visit_slice(k, [&](std::span<const double> row) {
        for (std::size_t i = 0; i < size; ++i) out[i] = stretch<T>(row[i]);
        out += size;
      });
    }
  });
}

GridShape make_cube(std::uint32_t size, const ValueRange& extent) {
  GridShape shape;
  shape.dimensions.fill(size);
  shape.origin.fill(extent.min);
  shape.spacing.fill((extent.max - extent.min) / (size - 1.0));
  return shape;
}

GridData make_grid(const BuiltinField& field, const BuiltinGridRequest& request) {
  const std::size_t size = request.size, bytes = size * size * size * scalar_type_size(request.type);
  const std::shared_ptr<std::byte[]> values = std::make_unique_for_overwrite<std::byte[]>(bytes);
  visit_type(request.type, [&](auto any) { fill_values(field, size, reinterpret_cast<decltype(any)*>(values.get())); });
  GridData grid;
  grid.shape = make_cube(request.size, field.extent);
  grid.type = request.type;
  grid.values = {values.get(), bytes};
  grid.array_name = field.array_name;
  grid.storage = values;
  return grid;
}

}  // namespace

const std::vector<BuiltinGridEntry>& builtin_grids() {
  static const std::vector<BuiltinGridEntry> entries = [] {
    std::vector<BuiltinGridEntry> all;
    for (const Builtin& builtin : builtins()) all.push_back(builtin.entry);
    return all;
  }();
  return entries;
}

Dataset make_builtin_grid(const BuiltinGridEntry& entry, const BuiltinGridRequest& request, const std::string& source) {
  const auto builtin = std::find_if(builtins().begin(), builtins().end(),
                                    [&](const Builtin& one) { return one.entry.name == entry.name; });
  TETRAVOX_CHECK_LT(std::distance(builtins().begin(), builtin), std::ssize(builtins()));
  const std::size_t size = request.size, count = size * size * size;
  const std::size_t bytes = count * scalar_type_size(request.type) * builtin->make_fields.size();
  // Fields need tables besides: of the slices, and of the coefficients of noise.
  support::require_memory(bytes + count / 8 + (std::uint64_t{32} << 20),
                          source + " with " + std::to_string(size) + "^3 points");
  Dataset dataset;
  DatasetInfo& info = dataset.info;
  info.source = source;
  info.format = "embedded";
  dataset.grid = make_grid(builtin->make_fields.front()(request), request);
  describe_grid(dataset.grid, info);
  for (std::size_t i = 1; i < builtin->make_fields.size(); ++i) {
    dataset.other_grids.push_back(make_grid(builtin->make_fields[i](request), request));
    info.arrays.push_back(describe_values(dataset.other_grids.back()));
  }
  return dataset;
}

}  // namespace tetravox::grid
