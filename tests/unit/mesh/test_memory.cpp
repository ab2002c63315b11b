/// Memory of preparing, counted allocation by allocation.

#include "src/support/threads.h"
#include "tests/unit/mesh/test_mesh.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <string>

namespace {

std::atomic<std::size_t> live_bytes{0}, peak_bytes{0};

void* allocate(std::size_t size, std::size_t alignment) {
  void* memory = alignment > alignof(std::max_align_t)
                     ? std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment)
                     : std::malloc(size);
  if (!memory) throw std::bad_alloc();
  const std::size_t now = live_bytes.fetch_add(malloc_usable_size(memory)) + malloc_usable_size(memory);
  std::size_t peak = peak_bytes;
  while (now > peak && !peak_bytes.compare_exchange_weak(peak, now)) {
  }
  return memory;
}

void release(void* memory) noexcept {
  if (!memory) return;
  live_bytes -= malloc_usable_size(memory);
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) { return allocate(size, 0); }
void* operator new[](std::size_t size) { return allocate(size, 0); }
void* operator new(std::size_t size, std::align_val_t alignment) { return allocate(size, std::size_t(alignment)); }
void* operator new[](std::size_t size, std::align_val_t alignment) { return allocate(size, std::size_t(alignment)); }
void operator delete(void* memory) noexcept { release(memory); }
void operator delete[](void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }

namespace tetravox::test {
namespace {

struct Measured {
  double input = 0, peak = 0, resident = 0;  ///< bytes a tetrahedron; peak and resident without the input
  double boundary = 0, vertices = 0;         ///< number a tetrahedron
};

Measured measure(const MeshData& mesh) {
  const MemoryEstimate estimate = estimate_prepare_memory(mesh);
  const std::size_t before = live_bytes;
  peak_bytes = before;
  const PreparedMesh prepared = prepare_mesh(mesh);
  const std::size_t peak = peak_bytes - before, resident = live_bytes - before;
  EXPECT_LE(peak, estimate.peak);
  EXPECT_LE(prepared.vertices.size() * sizeof(Vertex) + prepared.cells.size() * sizeof(TetrahedronLinks) +
                prepared.boundary.size() * sizeof(BoundaryFace) + prepared.cell_scalars.size() * sizeof(float),
            estimate.resident);
  EXPECT_EQ(prepared.cells.capacity(), prepared.cells.size());
  EXPECT_EQ(prepared.vertices.capacity(), prepared.vertices.size());
  EXPECT_EQ(prepared.boundary.capacity(), prepared.boundary.size());
  const double n = static_cast<double>(prepared.cells.size());
  const std::size_t input = mesh.points.size_bytes() + mesh.cell_types.size_bytes() + mesh.cell_offsets.size_bytes() +
                            mesh.connectivity.size_bytes() + mesh.scalars.size_bytes();
  return {static_cast<double>(input) / n, static_cast<double>(peak) / n, static_cast<double>(resident) / n,
          static_cast<double>(prepared.boundary.size()) / n, static_cast<double>(prepared.vertices.size()) / n};
}

TEST(Memory, BudgetsOfTetrahedra) {
  const Dataset dataset = make_embedded("buckyball", 1000000);
  const Measured measured = measure(dataset.mesh);
  RecordProperty("peak_bytes_per_tetrahedron", std::to_string(measured.peak + measured.input));
  EXPECT_LE(measured.peak + measured.input, 120.0);
  EXPECT_LE(measured.resident, 20.0 + 16.0 * measured.vertices + 16.0 * measured.boundary + 0.1);
}

TEST(Memory, BudgetsOfHexahedraAndCellData) {
  for (const char* array : {"pressure", "volume"}) {
    const Dataset dataset = make_embedded("duct", 150000, array);
    const Measured measured = measure(dataset.mesh);
    EXPECT_LE(measured.peak + measured.input, 120.0);
    EXPECT_LE(measured.resident, 24.0 + 16.0 * measured.vertices + 16.0 * measured.boundary + 0.1);
  }
}

TEST(Memory, EstimateHoldsForEveryKindOfMesh) {
  // Cells that share no point.
  TestMesh soup;
  for (int i = 0; i < 100000; ++i) add_tetrahedron(soup, 2.0 * i);
  measure(soup.view());
  // Cells that share points and hardly a face, as every other cell has no value.
  Dataset dataset = make_embedded("buckyball", 600000);
  std::vector<double> values(dataset.mesh.cell_count());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = i % 2 == 0 ? 1.0 : std::nan("");
  dataset.mesh.association = Association::kCell;
  dataset.mesh.scalars = values;
  measure(dataset.mesh);
  // Points that nothing uses.
  TestMesh sparse;
  sparse.points.assign(3 << 20, 1.0);
  sparse.scalars.assign(1 << 20, 1.0);
  add_tetrahedron(sparse);
  measure(sparse.view());
}

}  // namespace
}  // namespace tetravox::test
