// NRRD ("Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html). VTK 9.1 drops space directions that
// are not along the axes, and reads neither gzip nor lists of files.

#include "src/io/collections.h"
#include "src/io/reader/raw_volume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace tetravox::io {

namespace {

/// A header may not be longer than this.
constexpr std::size_t kLongestHeader = std::size_t{16} << 20;
constexpr std::size_t kMostAxes = 16;

struct Header {
  std::map<std::string, std::string> fields;  ///< by name in lower case
  std::vector<std::string> listed_files;      ///< the lines after "data file: LIST"
  std::uint64_t end = 0;                      ///< bytes before attached data

  std::string get(const std::string& name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? "" : found->second;
  }
};

/// Names that mean the same.
std::string canonical_name(const std::string& name) {
  static const std::map<std::string, std::string> kSynonyms{
      {"datafile", "data file"},       {"lineskip", "line skip"},  {"byteskip", "byte skip"},
      {"centerings", "centers"},       {"axismins", "axis mins"},  {"axismaxs", "axis maxs"},
      {"sampleunits", "sample units"}, {"blocksize", "block size"}};
  const auto found = kSynonyms.find(name);
  return found == kSynonyms.end() ? name : found->second;
}

Header parse_header(const std::string& text, const std::string& path) {
  Header header;
  bool is_list = false;
  std::size_t at = text.find('\n');
  at = at == std::string::npos ? text.size() : at + 1;
  while (at < text.size()) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string::npos && !is_list) break;
    const std::string_view line = trim(std::string_view(text).substr(at, end == std::string::npos ? end : end - at));
    at = end == std::string::npos ? text.size() : end + 1;
    if (line.empty()) {
      header.end = at;
      return header;
    }
    if (line.starts_with('#')) continue;
    if (is_list) {
      if (header.listed_files.size() >= kMostCollectionFiles) fail_file(path, "it lists too many files");
      header.listed_files.emplace_back(line);
      continue;
    }
    const std::size_t colon = line.find(": ");
    if (line.find(":=") < colon) continue;  // A remark of somebody's program.
    if (colon == std::string_view::npos) fail_file(path, "a line of its header is neither a field nor a comment");
    const std::string name = canonical_name(lower_case(trim(line.substr(0, colon))));
    if (!header.fields.emplace(name, trim(line.substr(colon + 2))).second)
      fail_file(path, "its header gives '" + name + "' twice");
    is_list = name == "data file" && header.fields[name].starts_with("LIST");
  }
  // Only a detached header may end without an empty line.
  if (header.get("data file").empty()) fail_file(path, "its header has no end");
  header.end = text.size();
  return header;
}

ScalarType parse_type(const std::string& name, const std::string& path) {
  static const std::map<std::string, ScalarType> kTypes = [] {
    std::map<std::string, ScalarType> types{{"signed char", ScalarType::kInt8},    {"uchar", ScalarType::kUint8},
                                            {"unsigned char", ScalarType::kUint8}, {"float", ScalarType::kFloat32},
                                            {"double", ScalarType::kFloat64},      {"int8", ScalarType::kInt8}};
    const auto add = [&](const std::string& base, const char* bits, ScalarType type, ScalarType unsigned_type) {
      for (const std::string& word : {base, "signed " + base, base + " int", "signed " + base + " int"})
        types.emplace(word, type);
      for (const std::string& word : {"u" + base, "unsigned " + base, "unsigned " + base + " int"})
        types.emplace(word, unsigned_type);
      for (const std::string suffix : {"", "_t"}) {
        types.emplace("int" + std::string(bits) + suffix, type);
        types.emplace("uint" + std::string(bits) + suffix, unsigned_type);
      }
    };
    add("short", "16", ScalarType::kInt16, ScalarType::kUint16);
    add("int", "32", ScalarType::kInt32, ScalarType::kUint32);
    add("longlong", "64", ScalarType::kInt64, ScalarType::kUint64);
    add("long long", "64", ScalarType::kInt64, ScalarType::kUint64);
    types.emplace("int8_t", ScalarType::kInt8);
    types.emplace("uint8", ScalarType::kUint8);
    types.emplace("uint8_t", ScalarType::kUint8);
    return types;
  }();
  const auto found = kTypes.find(lower_case(name));
  if (found == kTypes.end()) fail_file(path, "its number type '" + name + "' is unknown");
  return found->second;
}

