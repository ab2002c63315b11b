// Legacy VTK files. VTK's readers are silent about some that end too early, so the counts of the header are compared
// with what came.

#include "src/io/formats.h"
#include "src/io/reader/blocks.h"
#include "src/io/reader/file_checks.h"

#include <vtkDataReader.h>
#include <vtkNew.h>
#include <vtkRectilinearGrid.h>
#include <vtkRectilinearGridReader.h>
#include <vtkStructuredGrid.h>
#include <vtkStructuredGridReader.h>
#include <vtkStructuredPointsReader.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridReader.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <sstream>
#include <string_view>

namespace tetravox::io {

namespace {

/// The number that follows `keyword` at the beginning of a line, at its first occurrence; VTK takes both cases.
std::optional<long long> find_count(std::string_view text, std::string keyword) {
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t at = 0; (at = text.find(keyword, at)) != std::string_view::npos; ++at) {
      std::size_t number = at + keyword.size();
      if (at == 0 || text[at - 1] != '\n' || number >= text.size() || text[number] != ' ') continue;
      while (number < text.size() && text[number] == ' ') ++number;
      long long count = 0;
      const auto [end, error] = std::from_chars(text.data() + number, text.data() + text.size(), count);
      if (error == std::errc()) return count;
    }
    for (char& c : keyword) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return std::nullopt;
}

/// The word after DATASET, in lower case, which follows the header: two lines, and ASCII or BINARY.
std::string dataset_type(std::string_view text, const std::string& path) {
  std::istringstream in(std::string(text.substr(0, 4096)));
  std::string line, encoding, keyword, type;
  for (int i = 0; i < 2; ++i) std::getline(in, line);
  in >> encoding >> keyword >> type;
  if (lower_case(keyword) != "dataset") fail_file(path, "no DATASET after its header");
  return lower_case(type);
}

/// A section of data that has begun holds something, or other data follow it.
void require_section(std::string_view text, const std::string& path) {
  const std::size_t last = text.find_last_not_of(" \t\r\n");
  const std::size_t line = last == std::string::npos ? last : text.rfind('\n', last);
  if (line == std::string::npos) return;
  const std::string_view words = text.substr(line + 1);
  for (const char* keyword : {"POINT_DATA ", "CELL_DATA ", "point_data ", "cell_data "})
    if (words.starts_with(keyword)) fail_file(path, "it ends where its data should begin");
}

void require_count(std::string_view text, const char* keyword, vtkIdType count, const std::string& path) {
  const auto promised = find_count(text, keyword);
  if (promised && *promised != count)
    fail_file(path, std::string(keyword) + " promises " + std::to_string(*promised) + ", and " + std::to_string(count) +
                        " came");
}

template <class Reader>
FileContents read_with(const std::string& path) {
  const vtkNew<Reader> reader;
  vtkDataReader& data_reader = *reader;
  data_reader.SetFileName(path.c_str());
  data_reader.ReadAllScalarsOn();
  data_reader.ReadAllVectorsOn();
  data_reader.ReadAllNormalsOn();
  data_reader.ReadAllTensorsOn();
  data_reader.ReadAllColorScalarsOn();
  data_reader.ReadAllTCoordsOn();
  data_reader.ReadAllFieldsOn();
  FileContents contents;
  update_reader(*reader, path, {}, contents);
  contents.times.clear();  // VTK makes one up.
  append_blocks(reader->GetOutputDataObject(0), contents);
  return contents;
}

}  // namespace

FileContents read_legacy(const std::string& path) {
  const MappedFile file(path);
  const std::string_view text = file.text();
  const std::string type = dataset_type(text, path);
  require_section(text, path);
  FileContents contents;
  if (type == "unstructured_grid")
    contents = read_with<vtkUnstructuredGridReader>(path);
  else if (type == "structured_grid")
    contents = read_with<vtkStructuredGridReader>(path);
  else if (type == "rectilinear_grid")
    contents = read_with<vtkRectilinearGridReader>(path);
  else if (type == "structured_points")
    contents = read_with<vtkStructuredPointsReader>(path);
  else
    throw Error(ErrorCode::kUnsupported, "'" + path + "' holds '" + type +
                                             "': give structured points or an unstructured, structured or rectilinear "
                                             "grid");
  if (contents.blocks.empty()) fail_file(path, "VTK made nothing of it");
  vtkDataSet& data = *contents.blocks.front();
  if (type == "unstructured_grid") {
    if (data.GetNumberOfCells() == 0 && find_count(text, "CELLS").value_or(0) > 0)
      fail_file(path, "its cells could not be read");
    require_count(text, "CELL_TYPES", data.GetNumberOfCells(), path);
  }
  require_count(text, "POINTS", data.GetNumberOfPoints(), path);
  require_count(text, "POINT_DATA", data.GetNumberOfPoints(), path);
  require_count(text, "CELL_DATA", data.GetNumberOfCells(), path);
  return contents;
}

}  // namespace tetravox::io
