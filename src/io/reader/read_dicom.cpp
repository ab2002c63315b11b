// DICOM: a directory or ZIP archive of slices, or one file of several frames. VTK 9.1 ignores orientations, damaged
// slices and several series in one place. World is the patient's: left, posterior, superior; mm.

#include "src/io/formats.h"
#include "src/io/reader/dicom_file.h"
#include "src/io/reader/file_checks.h"
#include "src/io/reader/raw_volume.h"
#include "src/io/reader/status.h"
#include "src/io/reader/zip_archive.h"
#include "src/support/threads.h"

#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <sstream>

namespace tetravox::io {

namespace {

/// Slices nearer than this lie at one place, mm.
constexpr double kSamePlace = 1e-4;
/// Distances may differ from their mean by this part, since they are rounded text.
constexpr double kEvenWithin = 0.01;

double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The files of a series, and what keeps their bytes.
struct Library {
  std::vector<std::unique_ptr<MappedFile>> maps;
  std::vector<ArchiveFile> unpacked;
  std::vector<DicomFile> files;
  std::uint64_t without_image = 0;
};

void add_file(Library& library, std::string_view bytes, const std::string& name) {
  DicomFile file = parse_dicom(bytes, name);
  if (file.pixels.empty())
    ++library.without_image;
  else
    library.files.push_back(std::move(file));
}

void add_archive(Library& library, const std::string& path) {
  std::vector<ArchiveFile> all = read_zip(path);
  std::erase_if(all, [](const ArchiveFile& file) { return !is_dicom_head(file.bytes); });
  if (all.empty()) throw Error(ErrorCode::kUnsupported, "'" + path + "' holds no DICOM file: name a file of data");
  library.unpacked = std::move(all);
  for (const ArchiveFile& file : library.unpacked) add_file(library, file.bytes, path + "/" + file.name);
}

/// Files that are not DICOM are passed over in a directory, unless their names say that they should be.
void add_directory(Library& library, const std::string& path) {
  std::vector<std::string> archives;
  for (const std::string& name : list_files(path)) {
    if (has_ending(name, ".zip")) archives.push_back(name);
    const bool is_named_so = has_ending(name, ".dcm") || has_ending(name, ".dicom") || has_ending(name, ".ima");
    if (!is_named_so && !is_dicom_head(read_head(name, 132))) continue;
    library.maps.push_back(std::make_unique<MappedFile>(name));
    add_file(library, library.maps.back()->text(), name);
  }
  if (!library.files.empty()) return;
  if (archives.size() != 1)
    throw Error(ErrorCode::kUnsupported, "'" + path + "' holds no DICOM image, or several archives: name one of them");
  add_archive(library, archives.front());
}

Library open_library(const std::string& path) {
  Library library;
  struct stat status {};
  if (stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode)) {
    add_directory(library, path);
  } else if (has_ending(path, ".zip")) {
    add_archive(library, path);
  } else {
    library.maps.push_back(std::make_unique<MappedFile>(path));
    add_file(library, library.maps.back()->text(), path);
  }
  if (library.files.empty()) throw Error(ErrorCode::kNothingToDraw, "'" + path + "' holds no DICOM image");
  return library;
}

/// What slices of one volume have in common, as text.
std::string volume_key(const DicomFile& file) {
  std::ostringstream key;
  key << file.series << '|' << file.rows << '|' << file.columns << '|' << file.samples << '|' << file.bits_allocated
      << '|' << file.bits_stored << '|' << file.is_signed << '|' << file.photometric << '|';
  for (std::size_t i = 0; file.orientation && i < 6; ++i) key << std::lround((*file.orientation)[i] * 1000.0) << '|';
  for (const double spacing : file.pixel_spacing) key << std::lround(spacing * 1000.0) << '|';
  return key.str();
}

/// The files of the volume with the most slices.
std::vector<const DicomFile*> largest_volume(const Library& library, std::vector<std::string>& notes) {
  std::map<std::string, std::vector<const DicomFile*>> volumes;
  for (const DicomFile& file : library.files) volumes[volume_key(file)].push_back(&file);
  const auto count = [](const auto& volume) {
    std::uint64_t frames = 0;
    for (const DicomFile* file : volume.second) frames += file->frames;
    return frames;
  };
  const auto largest = std::max_element(volumes.begin(), volumes.end(),
                                        [&](const auto& a, const auto& b) { return count(a) < count(b); });
  if (volumes.size() > 1)
    notes.push_back("the files are of " + std::to_string(volumes.size()) +
                    " volumes (series, sizes, orientations); the one with most slices is taken");
  return largest->second;
}

struct Slice {
  const DicomFile* file = nullptr;
  std::uint64_t frame = 0;
  std::optional<Vector3> position;
  double height = 0.0;  ///< along the normal
};

std::vector<Slice> list_slices(const std::vector<const DicomFile*>& files) {
  std::vector<Slice> slices;
  for (const DicomFile* file : files)
    for (std::uint64_t frame = 0; frame < file->frames; ++frame) {
      Slice slice{file, frame, std::nullopt, 0.0};
      if (file->positions.size() == file->frames) slice.position = file->positions[static_cast<std::size_t>(frame)];
      slices.push_back(slice);
    }
  return slices;
}

/// A volume whose slices are in order.
struct Volume {
  std::vector<Slice> slices;
  VolumeFrame frame;
  std::vector<double> coordinates;  ///< of uneven slices
};

/// Orders slices by their height, leaves out those at a place that is taken, and derives the step along k, which need
/// not be along the normal.
void place_by_position(Volume& volume, const Vector3& normal, std::vector<std::string>& notes) {
  auto& slices = volume.slices;
  for (Slice& slice : slices) slice.height = dot(*slice.position, normal);
  const auto number = [](const Slice& slice) { return slice.file->instance.value_or(0); };
  std::stable_sort(slices.begin(), slices.end(), [&](const Slice& a, const Slice& b) {
    if (std::abs(a.height - b.height) > 0.0) return a.height < b.height;
    return number(a) < number(b);
  });
  const auto last = std::unique(slices.begin(), slices.end(),
                                [](const Slice& a, const Slice& b) { return b.height - a.height < kSamePlace; });
  if (last != slices.end())
    notes.push_back(std::to_string(slices.end() - last) + " slices at places where there is one already are left out");
  slices.erase(last, slices.end());
  volume.frame.origin = *slices.front().position;
  if (slices.size() < 2) return;
  const double count = static_cast<double>(slices.size() - 1);
  const double mean = (slices.back().height - slices.front().height) / count;
  auto& step = volume.frame.steps[2];
  for (std::size_t row = 0; row < 3; ++row)
    step[row] = ((*slices.back().position)[row] - volume.frame.origin[row]) / count;
  const double scale = std::sqrt(dot(step, step)) / mean;
  bool is_even = true;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const double height = slices[i].height - slices.front().height;
    volume.coordinates.push_back(height * scale);
    is_even = is_even && std::abs(height - static_cast<double>(i) * mean) <= kEvenWithin * mean;
  }
  if (is_even)
    volume.coordinates.clear();
  else
    notes.emplace_back("the distances of the slices differ; each is drawn where it is");
}