/// "(1,0,0)" or "none" as numbers; empty for "none".
std::vector<std::vector<double>> parse_vectors(const std::string& text, const std::string& field,
                                               const std::string& path) {
  std::vector<std::vector<double>> vectors;
  for (std::size_t at = 0; (at = text.find_first_not_of(" \t", at)) != std::string::npos;) {
    if (lower_case(text.substr(at, 4)) == "none") {
      vectors.emplace_back();
      at += 4;
      continue;
    }
    const std::size_t end = text.find(')', at);
    if (text[at] != '(' || end == std::string::npos) fail_file(path, "'" + field + "' is not made of vectors");
    std::string numbers = text.substr(at + 1, end - at - 1);
    std::replace(numbers.begin(), numbers.end(), ',', ' ');
    vectors.push_back(to_doubles(numbers, field, path));
    if (vectors.back().size() > 3) fail_file(path, "'" + field + "' has vectors of more than three components");
    vectors.back().resize(3, 0.0);
    at = end + 1;
  }
  return vectors;
}

/// What is known of the axes, fastest first.
struct Axes {
  std::vector<std::uint64_t> sizes;
  std::vector<std::string> kinds;               ///< empty, or one an axis
  std::vector<std::vector<double>> directions;  ///< empty, or one an axis, itself empty where the axis has none
  std::optional<std::size_t> range;             ///< the axis that is not of space
};

/// Whether an axis is of space or time, as its kind says; a kind that is not given: unknown.
std::optional<bool> is_domain(const Axes& axes, std::size_t axis) {
  if (!axes.directions.empty()) return !axes.directions[axis].empty();
  if (axes.kinds.empty()) return std::nullopt;
  const std::string kind = lower_case(axes.kinds[axis]);
  if (kind == "???" || kind == "none") return std::nullopt;
  return kind == "domain" || kind == "space";
}

/// Axes of one value are no axes where there are too many; of four, one holds components (the fastest) or time steps
/// (the slowest).
void find_range_axis(Axes& axes, const std::string& path) {
  for (std::size_t axis = 0; axis < axes.sizes.size(); ++axis) {
    if (is_domain(axes, axis) != false) continue;
    if (axes.range)
      throw Error(ErrorCode::kUnsupported, "'" + path + "' has several axes that are not of space: give one volume");
    axes.range = axis;
  }
  if (!axes.range && axes.sizes.size() == 4) axes.range = axes.sizes[0] <= 4 ? 0 : 3;
  const std::size_t spatial = axes.sizes.size() - (axes.range ? 1 : 0);
  if (spatial > 3 || (axes.range && *axes.range != 0 && *axes.range != axes.sizes.size() - 1))
    throw Error(ErrorCode::kUnsupported,
                "'" + path + "' has axes that are not of space between those that are: give one volume");
}

Axes parse_axes(const Header& header, const std::string& path) {
  Axes axes;
  axes.sizes = to_sizes(header.get("sizes"), "sizes", path);
  const auto dimension = to_integer(header.get("dimension"));
  if (!dimension || axes.sizes.size() != static_cast<std::uint64_t>(*dimension) || axes.sizes.size() > kMostAxes)
    fail_file(path, "its dimension and sizes do not fit");
  axes.kinds = split_words(header.get("kinds"));
  axes.directions = parse_vectors(header.get("space directions"), "space directions", path);
  for (const std::size_t count : {axes.kinds.size(), axes.directions.size()})
    if (count != 0 && count != axes.sizes.size()) fail_file(path, "its fields are of other numbers of axes");
  find_range_axis(axes, path);
  return axes;
}

/// One number an axis; what is not given, or NaN, is `otherwise`.
std::vector<double> axis_numbers(const Header& header, const std::string& field, std::size_t count, double otherwise,
                                 const std::string& path) {
  std::vector<double> values = to_doubles(header.get(field), field, path);
  if (!values.empty() && values.size() != count) fail_file(path, "'" + field + "' is not one number an axis");
  values.resize(count, otherwise);
  for (double& value : values)
    if (std::isnan(value)) value = otherwise;
  return values;
}

/// Directions where the file has them, otherwise spacings and minima. Nothing is turned from one space to another.
VolumeFrame parse_frame(const Header& header, const Axes& axes, const std::string& path) {
  const std::size_t count = axes.sizes.size();
  const std::vector<double> spacings = axis_numbers(header, "spacings", count, 1.0, path);
  const std::vector<double> minima = axis_numbers(header, "axis mins", count, 0.0, path);
  const std::vector<std::string> centers = split_words(lower_case(header.get("centers")));
  VolumeFrame frame;
  std::size_t to = 0;
  for (std::size_t axis = 0; axis < count; ++axis) {
    if (axes.range == axis) continue;
    if (!axes.directions.empty()) {
      std::copy_n(axes.directions[axis].begin(), 3, frame.steps[to++].begin());
      continue;
    }
    const bool is_cell = axis < centers.size() && centers[axis] == "cell";
    const bool has_minimum = !header.get("axis mins").empty();
    frame.origin[to] = minima[axis] + (has_minimum && is_cell ? 0.5 * spacings[axis] : 0.0);
    frame.steps[to][to] = spacings[axis];
    ++to;
  }
  const auto origin = parse_vectors(header.get("space origin"), "space origin", path);
  if (!origin.empty() && !origin[0].empty()) std::copy_n(origin[0].begin(), 3, frame.origin.begin());
  return frame;
}

