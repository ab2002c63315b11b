#pragma once

/// Small XML files that only list other files: ParaView's PVD, VTK's multi-block (VTM) and parallel (PVTU, PVTS, PVTI,
/// PVTR) files. Hostile text is met with an `Error`, never with more than linear work.

#include "tetravox/scene.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetravox::io {

/// The most files that one collection may name.
inline constexpr std::size_t kMostCollectionFiles = 100'000;
/// The largest collection file that is read, bytes.
inline constexpr std::size_t kLargestCollection = std::size_t{64} << 20;

/// One entry of a PVD file.
struct PvdEntry {
  double time = 0.0;
  std::string part;
  std::string file;  ///< as written; relative to the PVD file
};

struct PvdCollection {
  std::vector<PvdEntry> entries;  ///< in file order
  std::vector<double> times;      ///< distinct time steps, ascending
};

/// Parses a PVD file's text.
/// @throws Error (kBadFile) that names `source_name` and the entry.
PvdCollection parse_pvd(const std::string& text, const std::string& source_name);

/// Files of the step `time_index` of `collection.times`, in file order.
std::vector<std::string> files_of_step(const PvdCollection& collection, std::size_t time_index);

/// What a VTM, PVTU, PVTS, PVTI or PVTR file lists.
struct FileList {
  std::vector<std::string> files;  ///< as written; relative to the list's own file
  bool has_ghost_levels = false;   ///< a parallel file that says its pieces overlap
  std::string whole_extent;        ///< of a parallel grid, as written; empty for others
};

/// Parses the text of a VTM, PVTU, PVTS, PVTI or PVTR file.
/// @throws Error (kBadFile) that names `source_name` and the entry.
FileList parse_file_list(const std::string& text, const std::string& source_name);

/// Cells of an extent, "i0 i1 j0 j1 k0 k1"; an axis of a single point counts as one cell. `points`, if given, receives
/// the points along each axis, and `ends` the six numbers.
/// @throws Error (kBadFile) that names `source_name`.
std::uint64_t count_extent_cells(const std::string& extent, const std::string& source_name,
                                 std::array<std::uint64_t, 3>* points = nullptr,
                                 std::array<std::int32_t, 6>* ends = nullptr);

/// The whole file as text.
/// @throws Error: kFileNotFound, or kBadFile where it exceeds kLargestCollection.
std::string read_collection_text(const std::string& path);

/// `file` as seen from the directory of `collection_path`, unless it is absolute.
std::string resolve_path(const std::string& collection_path, const std::string& file);

}  // namespace tetravox::io
