/// tetravox-reader: reads one file with VTK and hands its mesh or grid over in shared memory. Started by the library,
/// which survives whatever happens in here.

#include "src/io/reader/collect.h"
#include "src/io/reader/hand_over.h"
#include "src/io/reader/status.h"

#include <vtkImageData.h>
#include <vtkRectilinearGrid.h>

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <span>

#if defined(__SANITIZE_ADDRESS__)
/// In place of the limit of memory: wrong counts must not keep a machine busy with clearing gigabytes.
extern "C" const char* __asan_default_options() { return "max_allocation_size_mb=2048:hard_rss_limit_mb=4096"; }
#elif defined(__SANITIZE_THREAD__)
extern "C" const char* __tsan_default_options() { return "max_allocation_size_mb=2048"; }
#endif

namespace tetravox::io {

namespace {

/// Ends this process with its parent, without a core dump, and keeps it within its memory.
void limit_process(const ReaderRequest& request) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (request.parent != 0 && getppid() != request.parent) _exit(1);  // It died before the line above.
  std::signal(SIGINT, SIG_IGN);                                      // The parent decides; it kills this process.
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  prctl(PR_SET_DUMPABLE, 0);
  if (kLimitsMemory && request.options.memory_limit > 0) {
    rlimit data{};
    getrlimit(RLIMIT_DATA, &data);
    data.rlim_cur = std::min<rlim_t>(data.rlim_max, request.options.memory_limit);
    setrlimit(RLIMIT_DATA, &data);
  }
}

/// A dataset without arrays is drawn as a homogeneous body: its shape is still worth seeing. Not so an OpenFOAM case,
/// whose fields are files of their own: VTK passes over damaged ones without a word.
void add_uniform_array(DatasetInfo& info) {
  if (!info.arrays.empty() || info.cell_count == 0 || info.format.starts_with("OpenFOAM")) return;
  ArrayInfo uniform;
  uniform.name = kUniformArray;
  uniform.association = Association::kCell;
  uniform.type = info.grid ? "uint8" : "float64";
  uniform.magnitude_range = {1.0, 1.0};
  uniform.component_ranges = {uniform.magnitude_range};
  info.arrays.push_back(uniform);
  info.notes.emplace_back("no point or cell arrays: drawn as a homogeneous body");
}

bool is_single_slice(const FileContents& contents) {
  return contents.blocks.size() == 1 && (vtkImageData::SafeDownCast(contents.blocks.front()) ||
                                         vtkRectilinearGrid::SafeDownCast(contents.blocks.front()));
}

/// Throws where there is no cell.
void require_cells(const std::string& file, const FileContents& contents, const DatasetInfo& info) {
  if (info.cell_count > 0) return;
  if (is_single_slice(contents))
    throw Error(ErrorCode::kNothingToDraw,
                "'" + file +
                    "' holds a single slice, which has no volume: a grid needs two points or more along each axis; "
                    "of a series of slices, name the directory");
  if (info.left_out.unsupported > 0)
    throw Error(ErrorCode::kUnsupported, "'" + file + "': its " + std::to_string(info.left_out.unsupported) +
                                             " volume cells are of types that are not drawn (convex point sets, "
                                             "Lagrange and Bezier cells): convert them to quadratic or linear cells");
  throw Error(ErrorCode::kNothingToDraw, "'" + file + "' holds no volume cell to draw (" +
                                             std::to_string(info.left_out.lower_dimension) + " of lower dimension, " +
                                             std::to_string(info.left_out.ghost + info.left_out.blanked) +
                                             " ghost or blanked)");
}

/// The array to draw, and those that are wanted beside it; throws where one is missing.
FieldArrays choose_fields(const ReadOptions& options, Description& description) {
  const DatasetInfo& info = description.info;
  const ArrayInfo& first = info.arrays.at(choose_array(info, options.array));
  description.association = first.association;
  description.field = {first.name, choose_component(first, options.array)};
  FieldArrays arrays{&first};
  for (const ArrayRequest& other : options.others) {
    const ArrayInfo& array = info.arrays.at(choose_other_array(info, other, first));
    description.others.push_back({array.name, choose_component(array, other)});
    arrays.push_back(&array);
  }
  return arrays;
}

void add_notes(const FileContents& contents, DatasetInfo& info) {
  info.notes.insert(info.notes.end(), contents.notes.begin(), contents.notes.end());
  if (info.left_out.unsupported > 0)
    info.notes.push_back(std::to_string(info.left_out.unsupported) +
                         " volume cells are of types that are not drawn (convex point sets, Lagrange, Bezier)");
  if (contents.times.size() > 1)
    info.notes.push_back("step " + std::to_string(contents.time_index) + " of " +
                         std::to_string(contents.times.size()) + " time steps");
  if (const std::string warning = first_vtk_warning(); !warning.empty()) info.notes.push_back("VTK warns: " + warning);
}

void run(const ReaderRequest& request) {
  const FileContents contents = read_file(request.file, request.options.grid_file, request.options.time);
  throw_if_vtk_failed(request.file);
  Description description;
  DatasetInfo& info = description.info;
  info.source = request.file;
  info.format = contents.format;
  info.times = contents.times;
  info.time_index = contents.time_index;
  const std::optional<GridBlock> grid = find_grid(contents, info.notes);
  std::vector<Block> blocks;
  if (grid) {
    examine_grid(*grid, request.file, info);
    if (info.grid) blocks.push_back(grid->block);
  } else {
    blocks = examine_blocks(contents, request.file, info);
  }
  add_notes(contents, info);
  info.arrays = examine_arrays(blocks, request.file, info.notes);
  add_uniform_array(info);
  send_progress(0.93);
  if (request.options.only_info) return hand_over_info(description, request);
  require_cells(request.file, contents, info);
  const FieldArrays arrays = choose_fields(request.options, description);
  if (info.grid)
    hand_over_grid(blocks.front(), description, arrays, request);
  else
    hand_over_mesh(blocks, description, arrays, request);
}

}  // namespace

}  // namespace tetravox::io

int main(int argc, char** argv) {
  using namespace tetravox;
  try {
    const io::ReaderRequest request =
        io::parse_request(std::span<const char* const>(argv + 1, static_cast<std::size_t>(std::max(argc - 1, 0))));
    io::limit_process(request);
    io::install_error_handlers(request.file, request.options.memory_limit);
    io::run(request);
    io::send_done();
    _exit(0);  // Nothing is worth the time of taking it apart.
  } catch (const std::bad_alloc&) {
    std::terminate();
  } catch (const Error& error) {
    if (argc < 2) std::fprintf(stderr, "%s\n", error.what());
    io::send_error(error.code(), error.what());
  } catch (const std::exception& error) {
    io::send_exception(error);
  }
  _exit(1);
}
