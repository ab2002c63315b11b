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
#include <filesystem>
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
    FormatEntry{Format::kVtr, "VTK XML rectilinear grid (VTR)", ".vtr ", "a grid, evenly spaced or not"},
    FormatEntry{Format::kVti, "VTK XML image data (VTI)", ".vti ", "all encodings and compressors of VTK 9.1"},
    FormatEntry{Format::kParallelXml, "VTK XML parallel mesh (PVTU, PVTS)", ".pvtu .pvts ",
                "pieces; ghost cells are left out"},
    FormatEntry{Format::kParallelGrid, "VTK XML parallel grid (PVTI, PVTR)", ".pvti .pvtr ", "pieces, put together"},
    FormatEntry{Format::kMultiBlock, "VTK XML multi-block (VTM)", ".vtm .vtmb ",
                "all blocks as one mesh; a single grid as a grid"},
    FormatEntry{Format::kPvd, "ParaView data (PVD)", ".pvd ", "time steps and parts"},
    FormatEntry{Format::kLegacyVtk, "legacy VTK", ".vtk ",
                "structured points; unstructured, structured and rectilinear grids"},
    FormatEntry{Format::kVtkHdf, "VTKHDF", ".vtkhdf .hdf .h5 .hdf5 ", "unstructured grids, image data"},
    FormatEntry{Format::kExodus, "Exodus II", ".ex2 .exo .exii .e .g .ncdf ", "element blocks; time steps"},
    FormatEntry{Format::kCgns, "CGNS", ".cgns .adf ", "structured and unstructured zones; ADF and HDF5; time steps"},
    FormatEntry{Format::kEnSight, "EnSight", ".case .encas ", "6 and Gold, ASCII and binary; time steps"},
    FormatEntry{Format::kOpenFoam, "OpenFOAM", ".foam .openfoam ",
                "also a case directory; polyhedra; cell data as it stands; time steps"},
    FormatEntry{Format::kUcd, "AVS UCD", ".inp .avs .ucd ", "ASCII and binary"},
    FormatEntry{Format::kPlot3d, "PLOT3D", ".xyz .p3d .x ",
                "grid file, any ending with a solution file; variant found automatically"},
    FormatEntry{Format::kNrrd, "NRRD", ".nrrd .nhdr ",
                "raw, text and gzip, attached or detached; spacings, directions, time steps"},
    FormatEntry{Format::kMetaImage, "MetaImage", ".mhd .mha ", "raw, text and compressed; direction; time steps"},
    FormatEntry{Format::kNifti, "NIfTI", ".nii .nii.gz .hdr .hdr.gz .img .img.gz ",
                "1, 2 and Analyze 7.5; sform or qform; time steps"},
    FormatEntry{Format::kSlc, "SLC", ".slc ", "of VolVis, raw and run lengths"},
    FormatEntry{Format::kDicom, "DICOM", ".dcm .dicom .ima .zip ",
                "a directory or ZIP archive of slices, or a file of several frames; not compressed"},
    FormatEntry{Format::kTiff, "TIFF", ".tif .tiff ", "a directory of slices, or a file of several pages"},
    FormatEntry{Format::kMrc, "MRC", ".mrc .map .ccp4 .rec .st .ali ", "MRC 2014, CCP4 and IMOD"},
    FormatEntry{Format::kRaw, "RAW", ".raw ",
                "by a name such as foot_256x256x256_uint8.raw; any ending with --dimensions and --scalar-type"},
    FormatEntry{Format::kHierarchy, "hierarchy of grids", ".vth .vthb .hdb .amr ", ""},
    FormatEntry{Format::kSurface, "surface", ".vtp .pvtp .stl .ply .obj ", ""},
};

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
  constexpr std::array<std::pair<std::string_view, Format>, 14> kTypes{{
      {"UnstructuredGrid", Format::kVtu},
      {"StructuredGrid", Format::kVts},
      {"RectilinearGrid", Format::kVtr},
      {"PUnstructuredGrid", Format::kParallelXml},
      {"PStructuredGrid", Format::kParallelXml},
      {"PRectilinearGrid", Format::kParallelGrid},
      {"vtkMultiBlockDataSet", Format::kMultiBlock},
      {"Collection", Format::kPvd},
      {"ImageData", Format::kVti},
      {"PImageData", Format::kParallelGrid},
      {"vtkOverlappingAMR", Format::kHierarchy},
      {"vtkNonOverlappingAMR", Format::kHierarchy},
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
  const std::string text = lower_case(head.substr(0, 2048));
  const std::size_t dataset = text.find("dataset ");
  if (dataset == std::string::npos) return Format::kLegacyVtk;
  const std::string_view type = std::string_view(text).substr(text.find_first_not_of(' ', dataset + 8));
  return type.starts_with("polydata") ? Format::kSurface : Format::kLegacyVtk;
}

/// Whether a NIfTI header stands here: its magic, and its own size in one byte order or the other.
bool is_nifti_head(std::string_view head) {
  using namespace std::string_view_literals;
  const auto at = [&](std::size_t first, std::size_t count) {
    return first < head.size() ? head.substr(first, count) : std::string_view{};
  };
  return at(344, 4) == "n+1\0"sv || at(344, 4) == "ni1\0"sv || at(4, 4) == "n+2\0"sv || at(4, 4) == "ni2\0"sv;
}

/// Whether the first bytes fit a format that `format_by_content` does not always know.
bool fits_head(Format format, std::string_view head) {
  using namespace std::string_view_literals;
  switch (format) {
    case Format::kNifti:
      return head.starts_with("\x1f\x8b"sv) || head.starts_with("\x5c\1\0\0"sv) || head.starts_with("\0\0\1\x5c"sv);
    case Format::kSlc:
      return head.starts_with("11111");
    case Format::kDicom:
      return head.starts_with("PK\3\4"sv);
    case Format::kNrrd:
    case Format::kTiff:
      return false;
    default:
      return true;
  }
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
  if (head.starts_with("NRRD000")) return Format::kNrrd;
  if (is_dicom_head(head)) return Format::kDicom;
  for (const std::string_view magic : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv})
    if (head.starts_with(magic)) return Format::kTiff;
  if (is_nifti_head(head)) return Format::kNifti;
  if (head.substr(0, 212).ends_with("MAP ")) return Format::kMrc;
  return std::nullopt;
}

