#include "src/io/formats.h"
#include "src/io/raw_file.h"
#include "src/io/reader_process.h"
#include "src/io/time_steps.h"
#include "src/io/validate_grid.h"
#include "src/io/validate_mesh.h"
#include "src/support/memory.h"
#include "tetravox/io.h"

#include <unistd.h>

#include <cstring>
#include <stdexcept>

namespace tetravox {

namespace {

constexpr const char* kBuiltinPrefix = "builtin:";

void require_others(const std::vector<ArrayRequest>& others) {
  if (others.size() > kMostOtherArrays)
    throw Error(ErrorCode::kInvalidArgument, std::to_string(others.size()) + " further arrays are more than the " +
                                                 std::to_string(kMostOtherArrays) + " that can be read at a time");
  for (const ArrayRequest& other : others)
    if (other.name.empty()) throw Error(ErrorCode::kInvalidArgument, "a further array has no name: name it");
}

/// The one array of a RAW file, of which each component is a field.
Dataset choose_raw_fields(Dataset dataset, const ReadOptions& options) {
  const ArrayInfo& array = dataset.info.arrays.at(choose_array(dataset.info, options.array));
  dataset.grid.component = choose_component(array, options.array);
  for (const ArrayRequest& other : options.others) {
    choose_other_array(dataset.info, other, array);
    dataset.other_grids.push_back(dataset.grid);
    dataset.other_grids.back().component = choose_component(array, other);
  }
  return dataset;
}

/// What was made or read here, without what is not asked for.
Dataset finish(Dataset dataset, const ReadOptions& options, const std::string& path) {
  dataset.info.time_index = io::pick_time(dataset.info.times, options.time, path);
  if (options.only_info) {
    dataset.mesh = {};
    dataset.grid = {};
    dataset.other_grids.clear();
  }
  return dataset;
}

void require_drawable(io::Format format, const std::string& path) {
  if (format == io::Format::kHierarchy)
    throw Error(ErrorCode::kUnsupported, "'" + path +
                                             "' holds a hierarchy of refined grids (AMR), which is not drawn: give a "
                                             "mesh of cells or one grid (tetravox list readers)");
  if (format == io::Format::kSurface)
    throw Error(ErrorCode::kNothingToDraw, "'" + path +
                                               "' holds surfaces only, and tetravox draws volumes: give a mesh of "
                                               "volume cells or a grid");
}

/// A section of the memory file as a span.
/// @throws std::out_of_range where it does not fit in.
template <class T>
std::span<const T> view_section(const io::SharedMemory& memory, const io::Section& section) {
  if (section.offset % alignof(T) != 0 || section.bytes % sizeof(T) != 0 || section.offset > memory.bytes.size() ||
      section.bytes > memory.bytes.size() - section.offset)
    throw std::out_of_range("a section lies outside the memory file");
  return {reinterpret_cast<const T*>(memory.bytes.data() + section.offset), section.bytes / sizeof(T)};
}

MeshData view_mesh(const io::SharedMemory& memory, const io::SharedHeader& header, io::Description& description) {
  MeshData mesh;
  mesh.points = view_section<double>(memory, header.points);
  mesh.cell_types = view_section<CellType>(memory, header.cell_types);
  mesh.cell_offsets = view_section<std::uint64_t>(memory, header.cell_offsets);
  mesh.connectivity = view_section<std::uint32_t>(memory, header.connectivity);
  mesh.scalars = view_section<double>(memory, header.scalars);
  mesh.association = description.association;
  mesh.array_name = std::move(description.field.array_name);
  mesh.component = description.field.component;
  for (std::size_t i = 0; i < description.others.size(); ++i) {
    io::FieldDescription& other = description.others[i];
    mesh.others.push_back(
        {view_section<double>(memory, header.others.at(i)), std::move(other.array_name), other.component});
  }
  mesh.storage = memory.storage;
  return mesh;
}

GridData view_grid(const io::SharedMemory& memory, const io::Section& values, const io::Description& description,
                   const io::FieldDescription& field) {
  GridData grid;
  grid.shape = *description.info.grid;
  grid.association = description.association;
  grid.type = field.type;
  grid.components = field.components;
  grid.component = field.component;
  grid.values = view_section<std::byte>(memory, values);
  grid.array_name = field.array_name;
  grid.storage = memory.storage;
  return grid;
}

Dataset view_dataset(const io::SharedMemory& memory, bool only_info) {
  io::SharedHeader header;
  std::memcpy(&header, memory.bytes.data(), sizeof header);
  io::Description description = io::decode_description(view_section<std::byte>(memory, header.description));
  Dataset dataset;
  if (!only_info && description.info.grid) {
    dataset.grid = view_grid(memory, header.values, description, description.field);
    for (std::size_t i = 0; i < description.others.size(); ++i)
      dataset.other_grids.push_back(view_grid(memory, header.others.at(i), description, description.others[i]));
  } else if (!only_info) {
    dataset.mesh = view_mesh(memory, header, description);
  }
  dataset.info = std::move(description.info);
  return dataset;
}

void validate(const Dataset& dataset, bool only_info, const std::string& path) {
  if (dataset.is_grid()) io::validate_grid_shape(*dataset.info.grid, path);
  if (only_info) return;
  if (dataset.is_grid())
    io::validate_grid(dataset.grid, path);
  else
    io::validate_mesh(dataset.mesh, path);
  for (const GridData& other : dataset.other_grids) io::validate_grid(other, path);
}

}  // namespace

Dataset read_dataset(const std::string& path, const ReadOptions& options, const Progress& progress) {
  if (path.empty()) throw Error(ErrorCode::kInvalidArgument, "no file was named");
  require_others(options.others);
  const bool is_builtin = path.starts_with(kBuiltinPrefix);
  if (!is_builtin && options.grid_file.empty() && io::is_raw_file(path, options.raw))
    return finish(choose_raw_fields(io::read_raw_file(path, options.raw, progress), options), options, path);
  io::require_no_layout(options.raw, path);
  if (is_builtin) return finish(make_builtin(path, options.array, options.others), options, path);
  // Find out early what needs no reader process: a missing file, a wrong kind of file.
  require_drawable(io::detect_format(path, !options.grid_file.empty()), path);
  io::ReaderRequest request{path, options, getpid()};
  if (request.options.memory_limit == 0) request.options.memory_limit = support::available_memory();
  const io::SharedMemory memory = io::run_reader(request, progress);
  Dataset dataset;
  try {
    dataset = view_dataset(memory, options.only_info);
  } catch (const std::out_of_range& error) {
    throw Error(ErrorCode::kReaderFailed, "the reader of '" + path + "' left data that make no sense (" + error.what() +
                                              "): the file is damaged, or please report this");
  }
  validate(dataset, options.only_info, path);
  if (progress.report) progress.report("read", 1.0);
  return dataset;
}

}  // namespace tetravox