Volume place_slices(const std::vector<const DicomFile*>& files, std::vector<std::string>& notes) {
  Volume volume;
  volume.slices = list_slices(files);
  const DicomFile& first = *files.front();
  const auto o = first.orientation.value_or(std::array<double, 6>{1, 0, 0, 0, 1, 0});
  const Vector3 row{o[0], o[1], o[2]}, column{o[3], o[4], o[5]};
  for (std::size_t i = 0; i < 3; ++i) {
    volume.frame.steps[0][i] = row[i] * first.pixel_spacing[1];
    volume.frame.steps[1][i] = column[i] * first.pixel_spacing[0];
  }
  Vector3 normal = cross(row, column);
  const double length = std::sqrt(dot(normal, normal));
  const double thickness = first.thickness > 0.0 ? first.thickness : 1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    normal[i] = length > 0.0 ? normal[i] / length : 0.0;
    volume.frame.steps[2][i] = normal[i] * thickness;
  }
  const bool has_positions = std::all_of(volume.slices.begin(), volume.slices.end(),
                                         [](const Slice& slice) { return slice.position.has_value(); });
  if (has_positions && length > 0.0 && first.orientation) {
    place_by_position(volume, normal, notes);
    return volume;
  }
  std::stable_sort(volume.slices.begin(), volume.slices.end(), [](const Slice& a, const Slice& b) {
    return a.file->instance.value_or(0) < b.file->instance.value_or(0);
  });
  if (!first.positions.empty()) volume.frame.origin = first.positions.front();
  const bool is_told = files.size() == 1 && first.thickness > 0.0;
  if (volume.slices.size() > 1 && !is_told)
    notes.push_back("slices do not say where they lie: taken in the order of their numbers, " +
                    std::to_string(thickness) + " apart");
  return volume;
}

