#include "src/io/collections.h"

#include "tetravox/error.h"

#include <pugixml.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace tetravox::io {

namespace {

/// Blocks may nest this deep in a multi-block file.
constexpr int kDeepestBlock = 64;

[[noreturn]] void fail(const std::string& source_name, const std::string& what) {
  throw Error(ErrorCode::kBadFile, "'" + source_name + "': " + what);
}

/// Parses XML whose root is VTKFile of the given type, or of any with an empty one.
/// Appended binary data is not XML; it is left out first.
pugi::xml_document parse_vtk_file(const std::string& text, const std::string& source_name) {
  pugi::xml_document document;
  const std::size_t appended = text.find("<AppendedData");
  const std::string markup = appended == std::string::npos ? text : text.substr(0, appended) + "</VTKFile>";
  const pugi::xml_parse_result result = document.load_buffer(markup.data(), markup.size());
  if (!result)
    fail(source_name, std::string("not well-formed XML: ") + result.description() + " at byte " +
                          std::to_string(result.offset) + "; the file may be truncated");
  if (!document.child("VTKFile")) fail(source_name, "no VTKFile element: not a file of VTK or ParaView");
  return document;
}

/// A time as ParaView writes it; blanks around it are allowed. A missing one is 0, as in ParaView.
double parse_time(const pugi::xml_attribute& attribute, const std::string& source_name, std::size_t index) {
  std::string_view text = attribute.value();
  while (!text.empty() && std::strchr(" \t\r\n", text.front())) text.remove_prefix(1);
  while (!text.empty() && std::strchr(" \t\r\n", text.back())) text.remove_suffix(1);
  if (text.empty()) return 0.0;
  if (text.front() == '+') text.remove_prefix(1);
  double time = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), time);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(time))
    fail(source_name, "DataSet " + std::to_string(index) + ": timestep is not a number");
  return time;
}

/// Checks a file name that a list gives.
void check_entry(const std::string& file, const std::string& source_name, std::size_t index) {
  if (index >= kMostCollectionFiles)
    fail(source_name, "more than " + std::to_string(kMostCollectionFiles) + " files are listed");
  if (file.empty()) fail(source_name, "entry " + std::to_string(index) + " names no file");
}

void collect_block_files(const pugi::xml_node& node, int depth, const std::string& source_name, FileList& list) {
  if (depth > kDeepestBlock) fail(source_name, "blocks nest deeper than " + std::to_string(kDeepestBlock));
  for (const pugi::xml_node& child : node.children()) {
    const std::string_view name = child.name();
    if (name == "Block" || name == "Piece") collect_block_files(child, depth + 1, source_name, list);
    if (name != "DataSet" && name != "Piece") continue;
    const pugi::xml_attribute file = child.attribute("file");
    if (!file) continue;  // An empty block.
    check_entry(file.value(), source_name, list.files.size());
    list.files.emplace_back(file.value());
  }
}

/// Pieces of a structured grid must fill its extent, no more and no less.
void check_extents(const pugi::xml_node& grid, const std::string& source_name) {
  std::uint64_t cells = 0;
  for (const pugi::xml_node& piece : grid.children("Piece"))
    cells += count_extent_cells(piece.attribute("Extent").value(), source_name);
  const std::uint64_t whole = count_extent_cells(grid.attribute("WholeExtent").value(), source_name);
  if (cells != whole)
    fail(source_name, "its pieces have " + std::to_string(cells) + " cells, and its whole extent " +
                          std::to_string(whole) + ": they overlap or leave gaps");
}

}  // namespace

