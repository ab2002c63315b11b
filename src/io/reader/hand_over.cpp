#include "src/io/reader/hand_over.h"

#include "src/io/reader/status.h"

#include <vtkDataArray.h>

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <optional>
#include <span>
#include <utility>

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

/// A field of a grid on its way into the memory file.
struct GridField {
  vtkDataArray* values = nullptr;  ///< null: the stand-in
  GridValues plan;
  int component = 0;                ///< of the array in the file
  std::optional<std::size_t> twin;  ///< an earlier field whose values are the same
  Section section;
};

/// Plans the values of a field, and says in its description what they are.
GridField plan_field(const Block& block, const ArrayInfo& array, FieldDescription& description) {
  GridField field;
  field.values = find_array(block, array);
  field.component = description.component;
  if (field.values) {
    field.plan = plan_grid_values(*field.values, description.component);
  } else {  // The stand-in.
    field.plan.type = ScalarType::kUint8;
    field.plan.bytes = block.cell_count;
  }
  description.type = field.plan.type;
  description.components = field.plan.components;
  description.component = field.plan.component;
  return field;
}

/// The first field before the one at `index` that has the same array handed over as it stands.
std::optional<std::size_t> find_twin(const std::vector<GridField>& fields, std::size_t index) {
  for (std::size_t i = 0; i < index && fields[index].plan.is_raw; ++i)
    if (fields[i].values == fields[index].values) return i;
  return std::nullopt;
}

}  // namespace

void hand_over_mesh(const std::vector<Block>& blocks, const Description& description, const FieldArrays& arrays,
                    const ReaderRequest& request) {
  const DatasetInfo& info = description.info;
  const bool is_point = description.association == Association::kPoint;
  std::uint64_t connectivity = 0;
  for (const Block& block : blocks) connectivity += block.connectivity_count;
  const std::uint64_t scalar_bytes = (is_point ? info.point_count : info.cell_count) * sizeof(double);
  const auto [memory, header] = begin_memory(description, 0, request, [&](Layout& layout, SharedHeader& h) {
    h.points = layout.place(info.point_count * 3 * sizeof(double));
    h.cell_types = layout.place(info.cell_count * sizeof(CellType));
    h.cell_offsets = layout.place((info.cell_count + 1) * sizeof(std::uint64_t));
    h.connectivity = layout.place(connectivity * sizeof(std::uint32_t));
    h.scalars = layout.place(scalar_bytes);
    for (std::size_t i = 0; i < description.others.size(); ++i) h.others.at(i) = layout.place(scalar_bytes);
  });
  const MeshArrays mesh{reinterpret_cast<double*>(memory + header.points.offset),
                        reinterpret_cast<CellType*>(memory + header.cell_types.offset),
                        reinterpret_cast<std::uint64_t*>(memory + header.cell_offsets.offset),
                        reinterpret_cast<std::uint32_t*>(memory + header.connectivity.offset)};
  for (const Block& block : blocks) write_block(block, mesh);
  const auto write_field = [&](const ArrayInfo& array, int component, const Section& section) {
    double* scalars = reinterpret_cast<double*>(memory + section.offset);
    if (array.name == kUniformArray)
      std::fill_n(scalars, info.cell_count, 1.0);
    else
      write_scalars(blocks, array, component, scalars);
  };
  write_field(*arrays.front(), description.field.component, header.scalars);
  for (std::size_t i = 0; i < description.others.size(); ++i)
    write_field(*arrays.at(i + 1), description.others[i].component, header.others[i]);
}

void hand_over_grid(const Block& block, Description description, const FieldArrays& arrays,
                    const ReaderRequest& request) {
  std::vector<GridField> fields{plan_field(block, *arrays.front(), description.field)};
  for (std::size_t i = 0; i < description.others.size(); ++i)
    fields.push_back(plan_field(block, *arrays.at(i + 1), description.others[i]));
  for (std::size_t i = 0; i < fields.size(); ++i) fields[i].twin = find_twin(fields, i);
  std::uint64_t given_back = 0;
  for (const GridField& field : fields) given_back += field.plan.is_raw && !field.twin ? field.plan.bytes : 0;
  const auto [memory, header] = begin_memory(description, given_back, request, [&](Layout& layout, SharedHeader& h) {
    for (std::size_t i = 0; i < fields.size(); ++i) {
      Section& section = i == 0 ? h.values : h.others.at(i - 1);
      fields[i].section = fields[i].twin ? fields[*fields[i].twin].section : layout.place(fields[i].plan.bytes);
      section = fields[i].section;
    }
  });
  for (const GridField& field : fields) {
    std::byte* out = memory + field.section.offset;
    if (field.twin) continue;
    if (field.values)
      move_grid_values(*field.values, field.plan, field.component, out);
    else
      std::fill_n(out, field.plan.bytes, std::byte{1});
  }
}

void hand_over_info(const Description& description, const ReaderRequest& request) {
  begin_memory(description, 0, request, [](Layout&, SharedHeader&) {});
}

}  // namespace tetravox::io