/// Number type of the values: as stored where nothing rescales them; whole numbers where a whole number is added.
ScalarType choose_type(const std::vector<Slice>& slices) {
  const DicomFile& first = *slices.front().file;
  const bool is_whole = std::all_of(slices.begin(), slices.end(), [](const Slice& slice) {
    return slice.file->slope == 1.0 && slice.file->intercept == std::round(slice.file->intercept) &&
           std::abs(slice.file->intercept) < 1e6;
  });
  if (first.samples > 1 || !is_whole) return first.samples > 1 ? ScalarType::kUint8 : ScalarType::kFloat32;
  const double span = std::ldexp(1.0, static_cast<int>(first.bits_stored) - (first.is_signed ? 1 : 0));
  double low = 1e30, high = -1e30;
  for (const Slice& slice : slices) {
    low = std::min(low, slice.file->intercept - (first.is_signed ? span : 0.0));
    high = std::max(high, slice.file->intercept + span - 1.0);
  }
  for (const auto& [type, least, most] : {std::tuple{ScalarType::kUint8, 0.0, 255.0},
                                          {ScalarType::kInt8, -128.0, 127.0},
                                          {ScalarType::kUint16, 0.0, 65535.0},
                                          {ScalarType::kInt16, -32768.0, 32767.0},
                                          {ScalarType::kUint32, 0.0, 4294967295.0},
                                          {ScalarType::kInt32, -2147483648.0, 2147483647.0}})
    if (low >= least && high <= most && scalar_type_size(type) * 8 >= first.bits_allocated) return type;
  return ScalarType::kFloat64;
}

template <class Word>
Word load(const char* bytes, bool is_big_endian) {
  Word value = 0;
  for (std::size_t i = 0; i < sizeof(Word); ++i) {
    const std::size_t at = is_big_endian ? sizeof(Word) - 1 - i : i;
    value = static_cast<Word>(value | static_cast<Word>(static_cast<unsigned char>(bytes[at])) << (8 * i));
  }
  return value;
}

