#include "src/io/reader/hand_over.h"

#include "src/io/reader/status.h"

#include <vtkDataArray.h>

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <span>

namespace tetravox::io {

namespace {

/// Bytes of private memory that this process holds.
std::uint64_t private_memory() {
  std::ifstream in("/proc/self/statm");
  std::uint64_t total = 0, resident = 0, shared = 0;
  in >> total >> resident >> shared;
  return (resident - std::min(shared, resident)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
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

/// The memory file at its full size. `given_back`: bytes of private memory that will be free before it is full.
std::byte* map_memory(std::uint64_t bytes, std::uint64_t given_back, const ReaderRequest& request) {
  const std::uint64_t limit = request.options.memory_limit;
  const std::uint64_t held = private_memory();
  const bool is_too_much = kLimitsMemory && limit > 0 && bytes + held - std::min(held, given_back) > limit;
  if (is_too_much || ftruncate(kDataDescriptor, static_cast<off_t>(bytes)) != 0)
    throw Error(ErrorCode::kOutOfMemory, describe_out_of_memory(request.file, limit));
  void* address = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, kDataDescriptor, 0);
  if (address == MAP_FAILED) throw Error(ErrorCode::kOutOfMemory, describe_out_of_memory(request.file, limit));
  return static_cast<std::byte*>(address);
}

/// Maps the memory file and writes its header and description; the sections after them are placed by `place`.
template <class Place>
std::pair<std::byte*, SharedHeader> begin_memory(const Description& description, std::uint64_t given_back,
                                                 const ReaderRequest& request, const Place& place) {
  const std::vector<std::byte> text = encode_description(description);
  Layout layout;
  SharedHeader header;
  header.magic = kSharedMagic;
  header.description = layout.place(text.size());
  place(layout, header);
  header.total_bytes = layout.total();
  std::byte* memory = map_memory(header.total_bytes, given_back, request);
  std::memcpy(memory, &header, sizeof header);
  std::memcpy(memory + header.description.offset, text.data(), text.size());
  return {memory, header};
}

}  // namespace

void hand_over_mesh(const std::vector<Block>& blocks, const Description& description, const ArrayInfo& array,
                    const ReaderRequest& request) {
  const DatasetInfo& info = description.info;
  const bool is_point = description.association == Association::kPoint;
  std::uint64_t connectivity = 0;
  for (const Block& block : blocks) connectivity += block.connectivity_count;
  const auto [memory, header] = begin_memory(description, 0, request, [&](Layout& layout, SharedHeader& h) {
    h.points = layout.place(info.point_count * 3 * sizeof(double));
    h.cell_types = layout.place(info.cell_count * sizeof(CellType));
    h.cell_offsets = layout.place((info.cell_count + 1) * sizeof(std::uint64_t));
    h.connectivity = layout.place(connectivity * sizeof(std::uint32_t));
    h.scalars = layout.place((is_point ? info.point_count : info.cell_count) * sizeof(double));
  });
  const MeshArrays mesh{reinterpret_cast<double*>(memory + header.points.offset),
                        reinterpret_cast<CellType*>(memory + header.cell_types.offset),
                        reinterpret_cast<std::uint64_t*>(memory + header.cell_offsets.offset),
                        reinterpret_cast<std::uint32_t*>(memory + header.connectivity.offset)};
  for (const Block& block : blocks) write_block(block, mesh);
  double* scalars = reinterpret_cast<double*>(memory + header.scalars.offset);
  if (array.name == kUniformArray)
    std::fill_n(scalars, info.cell_count, 1.0);
  else
    write_scalars(blocks, array, description.component, scalars);
}

void hand_over_grid(const Block& block, Description description, const ArrayInfo& array, const ReaderRequest& request) {
  vtkDataArray* values = find_array(block, array);
  const int component = description.component;
  GridValues plan;
  if (values) {
    plan = plan_grid_values(*values, component);
  } else {  // The stand-in.
    plan.type = ScalarType::kUint8;
    plan.bytes = block.cell_count;
  }
  description.type = plan.type;
  description.components = plan.components;
  description.component = plan.component;
  const auto [memory, header] =
      begin_memory(description, plan.is_raw ? plan.bytes : 0, request,
                   [&](Layout& layout, SharedHeader& h) { h.values = layout.place(plan.bytes); });
  std::byte* out = memory + header.values.offset;
  if (values)
    move_grid_values(*values, plan, component, out);
  else
    std::fill_n(out, plan.bytes, std::byte{1});
}

void hand_over_info(const Description& description, const ReaderRequest& request) {
  begin_memory(description, 0, request, [](Layout&, SharedHeader&) {});
}

}  // namespace tetravox::io
