// VTK's XML formats, and the small files that list others.

#include "src/io/collections.h"
#include "src/io/formats.h"
#include "src/io/reader/blocks.h"
#include "src/io/reader/file_checks.h"
#include "src/io/reader/status.h"
#include "src/io/time_steps.h"

#include <vtkCellData.h>
#include <vtkDataSetAttributes.h>
#include <vtkNew.h>
#include <vtkRectilinearGrid.h>
#include <vtkStructuredGrid.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLRectilinearGridReader.h>
#include <vtkXMLStructuredGridReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace tetravox::io {

namespace {

/// Collections may list collections this deep (a PVD of VTMs of PVTUs).
constexpr int kDeepestCollection = 4;

template <class Reader>
FileContents read_with(const std::string& path, const TimeRequest& time) {
  const vtkNew<Reader> reader;
  FileContents contents;
  reader->SetFileName(path.c_str());
  update_reader(*reader, path, time, contents);
  append_blocks(reader->GetOutputDataObject(0), contents);
  return contents;
}

/// What the pieces of an unstructured file promise is what came.
FileContents read_vtu(const std::string& path, const TimeRequest& time) {
  const vtkNew<vtkXMLUnstructuredGridReader> reader;
  FileContents contents;
  reader->SetFileName(path.c_str());
  update_reader(*reader, path, time, contents);
  vtkUnstructuredGrid* grid = reader->GetOutput();
  if (grid->GetNumberOfPoints() != reader->GetNumberOfPoints() ||
      grid->GetNumberOfCells() != reader->GetNumberOfCells())
    fail_file(path, "it promises " + std::to_string(reader->GetNumberOfPoints()) + " points and " +
                        std::to_string(reader->GetNumberOfCells()) + " cells, and holds others");
  append_blocks(grid, contents);
  return contents;
}

FileContents read_any(const std::string& path, const TimeRequest& time, int depth);

void append_contents(FileContents&& part, FileContents& whole) {
  std::move(part.blocks.begin(), part.blocks.end(), std::back_inserter(whole.blocks));
  std::move(part.notes.begin(), part.notes.end(), std::back_inserter(whole.notes));
  if (whole.slice_coordinates.empty()) whole.slice_coordinates = std::move(part.slice_coordinates);
}

/// Reads the files that a collection lists, each at its first time step.
void read_parts(const std::string& path, const std::vector<std::string>& files, int depth, FileContents& whole) {
  if (depth >= kDeepestCollection) fail_file(path, "collections list collections too deeply, or each other");
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string part = resolve_path(path, files[i]);
    try {
      append_contents(read_any(part, {}, depth + 1), whole);
    } catch (const Error& error) {
      // A missing part is damage of the whole.
      const bool is_missing = error.code() == ErrorCode::kFileNotFound || error.code() == ErrorCode::kUnsupported;
      throw Error(is_missing ? ErrorCode::kBadFile : error.code(),
                  "'" + path + "', entry " + std::to_string(i) + ": " + error.what());
    }
    send_progress(0.9 * static_cast<double>(i + 1) / static_cast<double>(files.size()));
  }
}

/// Pieces that overlap must say which cells are copies, or these would be drawn twice.
void require_ghost_marks(const std::string& path, const FileContents& contents) {
  for (const auto& block : contents.blocks)
    if (block->GetNumberOfCells() > 0 && !block->GetCellData()->GetArray(vtkDataSetAttributes::GhostArrayName()))
      throw Error(ErrorCode::kUnsupported, "'" + path +
                                               "': its pieces overlap (GhostLevel) and do not mark their ghost cells "
                                               "(vtkGhostType): write it again without ghost levels");
}

FileContents read_pvd(const std::string& path, const TimeRequest& time, int depth) {
  const PvdCollection collection = parse_pvd(read_collection_text(path), path);
  FileContents contents;
  contents.times = collection.times;
  contents.time_index = pick_time(contents.times, time, path);
  read_parts(path, files_of_step(collection, contents.time_index), depth, contents);
  return contents;
}

FileContents read_list(const std::string& path, int depth) {
  const FileList list = parse_file_list(read_collection_text(path), path);
  FileContents contents;
  read_parts(path, list.files, depth, contents);
  if (list.has_ghost_levels && list.files.size() > 1) require_ghost_marks(path, contents);
  return contents;
}

/// A collection at its depth, or any other file.
FileContents read_any(const std::string& path, const TimeRequest& time, int depth) {
  switch (detect_format(path, false)) {
    case Format::kPvd:
      return read_pvd(path, time, depth);
    case Format::kMultiBlock:
    case Format::kParallelXml:
      return read_list(path, depth);
    case Format::kParallelGrid:
      return read_grid_pieces(path);
    default:
      return read_file(path, {}, time);
  }
}

}  // namespace

FileContents read_xml(const std::string& path, const TimeRequest& time) {
  check_xml_arrays(path);
  switch (detect_format(path, false)) {
    case Format::kVts:
      return read_with<vtkXMLStructuredGridReader>(path, time);
    case Format::kVtr:
      return read_with<vtkXMLRectilinearGridReader>(path, time);
    case Format::kVti:
      return read_with<vtkXMLImageDataReader>(path, time);
    default:
      return read_vtu(path, time);
  }
}

FileContents read_collection(const std::string& path, const TimeRequest& time) { return read_any(path, time, 0); }

}  // namespace tetravox::io