std::vector<std::string> find_files(const Header& header, const std::string& path) {
  const std::string named = header.get("data file");
  if (named.empty()) return {path};
  std::vector<std::string> names;
  if (named.starts_with("LIST")) {
    names = header.listed_files;
  } else if (const std::vector<std::string> words = split_words(named);
             words.size() >= 4 && words[0].find('%') != std::string::npos) {
    const auto first = to_integer(words[1]), last = to_integer(words[2]), step = to_integer(words[3]);
    if (!first || !last || !step) fail_file(path, "the range of its data files makes no sense");
    names = expand_pattern(words[0], *first, *last, *step, path);
  } else {
    names = {named};
  }
  if (names.empty()) fail_file(path, "it lists no data file");
  for (std::string& name : names) name = resolve_path(path, name);
  return names;
}

/// Bytes before the line number `lines`.
std::uint64_t skip_lines(const std::string& path, std::uint64_t offset, std::int64_t lines) {
  const std::string head = read_head(path, static_cast<std::size_t>(offset) + kLongestHeader);
  std::size_t at = static_cast<std::size_t>(offset);
  for (std::int64_t i = 0; i < lines; ++i) {
    at = head.find('\n', at);
    if (at++ == std::string::npos) fail_file(path, "it has fewer lines than its header skips");
  }
  return at;
}

void set_encoding(const Header& header, RawVolume& volume, const std::string& path) {
  const std::string encoding = lower_case(header.get("encoding"));
  volume.is_text = encoding == "txt" || encoding == "text" || encoding == "ascii";
  volume.files.is_compressed = encoding == "gz" || encoding == "gzip";
  if (!volume.is_text && !volume.files.is_compressed && encoding != "raw")
    throw Error(encoding.empty() ? ErrorCode::kBadFile : ErrorCode::kUnsupported,
                "'" + path + "' has values encoded as '" + encoding + "': write them as raw, gzip or text");
  volume.is_big_endian = lower_case(header.get("endian")) == "big";
  if (scalar_type_size(volume.type) > 1 && !volume.is_text && header.get("endian").empty())
    fail_file(path, "its header does not say in which order bytes stand (endian)");
  volume.files.paths = find_files(header, path);
  volume.files.offset = header.get("data file").empty() ? header.end : 0;
  const auto lines = to_integer(header.get("line skip")).value_or(0),
             bytes = to_integer(header.get("byte skip")).value_or(0);
  if (lines < 0 || bytes < -1 || (bytes == -1 && encoding != "raw")) fail_file(path, "it skips less than nothing");
  if (lines > 0) volume.files.offset = skip_lines(volume.files.paths.front(), volume.files.offset, lines);
  volume.files.is_at_end = bytes == -1;
  (volume.files.is_compressed ? volume.files.inflated_skip : volume.files.offset) +=
      static_cast<std::uint64_t>(std::max<std::int64_t>(bytes, 0));
}

}  // namespace

FileContents read_nrrd(const std::string& path, const TimeRequest& time) {
  const Header header = parse_header(read_head(path, kLongestHeader), path);
  const Axes axes = parse_axes(header, path);
  RawVolume volume;
  volume.type = parse_type(header.get("type"), path);
  std::size_t to = 0;
  for (std::size_t axis = 0; axis < axes.sizes.size(); ++axis)
    if (axes.range != axis) volume.points[to++] = axes.sizes[axis];
  if (axes.range == 0u) {
    volume.components = axes.sizes[0];
  } else if (axes.range) {
    const std::uint64_t steps = axes.sizes[*axes.range];
    if (steps > kMostCollectionFiles) fail_file(path, "its dimensions make no sense");
    for (std::uint64_t i = 0; i < steps; ++i) volume.times.push_back(static_cast<double>(i));
  }
  const std::string content = header.get("content");
  volume.array_name = content.empty() ? "NRRD" : content;
  volume.frame = parse_frame(header, axes, path);
  set_encoding(header, volume, path);
  return read_raw_volume(volume, path, time);
}

}  // namespace tetravox::io