/// Converts one frame to values of another type: stored bits, sign, slope and intercept.
template <class Word, class Value>
void convert_pixels(const DicomFile& file, const char* pixels, Value* values) {
  const std::size_t samples = static_cast<std::size_t>(file.samples);
  const std::size_t count = static_cast<std::size_t>(file.rows * file.columns);
  const unsigned shift = file.high_bit + 1 - file.bits_stored;
  const std::uint64_t mask = (std::uint64_t{1} << file.bits_stored) - 1,
                      sign = std::uint64_t{1} << (file.bits_stored - 1);
  const bool is_scaled = samples == 1 && (file.slope != 1.0 || file.intercept != 0.0);
  support::parallel_chunks(count, std::size_t{1} << 15, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t s = 0; s < samples; ++s) {
        const std::size_t from = file.is_planar ? s * count + i : i * samples + s;
        const std::uint64_t bits = load<Word>(pixels + from * sizeof(Word), file.is_big_endian) >> shift & mask;
        const auto stored = static_cast<std::int64_t>(bits) -
                            (file.is_signed && (bits & sign) != 0 ? static_cast<std::int64_t>(mask) + 1 : 0);
        values[i * samples + s] = is_scaled
                                      ? static_cast<Value>(static_cast<double>(stored) * file.slope + file.intercept)
                                      : static_cast<Value>(stored);
      }
  });
}

template <class Value>
void convert_words(const Slice& slice, void* out) {
  const DicomFile& file = *slice.file;
  const char* pixels = file.pixels.data() + slice.frame * file.frame_bytes();
  auto* values = static_cast<Value*>(out);
  if (file.bits_allocated == 8)
    convert_pixels<std::uint8_t>(file, pixels, values);
  else if (file.bits_allocated == 16)
    convert_pixels<std::uint16_t>(file, pixels, values);
  else
    convert_pixels<std::uint32_t>(file, pixels, values);
}

void convert_slice(const Slice& slice, ScalarType type, void* out) {
  switch (type) {
    case ScalarType::kInt8:
      return convert_words<std::int8_t>(slice, out);
    case ScalarType::kUint8:
      return convert_words<std::uint8_t>(slice, out);
    case ScalarType::kInt16:
      return convert_words<std::int16_t>(slice, out);
    case ScalarType::kUint16:
      return convert_words<std::uint16_t>(slice, out);
    case ScalarType::kInt32:
      return convert_words<std::int32_t>(slice, out);
    case ScalarType::kUint32:
      return convert_words<std::uint32_t>(slice, out);
    case ScalarType::kFloat32:
      return convert_words<float>(slice, out);
    default:
      return convert_words<double>(slice, out);
  }
}

void add_remarks(const DicomFile& file, std::uint64_t without_image, std::vector<std::string>& notes) {
  if (file.photometric == "MONOCHROME1") notes.emplace_back("MONOCHROME1: small values are bright in this file");
  if (file.photometric == "PALETTE COLOR") notes.emplace_back("values are places in the file's palette");
  if (file.photometric.starts_with("YBR")) notes.emplace_back("values are luminance and colour differences");
  if (without_image > 0) notes.push_back(std::to_string(without_image) + " files without an image are left out");
}

}  // namespace

FileContents read_dicom(const std::string& path) {
  FileContents contents;
  const Library library = open_library(path);
  const auto files = largest_volume(library, contents.notes);
  const DicomFile& first = *files.front();
  if (first.samples > 1 && first.bits_allocated != 8)
    throw Error(ErrorCode::kUnsupported, "'" + first.name + "' has colours of more than 8 bits");
  const Volume volume = place_slices(files, contents.notes);
  const ScalarType type = choose_type(volume.slices);
  const auto image = make_image({first.columns, first.rows, volume.slices.size()}, first.samples, type, "DICOM", path);
  throw_if_vtk_failed(path);
  const std::span<std::byte> values = image_bytes(*image);
  const std::size_t plane = values.size() / volume.slices.size();
  for (std::size_t k = 0; k < volume.slices.size(); ++k) {
    convert_slice(volume.slices[k], type, values.data() + k * plane);
    send_progress(0.9 * static_cast<double>(k + 1) / static_cast<double>(volume.slices.size()));
  }
  set_frame(*image, volume.frame, contents.notes);
  contents.slice_coordinates = volume.coordinates;
  add_remarks(first, library.without_image, contents.notes);
  contents.blocks.emplace_back(image);
  return contents;
}

}  // namespace tetravox::io