/// Formats that must begin with a magic number: another beginning means that the file is not what its ending says.
void check_magic(Format format, std::string_view head, const std::string& path) {
  using namespace std::string_view_literals;
  const bool is_hdf5 = head.starts_with("\x89HDF\r\n\x1a\n"sv);
  const bool is_xml = format == Format::kVtu || format == Format::kVts || format == Format::kVtr ||
                      format == Format::kVti || format == Format::kParallelXml || format == Format::kParallelGrid ||
                      format == Format::kMultiBlock || format == Format::kPvd;
  const bool is_wrong =
      is_xml || format == Format::kLegacyVtk || (!fits_head(format, head) && !has_ending(path, ".img")) ||
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

/// The first bytes of a file; nothing where it cannot be read.
std::string peek(const std::string& path, std::size_t count) {
  std::ifstream in(path, std::ios::binary);
  std::string head(count, '\0');
  in.read(head.data(), static_cast<std::streamsize>(count));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
  return head;
}

Format format_of_directory(const std::string& path) {
  if (access((path + "/system/controlDict").c_str(), R_OK) == 0) return Format::kOpenFoam;
  bool has_tiff = false, has_archive = false;
  for (const std::string& file : list_files(path)) {
    if (is_dicom_head(peek(file, 132))) return Format::kDicom;
    has_tiff = has_tiff || has_ending(file, ".tif") || has_ending(file, ".tiff");
    has_archive = has_archive || has_ending(file, ".zip");
  }
  if (has_tiff) return Format::kTiff;
  if (has_archive) return Format::kDicom;
  throw Error(ErrorCode::kUnsupported, "'" + path +
                                           "' is a directory without slices (DICOM or TIFF) and not an OpenFOAM case "
                                           "(no system/controlDict): name a file in it");
}

/// Compares as people count: runs of digits by their number. Names that differ in leading zeros only: as text.
bool comes_before(const std::string& a, const std::string& b) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto run = [&](const std::string& text, std::size_t& at) {
    while (at < text.size() && text[at] == '0') ++at;
    const std::size_t begin = at;
    while (at < text.size() && is_digit(text[at])) ++at;
    return std::string_view(text).substr(begin, at - begin);
  };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const std::string_view x = run(a, i), y = run(b, j);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else if (a[i] != b[j]) {
      return a[i] < b[j];
    } else {
      ++i, ++j;
    }
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;
}

/// @throws Error (kFileNotFound).
struct stat examine(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0)
    throw Error(ErrorCode::kFileNotFound, "cannot open '" + path + "': " + std::strerror(errno));
  return status;
}

void check_not_empty(const std::string& path, const struct stat& status) {
  if (status.st_size == 0)
    throw Error(ErrorCode::kBadFile, "'" + path + "' is empty: write it again with the program that made it");
}

/// Refuses what cannot be read at all.
void check_accessible(const std::string& path, const struct stat& status) {
  if (!S_ISREG(status.st_mode))
    throw Error(ErrorCode::kBadFile, "'" + path + "' is not a regular file: copy the data to one");
  if (access(path.c_str(), R_OK) != 0)
    throw Error(ErrorCode::kFileNotFound, "cannot open '" + path + "': " + std::strerror(errno));
}

}  // namespace

std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::vector<std::string> list_files(const std::string& directory) {
  std::vector<std::string> files;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(directory, error), end; !error && entry != end; entry.increment(error))
    if (entry->is_regular_file(error) && !entry->path().filename().string().starts_with("."))
      files.push_back(entry->path().string());
  if (error) throw Error(ErrorCode::kFileNotFound, "cannot list '" + directory + "': " + error.message());
  std::sort(files.begin(), files.end(), comes_before);
  return files;
}

bool is_dicom_head(std::string_view head) { return head.size() >= 132 && head.substr(128, 4) == "DICM"; }

bool has_ending(const std::string& path, std::string_view ending) { return lower_case(path).ends_with(ending); }

std::string format_name(Format format) {
  for (const FormatEntry& entry : kFormats)
    if (entry.format == format) return entry.name;
  return "unknown";
}

void check_file(const std::string& path) {
  const struct stat status = examine(path);
  check_accessible(path, status);
  check_not_empty(path, status);
}

Format detect_format(const std::string& path, bool has_solution) {
  const struct stat status = examine(path);
  if (S_ISDIR(status.st_mode)) return format_of_directory(path);
  check_accessible(path, status);
  const std::optional<Format> by_ending = format_by_ending(path);
  if (by_ending == Format::kOpenFoam) return Format::kOpenFoam;  // Its file is a mark, often empty.
  check_not_empty(path, status);
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
