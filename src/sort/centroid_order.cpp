#include "src/sort/centroid_order.h"

#include "src/support/threads.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>

namespace tetravox::sort {
namespace {

constexpr std::size_t kChunk = 1 << 16;
constexpr int kDigitBits = 11;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;

using Counts = std::array<std::uint32_t, kDigits>;

std::size_t chunk_count(std::size_t count) { return (count + kChunk - 1) / kChunk; }

/// Calls `body(chunk, begin, end)` for fixed chunks of [0, count), in parallel.
template <class Body>
void for_each_chunk(std::size_t count, const Body& body) {
  support::parallel_chunks(chunk_count(count), 1, [&](std::size_t chunk, std::size_t last) {
    for (; chunk < last; ++chunk) body(chunk, chunk * kChunk, std::min(count, (chunk + 1) * kChunk));
  });
}

/// Bits of a float that order like the float, the largest first.
std::uint32_t descending_bits(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return bits & 0x80000000u ? bits : ~bits & 0x7FFFFFFFu;
}

/// Writes pairs of key and cell; returns the range of the keys.
std::pair<std::uint32_t, std::uint32_t> write_keys(const PreparedMesh& mesh, std::span<const SortedCell> cells,
                                                   const ViewPoint& view, std::vector<std::uint64_t>& pairs) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges(chunk_count(cells.size()), {0xFFFFFFFFu, 0});
  for_each_chunk(cells.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    std::uint32_t least = 0xFFFFFFFFu, greatest = 0;
    for (std::size_t cell = begin; cell < end; ++cell) {
      const auto depth = static_cast<float>(view.depth_key(centroid_of(mesh, cells[cell])));
      const std::uint32_t key = descending_bits(depth);
      pairs[cell] = std::uint64_t{key} << 32 | cell;
      least = std::min(least, key);
      greatest = std::max(greatest, key);
    }
    ranges[chunk] = {least, greatest};
  });
  std::pair<std::uint32_t, std::uint32_t> range{0xFFFFFFFFu, 0};
  for (const auto& [least, greatest] : ranges) range = {std::min(range.first, least), std::max(range.second, greatest)};
  return range;
}

/// One pass: stable by the digit at `shift` of key - least; `write(place, pair)` puts a pair where it belongs.
template <class Write>
void sort_by_digit(const std::vector<std::uint64_t>& pairs, std::uint32_t least, int shift, const Write& write) {
  const auto digit = [=](std::uint64_t pair) {
    return (static_cast<std::uint32_t>(pair >> 32) - least) >> shift & (kDigits - 1);
  };
  std::vector<Counts> counts(chunk_count(pairs.size()));
  for_each_chunk(pairs.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    counts[chunk].fill(0);
    for (std::size_t i = begin; i < end; ++i) ++counts[chunk][digit(pairs[i])];
  });
  std::uint32_t place = 0;
  for (std::size_t d = 0; d < kDigits; ++d)
    for (Counts& chunk : counts) place += std::exchange(chunk[d], place);
  for_each_chunk(pairs.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) write(counts[chunk][digit(pairs[i])]++, pairs[i]);
  });
}

}  // namespace

Vector3 centroid_of(const PreparedMesh& mesh, const SortedCell& cell) {
  if (!cell.is_known()) return {};
  Vector3 sum{};
  for (const std::uint32_t id : cell.ids) sum = sum + position_of(mesh.vertices[id]);
  return sum * 0.25;
}

void sort_by_centroids(const PreparedMesh& mesh, std::span<const SortedCell> cells, const ViewPoint& view,
                       CentroidBuffers& buffers, std::vector<std::uint32_t>& order) {
  buffers.pairs.resize(cells.size());
  buffers.other_pairs.resize(cells.size());
  order.resize(cells.size());
  const auto [least, greatest] = write_keys(mesh, cells, view, buffers.pairs);
  const int bits = std::bit_width(greatest - least);
  int shift = 0;
  for (; shift + kDigitBits < bits; shift += kDigitBits) {
    sort_by_digit(buffers.pairs, least, shift,
                  [&](std::size_t place, std::uint64_t pair) { buffers.other_pairs[place] = pair; });
    buffers.pairs.swap(buffers.other_pairs);
  }
  sort_by_digit(buffers.pairs, least, shift,
                [&](std::size_t place, std::uint64_t pair) { order[place] = static_cast<std::uint32_t>(pair); });
}

}  // namespace tetravox::sort