PvdCollection parse_pvd(const std::string& text, const std::string& source_name) {
  const pugi::xml_document document = parse_vtk_file(text, source_name);
  const pugi::xml_node collection = document.child("VTKFile").child("Collection");
  if (!collection) fail(source_name, "no Collection element: not a PVD file");
  PvdCollection out;
  for (const pugi::xml_node& node : collection.children("DataSet")) {
    const std::size_t index = out.entries.size();
    PvdEntry entry;
    entry.file = node.attribute("file").value();
    entry.part = node.attribute("part").value();
    check_entry(entry.file, source_name, index);
    entry.time = parse_time(node.attribute("timestep"), source_name, index);
    out.times.push_back(entry.time);
    out.entries.push_back(std::move(entry));
  }
  if (out.entries.empty()) fail(source_name, "the collection lists no file");
  std::sort(out.times.begin(), out.times.end());
  out.times.erase(std::unique(out.times.begin(), out.times.end()), out.times.end());
  return out;
}

std::vector<std::string> files_of_step(const PvdCollection& collection, std::size_t time_index) {
  std::vector<std::string> files;
  for (const PvdEntry& entry : collection.entries)
    if (entry.time == collection.times.at(time_index)) files.push_back(entry.file);
  return files;
}

FileList parse_file_list(const std::string& text, const std::string& source_name) {
  const pugi::xml_document document = parse_vtk_file(text, source_name);
  const pugi::xml_node root = document.child("VTKFile");
  FileList list;
  if (const pugi::xml_node blocks = root.child("vtkMultiBlockDataSet")) {
    collect_block_files(blocks, 0, source_name, list);
    if (list.files.empty()) fail(source_name, "no block names a file");
    return list;
  }
  const std::string type = root.attribute("type").value();
  const pugi::xml_node grid = root.child(type.c_str());
  if (!grid) fail(source_name, "no element '" + type + "' as its type says");
  list.whole_extent = grid.attribute("WholeExtent").value();
  list.has_ghost_levels = grid.attribute("GhostLevel").as_int(0) > 0;
  if (grid.attribute("WholeExtent") && !list.has_ghost_levels) check_extents(grid, source_name);
  for (const pugi::xml_node& piece : grid.children("Piece")) {
    const std::string file = piece.attribute("Source").value();
    check_entry(file, source_name, list.files.size());
    list.files.push_back(file);
  }
  if (list.files.empty()) fail(source_name, "no piece is listed");
  return list;
}

std::uint64_t count_extent_cells(const std::string& extent, const std::string& source_name,
                                 std::array<std::uint64_t, 3>* points, std::array<std::int32_t, 6>* all_ends) {
  const char* at = extent.data();
  const char* end = at + extent.size();
  std::uint64_t cells = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::array<std::int32_t, 2> ends{};
    for (std::int32_t& value : ends) {
      while (at != end && std::strchr(" \t\r\n", *at)) ++at;
      const auto [next, error] = std::from_chars(at, end, value);
      if (error != std::errc()) fail(source_name, "an extent is not six whole numbers");
      at = next;
    }
    const std::int64_t length = std::int64_t{ends[1]} - ends[0];
    if (length < 0 || length > (1 << 20)) fail(source_name, "an extent makes no sense");
    cells *= static_cast<std::uint64_t>(std::max<std::int64_t>(length, 1));
    if (points) (*points)[axis] = static_cast<std::uint64_t>(length) + 1;
    if (all_ends) std::copy(ends.begin(), ends.end(), all_ends->begin() + 2 * static_cast<std::ptrdiff_t>(axis));
  }
  return cells;
}

std::string read_collection_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) throw Error(ErrorCode::kFileNotFound, "cannot open '" + path + "': check that it exists and may be read");
  const auto size = static_cast<std::size_t>(in.tellg());
  if (size > kLargestCollection) fail(path, "too large for a file that lists others (over 64 MiB)");
  std::string text(size, '\0');
  in.seekg(0);
  if (!in.read(text.data(), static_cast<std::streamsize>(size))) fail(path, "could not be read to its end");
  return text;
}

std::string resolve_path(const std::string& collection_path, const std::string& file) {
  std::string name = file;
  std::replace(name.begin(), name.end(), '\\', '/');  // Written on Windows.
  return (std::filesystem::path(collection_path).parent_path() / name).string();
}

}  // namespace tetravox::io
