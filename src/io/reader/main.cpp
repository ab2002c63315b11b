/// tetravox-reader: reads one file with VTK and hands its mesh over in shared memory. Started by the library, which
/// survives whatever happens in here.

#include "src/io/reader/collect.h"
#include "src/io/reader/status.h"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <span>

#if defined(__SANITIZE_ADDRESS__)
/// In place of the limit of memory: wrong counts must not keep a machine busy with clearing gigabytes.
extern "C" const char* __asan_default_options() { return "max_allocation_size_mb=2048:hard_rss_limit_mb=4096"; }
#elif defined(__SANITIZE_THREAD__)
extern "C" const char* __tsan_default_options() { return "max_allocation_size_mb=2048"; }
#endif

namespace tetravox::io {

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitsMemory = false;  // Sanitizers map terabytes of shadow memory.
#else
constexpr bool kLimitsMemory = true;
#endif

/// Bytes of private memory that this process holds.
std::uint64_t private_memory() {
  std::ifstream in("/proc/self/statm");
  std::uint64_t total = 0, resident = 0, shared = 0;
  in >> total >> resident >> shared;
  return (resident - std::min(shared, resident)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

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

/// Places sections one after the other.
class Layout {
 public:
  Section place(std::uint64_t bytes) {
    const Section section{end_, bytes};
    end_ += (bytes + 63) / 64 * 64;
    return section;
  }
  std::uint64_t total() const { return end_; }

 private:
  std::uint64_t end_ = (sizeof(SharedHeader) + 63) / 64 * 64;
};

SharedHeader make_header(const std::vector<Block>& blocks, const Description& description, std::size_t text_bytes,
                         bool has_mesh) {
  const DatasetInfo& info = description.info;
  const bool is_point = description.association == Association::kPoint;
  std::uint64_t connectivity = 0;
  for (const Block& block : blocks) connectivity += block.connectivity_count;
  Layout layout;
  SharedHeader header;
  header.magic = kSharedMagic;
  header.description = layout.place(text_bytes);
  if (has_mesh) {
    header.points = layout.place(info.point_count * 3 * sizeof(double));
    header.cell_types = layout.place(info.cell_count * sizeof(CellType));
    header.cell_offsets = layout.place((info.cell_count + 1) * sizeof(std::uint64_t));
    header.connectivity = layout.place(connectivity * sizeof(std::uint32_t));
    header.scalars = layout.place((is_point ? info.point_count : info.cell_count) * sizeof(double));
  }
  header.total_bytes = layout.total();
  return header;
}

/// Name of the array that stands in where a file has none; no file's own array can bear it, since then there is one.
constexpr const char* kUniformArray = "(uniform)";

/// The memory file at its full size.
std::byte* map_memory(std::uint64_t bytes, const ReaderRequest& request) {
  const std::uint64_t limit = request.options.memory_limit;
  const bool is_too_much = kLimitsMemory && limit > 0 && bytes + private_memory() > limit;
  if (is_too_much || ftruncate(kDataDescriptor, static_cast<off_t>(bytes)) != 0)
    throw Error(ErrorCode::kOutOfMemory, describe_out_of_memory(request.file, limit));
  void* address = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, kDataDescriptor, 0);
  if (address == MAP_FAILED) throw Error(ErrorCode::kOutOfMemory, describe_out_of_memory(request.file, limit));
  return static_cast<std::byte*>(address);
}

/// Writes the memory file; without `array` only the description.
void hand_over(const std::vector<Block>& blocks, const Description& description, const ArrayInfo* array,
               const ReaderRequest& request) {
  const std::vector<std::byte> text = encode_description(description);
  const SharedHeader header = make_header(blocks, description, text.size(), array != nullptr);
  std::byte* memory = map_memory(header.total_bytes, request);
  std::memcpy(memory, &header, sizeof header);
  std::memcpy(memory + header.description.offset, text.data(), text.size());
  if (!array) return;
  const MeshArrays mesh{reinterpret_cast<double*>(memory + header.points.offset),
                        reinterpret_cast<CellType*>(memory + header.cell_types.offset),
                        reinterpret_cast<std::uint64_t*>(memory + header.cell_offsets.offset),
                        reinterpret_cast<std::uint32_t*>(memory + header.connectivity.offset)};
  for (const Block& block : blocks) write_block(block, mesh);
  double* scalars = reinterpret_cast<double*>(memory + header.scalars.offset);
  if (array->name == kUniformArray)
    std::fill_n(scalars, description.info.cell_count, 1.0);
  else
    write_scalars(blocks, *array, description.component, scalars);
}

/// A mesh without arrays is drawn as a homogeneous body: its shape is still worth seeing. Not so an OpenFOAM case,
/// whose fields are files of their own: VTK passes over damaged ones without a word.
void add_uniform_array(DatasetInfo& info) {
  if (!info.arrays.empty() || info.cell_count == 0 || info.format.starts_with("OpenFOAM")) return;
  ArrayInfo uniform;
  uniform.name = kUniformArray;
  uniform.association = Association::kCell;
  uniform.type = "float64";
  uniform.magnitude_range = {1.0, 1.0};
  uniform.component_ranges = {uniform.magnitude_range};
  info.arrays.push_back(uniform);
  info.notes.push_back("no point or cell arrays: drawn as a homogeneous body");
}

/// The array to draw; throws where there is no cell or no array.
const ArrayInfo& choose_field(const ReaderRequest& request, const FileContents& contents, Description& description) {
  const DatasetInfo& info = description.info;
  if (info.cell_count == 0) {
    if (contents.regular_grids > 0)
      throw Error(ErrorCode::kUnsupported,
                  "'" + request.file + "' holds regular grids only, and regular grids are not drawn yet");
    if (info.left_out.unsupported > 0)
      throw Error(ErrorCode::kUnsupported, "'" + request.file + "': its " + std::to_string(info.left_out.unsupported) +
                                               " volume cells are of types that are not drawn (convex point sets, "
                                               "Lagrange and Bezier cells): convert them to quadratic or linear cells");
    throw Error(ErrorCode::kNothingToDraw, "'" + request.file + "' holds no volume cell to draw (" +
                                               std::to_string(info.left_out.lower_dimension) + " of lower dimension, " +
                                               std::to_string(info.left_out.ghost + info.left_out.blanked) +
                                               " ghost or blanked)");
  }
  const ArrayInfo& array = info.arrays.at(choose_array(info, request.options.array));
  description.array_name = array.name;
  description.association = array.association;
  description.component = array.components == 1 ? 0 : request.options.array.component.value_or(kMagnitude);
  return array;
}

void add_notes(const FileContents& contents, DatasetInfo& info) {
  info.notes = contents.notes;
  if (contents.regular_grids > 0)
    info.notes.push_back(std::to_string(contents.regular_grids) + " blocks are regular grids, which are not drawn yet");
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
  const std::vector<Block> blocks = examine_blocks(contents, request.file, info);
  add_notes(contents, info);
  info.arrays = examine_arrays(blocks, request.file, info.notes);
  add_uniform_array(info);
  send_progress(0.93);
  const ArrayInfo* array = request.options.only_info ? nullptr : &choose_field(request, contents, description);
  hand_over(blocks, description, array, request);
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
