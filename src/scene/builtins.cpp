/// Embedded datasets by name: the meshes of src/mesh, the grids of src/grid.

#include "src/grid/builtin.h"
#include "src/mesh/builtin.h"
#include "tetravox/dataset.h"
#include "tetravox/error.h"

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

namespace tetravox {
namespace {

constexpr std::string_view kPrefix = "builtin:";

/// "NAME?key=value&key=value" in its parts, which view the text.
struct BuiltinName {
  std::string source;  ///< with the prefix, for messages and summaries
  std::string_view name;
  struct Option {
    std::string_view text, key, value;
  };
  std::vector<Option> options;
};

BuiltinName parse_name(std::string_view text) {
  BuiltinName parsed;
  if (text.starts_with(kPrefix)) text.remove_prefix(kPrefix.size());
  parsed.source = std::string(kPrefix) + std::string(text);
  const std::size_t question = text.find('?');
  parsed.name = text.substr(0, question);
  while (question != std::string_view::npos) {
    text.remove_prefix(parsed.options.empty() ? question + 1 : 0);
    const std::string_view option = text.substr(0, text.find('&'));
    const std::size_t equals = option.find('=');
    parsed.options.push_back({option, equals == std::string_view::npos ? std::string_view{} : option.substr(0, equals),
                              equals == std::string_view::npos ? std::string_view{} : option.substr(equals + 1)});
    if (option.size() == text.size()) break;
    text.remove_prefix(option.size() + 1);
  }
  return parsed;
}

[[noreturn]] void fail(const BuiltinName& wanted, const std::string& what) {
  throw Error(ErrorCode::kInvalidArgument, wanted.source + ": " + what);
}

[[noreturn]] void fail_option(const BuiltinName& wanted, const BuiltinName::Option& option, const std::string& known) {
  fail(wanted, "'" + std::string(option.text) + "' is not an option; there is: " + known);
}

std::uint64_t parse_number(const BuiltinName& wanted, const BuiltinName::Option& option, std::uint64_t least,
                           std::uint64_t most) {
  std::uint64_t number = 0;
  const char* last = option.value.data() + option.value.size();
  const auto [end, error] = std::from_chars(option.value.data(), last, number);
  if (error != std::errc() || end != last || number < least || number > most)
    fail(wanted,
         std::string(option.text) + " is not a number from " + std::to_string(least) + " to " + std::to_string(most));
  return number;
}

ScalarType parse_type(const BuiltinName& wanted, const BuiltinName::Option& option) {
  try {
    return scalar_type_from_name(std::string(option.value));
  } catch (const Error& error) {
    fail(wanted, error.what());
  }
}

/// The arrays that are asked for.
struct WantedArrays {
  const ArrayRequest& array;
  const std::vector<ArrayRequest>& others;
};

Dataset make_mesh(const BuiltinName& wanted, const mesh::BuiltinMeshEntry& entry, const WantedArrays& arrays) {
  mesh::BuiltinMeshRequest request{entry.default_cells, arrays.array, arrays.others};
  for (const BuiltinName::Option& option : wanted.options) {
    if (option.key != "cells") fail_option(wanted, option, "cells=N");
    request.cells = parse_number(wanted, option, mesh::kFewestCells, mesh::kMostCells);
  }
  return mesh::make_builtin_mesh(entry, request, wanted.source);
}

/// Of all fields of a grid, those that are asked for.
Dataset pick_fields(Dataset dataset, const WantedArrays& arrays) {
  std::vector<GridData> fields{dataset.grid};
  fields.insert(fields.end(), dataset.other_grids.begin(), dataset.other_grids.end());
  const std::size_t chosen = choose_array(dataset.info, arrays.array);
  dataset.grid = fields[chosen];
  dataset.other_grids.clear();
  for (const ArrayRequest& other : arrays.others)
    dataset.other_grids.push_back(fields[choose_other_array(dataset.info, other, dataset.info.arrays[chosen])]);
  return dataset;
}

Dataset make_grid(const BuiltinName& wanted, const grid::BuiltinGridEntry& entry, const WantedArrays& arrays) {
  grid::BuiltinGridRequest grid{entry.default_size, entry.default_type, 0};
  for (const BuiltinName::Option& option : wanted.options) {
    if (option.key == "size")
      grid.size = static_cast<std::uint32_t>(parse_number(wanted, option, grid::kFewestPoints, grid::kMostPoints));
    else if (option.key == "type")
      grid.type = parse_type(wanted, option);
    else if (option.key == "seed" && entry.has_seed)
      grid.seed = parse_number(wanted, option, 0, std::numeric_limits<std::uint64_t>::max());
    else
      fail_option(wanted, option, entry.has_seed ? "size=N, type=T, seed=N" : "size=N, type=T");
  }
  return pick_fields(grid::make_builtin_grid(entry, grid, wanted.source), arrays);
}

}  // namespace

Dataset make_builtin(const std::string& name, const ArrayRequest& request, const std::vector<ArrayRequest>& others) {
  const BuiltinName wanted = parse_name(name);
  std::string names;
  for (const mesh::BuiltinMeshEntry& entry : mesh::builtin_meshes()) {
    if (wanted.name == entry.name) return make_mesh(wanted, entry, {request, others});
    names += (names.empty() ? "" : ", ") + entry.name;
  }
  for (const grid::BuiltinGridEntry& entry : grid::builtin_grids()) {
    if (wanted.name == entry.name) return make_grid(wanted, entry, {request, others});
    names += ", " + entry.name;
  }
  throw Error(ErrorCode::kInvalidArgument,
              "there is no embedded dataset '" + std::string(wanted.name) + "'; there are: " + names);
}

Dataset make_builtin(const std::string& name) { return make_builtin(name, {}); }

std::vector<std::pair<std::string, std::string>> builtin_names() {
  std::vector<std::pair<std::string, std::string>> names;
  for (const mesh::BuiltinMeshEntry& entry : mesh::builtin_meshes())
    names.emplace_back(entry.name,
                       entry.description + " (" + std::to_string(entry.default_cells) + " cells; ?cells=N)");
  for (const grid::BuiltinGridEntry& entry : grid::builtin_grids())
    names.emplace_back(entry.name, entry.description + " (" + std::to_string(entry.default_size) + "^3 points, " +
                                       scalar_type_name(entry.default_type) + "; ?size=N&type=T" +
                                       (entry.has_seed ? "&seed=N)" : ")"));
  return names;
}

}  // namespace tetravox
