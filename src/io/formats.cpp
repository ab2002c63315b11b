#include "src/io/formats.h"

#include "tetravox/error.h"
#include "tetravox/io.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace tetravox::io {

namespace {

/// How far into a file is looked to find out what it is.
constexpr std::size_t kHeadBytes = 65536;

struct FormatEntry {
  Format format;
  const char* name;
  const char* endings;  ///< each followed by a blank
  const char* remark;   ///< for reader_names; empty: not listed there
};

constexpr std::array kFormats{
    FormatEntry{Format::kVtu, "VTK XML unstructured grid (VTU)", ".vtu ", "all encodings and compressors of VTK 9.1"},
    FormatEntry{Format::kVts, "VTK XML structured grid (VTS)", ".vts ", "as hexahedra; blanked cells are left out"},
    FormatEntry{Format::kVtr, "VTK XML rectilinear grid (VTR)", ".vtr ", "as hexahedra"},
    FormatEntry{Format::kParallelXml, "VTK XML parallel grid (PVTU, PVTS, PVTR)", ".pvtu .pvts .pvtr ",
                "pieces; ghost cells are left out"},
    FormatEntry{Format::kMultiBlock, "VTK XML multi-block (VTM)", ".vtm .vtmb ", "all blocks as one mesh"},
    FormatEntry{Format::kPvd, "ParaView data (PVD)", ".pvd ", "time steps and parts"},
    FormatEntry{Format::kLegacyVtk, "legacy VTK", ".vtk ", "unstructured, structured and rectilinear grids"},
    FormatEntry{Format::kVtkHdf, "VTKHDF", ".vtkhdf .hdf .h5 .hdf5 ", "unstructured grids"},
    FormatEntry{Format::kExodus, "Exodus II", ".ex2 .exo .exii .e .g .ncdf ", "element blocks; time steps"},
    FormatEntry{Format::kCgns, "CGNS", ".cgns .adf ", "structured and unstructured zones; ADF and HDF5; time steps"},
    FormatEntry{Format::kEnSight, "EnSight", ".case .encas ", "6 and Gold, ASCII and binary; time steps"},
    FormatEntry{Format::kOpenFoam, "OpenFOAM", ".foam .openfoam ",
                "also a case directory; polyhedra; cell data as it stands; time steps"},
    FormatEntry{Format::kUcd, "AVS UCD", ".inp .avs .ucd ", "ASCII and binary"},
    FormatEntry{Format::kPlot3d, "PLOT3D", ".xyz .p3d .x ",
                "grid file, any ending with a solution file; variant found automatically"},
    FormatEntry{Format::kRegularGrid, "regular grid",
                ".vti .pvti .nrrd .nhdr .mhd .mha .nii .nii.gz .slc .dcm .tif .tiff ", ""},
    FormatEntry{Format::kSurface, "surface", ".vtp .pvtp .stl .ply .obj ", ""},
};

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string readable_endings() {
  std::string out;
  for (const FormatEntry& entry : kFormats)
    if (*entry.remark) out += entry.endings;
  out.pop_back();
  return out;
}

std::optional<Format> format_by_ending(const std::string& path) {
  const std::string name = lower_case(path.substr(path.find_last_of('/') + 1));
  if (name == "controldict") return Format::kOpenFoam;
  for (const FormatEntry& entry : kFormats) {
    std::string_view endings = entry.endings;
    while (!endings.empty()) {
      const std::string_view ending = endings.substr(0, endings.find(' '));
      if (name.size() > ending.size() && name.ends_with(ending)) return entry.format;
      endings.remove_prefix(ending.size() + 1);
    }
  }
  return std::nullopt;
}

/// The format that a VTKFile element's `type` means.
std::optional<Format> format_of_xml_type(std::string_view type) {
  constexpr std::array<std::pair<std::string_view, Format>, 13> kTypes{{
      {"UnstructuredGrid", Format::kVtu},
      {"StructuredGrid", Format::kVts},
      {"RectilinearGrid", Format::kVtr},
      {"PUnstructuredGrid", Format::kParallelXml},
      {"PStructuredGrid", Format::kParallelXml},
      {"PRectilinearGrid", Format::kParallelXml},
      {"vtkMultiBlockDataSet", Format::kMultiBlock},
      {"Collection", Format::kPvd},
      {"ImageData", Format::kRegularGrid},
      {"PImageData", Format::kRegularGrid},
      {"vtkOverlappingAMR", Format::kRegularGrid},
      {"PolyData", Format::kSurface},
      {"PPolyData", Format::kSurface},
  }};
  for (const auto& [name, format] : kTypes)
    if (name == type) return format;
  return std::nullopt;
}

std::optional<Format> format_of_xml(std::string_view head) {
  const std::size_t element = head.find("<VTKFile");
  if (element == std::string_view::npos) return std::nullopt;
  std::string_view tag = head.substr(element, head.find('>', element) - element);
  const std::size_t type = tag.find("type=");
  if (type == std::string_view::npos || type + 6 > tag.size()) return std::nullopt;
  const char quote = tag[type + 5];
  tag.remove_prefix(type + 6);
  return format_of_xml_type(tag.substr(0, tag.find(quote)));
}

Format format_of_legacy(std::string_view head) {
  const std::string text = lower_case(std::string(head.substr(0, 2048)));
  const std::size_t dataset = text.find("dataset ");
  if (dataset == std::string::npos) return Format::kLegacyVtk;
  const std::string_view type = std::string_view(text).substr(text.find_first_not_of(' ', dataset + 8));
  if (type.starts_with("structured_points")) return Format::kRegularGrid;
  return type.starts_with("polydata") ? Format::kSurface : Format::kLegacyVtk;
}

/// The format that the first bytes of a file tell, if they do.
std::optional<Format> format_by_content(std::string_view head) {
  using namespace std::string_view_literals;
  if (head.substr(0, 4096).find("<VTKFile") != std::string_view::npos) return format_of_xml(head);
  if (head.starts_with("# vtk DataFile") || head.starts_with("# vtk datafile")) return format_of_legacy(head);
  if (head.starts_with("CDF\1"sv) || head.starts_with("CDF\2"sv) || head.starts_with("CDF\5"sv)) return Format::kExodus;
  if (head.substr(0, 64).find("ADF Database Version") != std::string_view::npos) return Format::kCgns;
  if (head.starts_with("\x89HDF\r\n\x1a\n"sv)) {
    if (head.find("VTKHDF") != std::string_view::npos) return Format::kVtkHdf;
    if (head.find("CGNSLibraryVersion") != std::string_view::npos) return Format::kCgns;
    if (head.find("num_nod") != std::string_view::npos) return Format::kExodus;
  }
  return std::nullopt;
}

/// Formats that must begin with a magic number: another beginning means that the file is not what its ending says.
void check_magic(Format format, std::string_view head, const std::string& path) {
  using namespace std::string_view_literals;
  const bool is_hdf5 = head.starts_with("\x89HDF\r\n\x1a\n"sv);
  const bool is_xml = format == Format::kVtu || format == Format::kVts || format == Format::kVtr ||
                      format == Format::kParallelXml || format == Format::kMultiBlock || format == Format::kPvd;
  const bool is_wrong =
      is_xml || format == Format::kLegacyVtk ||
      ((format == Format::kVtkHdf || format == Format::kExodus || format == Format::kCgns) && !is_hdf5);
  if (is_wrong)
    throw Error(ErrorCode::kBadFile, "'" + path + "' does not begin like a file of its kind (" + format_name(format) +
                                         "): it is damaged or its ending is wrong");
}

std::string read_head(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(ErrorCode::kFileNotFound, "cannot open '" + path + "': " + std::strerror(errno));
  std::string head(kHeadBytes, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  return head;
}

Format format_of_directory(const std::string& path) {
  if (access((path + "/system/controlDict").c_str(), R_OK) == 0) return Format::kOpenFoam;
  throw Error(ErrorCode::kUnsupported,
              "'" + path + "' is a directory and not an OpenFOAM case (no system/controlDict): name a file in it");
}

/// Refuses what cannot be read at all.
void check_accessible(const std::string& path, const struct stat& status) {
  if (!S_ISREG(status.st_mode))
    throw Error(ErrorCode::kBadFile, "'" + path + "' is not a regular file: copy the data to one");
  if (access(path.c_str(), R_OK) != 0)
    throw Error(ErrorCode::kFileNotFound, "cannot open '" + path + "': " + std::strerror(errno));
}

}  // namespace

std::string format_name(Format format) {
  for (const FormatEntry& entry : kFormats)
    if (entry.format == format) return entry.name;
  return "unknown";
}

Format detect_format(const std::string& path, bool has_solution) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0)
    throw Error(ErrorCode::kFileNotFound, "cannot open '" + path + "': " + std::strerror(errno));
  if (S_ISDIR(status.st_mode)) return format_of_directory(path);
  check_accessible(path, status);
  const std::optional<Format> by_ending = format_by_ending(path);
  if (by_ending == Format::kOpenFoam) return Format::kOpenFoam;  // Its file is a mark, often empty.
  if (status.st_size == 0)
    throw Error(ErrorCode::kBadFile, "'" + path + "' is empty: write it again with the program that made it");
  if (has_solution) return Format::kPlot3d;
  const std::string head = read_head(path);
  if (const auto by_content = format_by_content(head)) return *by_content;
  if (!by_ending)
    throw Error(ErrorCode::kUnsupported, "'" + path + "' is of no known format; endings that can be read: " +
                                             readable_endings() + " (a PLOT3D grid needs its solution file named too)");
  check_magic(*by_ending, head, path);
  return *by_ending;
}

}  // namespace tetravox::io

namespace tetravox {

std::vector<std::pair<std::string, std::string>> reader_names() {
  std::vector<std::pair<std::string, std::string>> names;
  for (const io::FormatEntry& entry : io::kFormats)
    if (*entry.remark) names.emplace_back(entry.name, std::string(entry.endings) + "(" + entry.remark + ")");
  names.emplace_back("embedded", "builtin:NAME (made by formulas)");
  return names;
}

}  // namespace tetravox
