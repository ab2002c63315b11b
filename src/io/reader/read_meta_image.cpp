// MetaImage (ITK's MetaIO, "MetaImage Format Documentation"). VTK 9.1 drops the TransformMatrix, whose rows are the
// directions of the axes as ITK reads them, and takes zeros for values that are missing.

#include "src/io/collections.h"
#include "src/io/reader/raw_volume.h"

#include <algorithm>
#include <map>

namespace tetravox::io {

namespace {

constexpr std::size_t kLongestHeader = std::size_t{1} << 20;

struct Header {
  std::map<std::string, std::string> fields;
  std::vector<std::string> listed_files;
  std::uint64_t end = 0;  ///< bytes before local data

  /// The first of these fields that is there.
  std::string get(std::initializer_list<const char*> names) const {
    for (const char* name : names)
      if (const auto found = fields.find(lower_case(name)); found != fields.end()) return found->second;
    return {};
  }
  bool is_true(std::initializer_list<const char*> names) const {
    const std::string value = lower_case(get(names));
    return value == "true" || value == "1" || value == "yes";
  }
};

/// ElementDataFile ends the header; names may follow it.
Header parse_header(const std::string& text, const std::string& path) {
  Header header;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    const std::string_view line = std::string_view(text).substr(at, end == std::string::npos ? end : end - at);
    at = end == std::string::npos ? text.size() : end + 1;
    const std::size_t equals = line.find('=');
    if (trim(line).empty() || trim(line).starts_with('#')) continue;
    if (equals == std::string_view::npos) fail_file(path, "a line of its header is no field");
    const std::string name = lower_case(trim(line.substr(0, equals)));
    header.fields[name] = trim(line.substr(equals + 1));
    if (name != "elementdatafile") continue;
    header.end = at;
    if (!header.fields[name].starts_with("LIST")) return header;
    while (at < text.size()) {
      const std::size_t next = std::min(text.find('\n', at), text.size());
      if (const std::string_view file = trim(std::string_view(text).substr(at, next - at)); !file.empty())
        header.listed_files.emplace_back(file);
      if (header.listed_files.size() > kMostCollectionFiles) fail_file(path, "it lists too many files");
      at = next + 1;
    }
    return header;
  }
  fail_file(path, "its header does not name its data (ElementDataFile)");
}

ScalarType parse_type(const std::string& name, const std::string& path) {
  static const std::map<std::string, ScalarType> kTypes{
      {"char", ScalarType::kInt8},         {"uchar", ScalarType::kUint8},   {"short", ScalarType::kInt16},
      {"ushort", ScalarType::kUint16},     {"int", ScalarType::kInt32},     {"uint", ScalarType::kUint32},
      {"long", ScalarType::kInt32},        {"ulong", ScalarType::kUint32},  {"long_long", ScalarType::kInt64},
      {"ulong_long", ScalarType::kUint64}, {"float", ScalarType::kFloat32}, {"double", ScalarType::kFloat64}};
  std::string type = lower_case(name);
  if (type.starts_with("met_")) type.erase(0, 4);
  if (type.ends_with("_array")) type.erase(type.size() - 6);
  const auto found = kTypes.find(type);
  if (found == kTypes.end()) fail_file(path, "its ElementType '" + name + "' is unknown");
  return found->second;
}

/// Values of a field of one number an axis, or of `count` numbers; nothing where it is not given.
std::vector<double> axis_numbers(const Header& header, std::initializer_list<const char*> names, std::size_t count,
                                 const std::string& path) {
  const std::vector<double> values = to_doubles(header.get(names), *names.begin(), path);
  if (!values.empty() && values.size() < count) fail_file(path, std::string("'") + *names.begin() + "' is too short");
  return values;
}

VolumeFrame parse_frame(const Header& header, std::size_t axes, const std::string& path) {
  const auto origin = axis_numbers(header, {"Offset", "Position", "Origin"}, axes, path);
  const auto matrix = axis_numbers(header, {"TransformMatrix", "Rotation", "Orientation"}, axes * axes, path);
  auto spacing = axis_numbers(header, {"ElementSpacing"}, axes, path);
  if (spacing.empty()) spacing = axis_numbers(header, {"ElementSize"}, axes, path);
  const std::size_t spatial = std::min<std::size_t>(axes, 3);
  VolumeFrame frame;
  for (std::size_t axis = 0; axis < spatial; ++axis) {
    if (!origin.empty()) frame.origin[axis] = origin[axis];
    const double length = spacing.empty() ? 1.0 : spacing[axis];
    for (std::size_t row = 0; row < 3; ++row) {
      const bool is_given = !matrix.empty() && row < spatial;
      frame.steps[axis][row] = length * (is_given ? matrix[axis * axes + row] : (row == axis ? 1.0 : 0.0));
    }
  }
  return frame;
}

void set_files(const Header& header, RawVolume& volume, std::size_t axes, const std::string& path) {
  const std::string named = header.get({"ElementDataFile"});
  const std::vector<std::string> words = split_words(named);
  if (words.empty()) fail_file(path, "its header does not name its data (ElementDataFile)");
  VolumeFiles& files = volume.files;
  if (named.starts_with("LIST")) {
    files.paths = header.listed_files;
    if (files.paths.empty()) fail_file(path, "it lists no data file");
  } else if (named.find('%') != std::string::npos && words.size() >= 3) {
    const auto first = to_integer(words[1]), last = to_integer(words[2]);
    const auto step = words.size() > 3 ? to_integer(words[3]) : std::optional<std::int64_t>(1);
    if (!first || !last || !step) fail_file(path, "the range of its data files makes no sense");
    files.paths = expand_pattern(words[0], *first, *last, *step, path);
  } else if (lower_case(named) != "local") {
    files.paths = {named};
  }
  if (axes < 2) fail_file(path, "its number of axes makes no sense");
  for (std::string& name : files.paths) name = resolve_path(path, name);
  if (files.paths.empty()) {
    files.paths = {path};
    files.offset = header.end;
  }
  const auto skipped = to_integer(header.get({"HeaderSize"})).value_or(0);
  if (skipped < -1) fail_file(path, "its HeaderSize makes no sense");
  files.is_at_end = skipped == -1;
  files.offset += static_cast<std::uint64_t>(std::max<std::int64_t>(skipped, 0));
}

}  // namespace

