// PLOT3D: a grid file, and a solution file of the same layout.

#include "src/io/reader/blocks.h"

#include <vtkMultiBlockDataSet.h>
#include <vtkMultiBlockPLOT3DReader.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <unistd.h>

#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

namespace tetravox::io {

namespace {

/// Layout of a text file, which VTK does not find out by itself.
struct TextLayout {
  bool is_multi_grid = false;
  bool has_blanking = false;
};

bool is_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<char, 512> head{};
  in.read(head.data(), head.size());
  for (std::streamsize i = 0; i < in.gcount(); ++i) {
    const auto c = static_cast<unsigned char>(head[static_cast<std::size_t>(i)]);
    if (!std::isdigit(c) && !std::isspace(c) && c != '+' && c != '-' && c != '.' && c != 'e' && c != 'E' && c != ',')
      return false;
  }
  return in.gcount() > 0;
}

/// Points of all grids in a text file's header; leaves the stream behind the header.
std::uint64_t read_text_header(std::istream& in, bool is_multi_grid, const std::string& path) {
  constexpr long long kMostGrids = 100'000, kMostPoints = 1ll << 40;
  long long grids = 1;
  if (is_multi_grid) in >> grids;
  if (!in || grids < 1 || grids > kMostGrids) fail_file(path, "its number of grids makes no sense");
  long long points = 0;
  for (long long i = 0; i < grids; ++i) {
    long long ni = 0, nj = 0, nk = 0;
    in >> ni >> nj >> nk;
    const bool is_sane = in && ni > 0 && nj > 0 && nk > 0 && ni < (1 << 20) && nj < (1 << 20) && nk < (1 << 20);
    if (!is_sane || ni * nj > kMostPoints / nk) fail_file(path, "its dimensions make no sense");
    points += ni * nj * nk;
  }
  return static_cast<std::uint64_t>(points);
}

/// Finds the layout of a text grid by counting its numbers.
TextLayout find_text_layout(const std::string& path) {
  std::ifstream in(path);
  std::string first_line;
  while (std::getline(in, first_line) && first_line.find_first_not_of(" \t\r") == std::string::npos) {
  }
  std::istringstream words(first_line);
  std::string word;
  std::size_t count = 0;
  while (words >> word) ++count;
  TextLayout layout;
  layout.is_multi_grid = count == 1;
  in.seekg(0);
  const std::uint64_t points = read_text_header(in, layout.is_multi_grid, path);
  std::uint64_t numbers = 0;
  double value = 0.0;
  while (numbers <= 4 * points && in >> value) ++numbers;
  layout.has_blanking = numbers == 4 * points;
  if (numbers != 3 * points && numbers != 4 * points)
    fail_file(path, "it holds " + std::to_string(numbers) + " numbers for " + std::to_string(points) + " points");
  return layout;
}

/// The solution that lies beside a grid, "name.xyz" and "name.q", if it does.
std::string find_solution(const std::string& path) {
  for (const char* ending : {".q", ".Q"}) {
    const std::string candidate = std::filesystem::path(path).replace_extension(ending).string();
    if (access(candidate.c_str(), R_OK) == 0) return candidate;
  }
  return {};
}

}  // namespace

FileContents read_plot3d(const std::string& path, const std::string& solution_path) {
  FileContents contents;
  std::string solution = solution_path;
  if (solution.empty()) {
    solution = find_solution(path);
    if (!solution.empty())
      contents.notes.push_back("solution taken from '" + solution + "', which lies beside the grid");
  } else if (access(solution.c_str(), R_OK) != 0) {
    throw Error(ErrorCode::kFileNotFound, "cannot open the solution file '" + solution + "'");
  }
  const vtkNew<vtkMultiBlockPLOT3DReader> reader;
  reader->SetXYZFileName(path.c_str());
  if (is_text(path)) {
    const TextLayout layout = find_text_layout(path);
    reader->BinaryFileOff();
    reader->SetMultiGrid(layout.is_multi_grid);
    reader->SetIBlanking(layout.has_blanking);
  } else {
    reader->AutoDetectFormatOn();
  }
  if (!solution.empty()) reader->SetQFileName(solution.c_str());
  update_reader(*reader, path, {}, contents);
  contents.times.clear();  // VTK makes one up.
  append_blocks(reader->GetOutput(), contents);
  if (contents.blocks.empty()) fail_file(path, "not a PLOT3D grid of a known layout");
  for (const auto& block : contents.blocks) {
    if (block->GetNumberOfPoints() == 0) fail_file(path, "a grid without points came");
    if (!solution.empty() && !block->GetPointData()->GetArray("Density"))
      fail_file(solution, "the solution does not fit the grid '" + path + "'");
  }
  return contents;
}

}  // namespace tetravox::io