FileContents read_meta_image(const std::string& path, const TimeRequest& time) {
  const Header header = parse_header(read_head(path, kLongestHeader), path);
  const auto sizes = to_sizes(header.get({"DimSize"}), "DimSize", path);
  const auto axes = to_integer(header.get({"NDims"}));
  if (!axes || sizes.size() != static_cast<std::uint64_t>(*axes)) fail_file(path, "its NDims and DimSize do not fit");
  if (sizes.size() > 4) throw Error(ErrorCode::kUnsupported, "'" + path + "' has more than four axes: give one volume");
  RawVolume volume;
  std::copy_n(sizes.begin(), std::min<std::size_t>(sizes.size(), 3), volume.points.begin());
  if (sizes.size() == 4) {
    if (sizes[3] > kMostCollectionFiles) fail_file(path, "its dimensions make no sense");
    for (std::uint64_t i = 0; i < sizes[3]; ++i) volume.times.push_back(static_cast<double>(i));
  }
  volume.type = parse_type(header.get({"ElementType"}), path);
  const auto channels = to_integer(header.get({"ElementNumberOfChannels"})).value_or(1);
  if (channels < 1) fail_file(path, "its ElementNumberOfChannels makes no sense");
  volume.components = static_cast<std::uint64_t>(channels);
  volume.array_name = "MetaImage";
  volume.is_big_endian = header.is_true({"ElementByteOrderMSB", "BinaryDataByteOrderMSB"});
  volume.is_text = !header.get({"BinaryData"}).empty() && !header.is_true({"BinaryData"});
  volume.files.is_compressed = header.is_true({"CompressedData"});
  volume.frame = parse_frame(header, sizes.size(), path);
  set_files(header, volume, sizes.size(), path);
  return read_raw_volume(volume, path, time);
}

}  // namespace tetravox::io
