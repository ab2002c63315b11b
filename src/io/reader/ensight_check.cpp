// EnSight files, walked through from end to end (EnSight User Manual, "EnSight Gold" and "EnSight6 Data File Formats").
// VTK's readers go on with the last line they saw, or with zeros, where a file ends too early.

#include "src/io/reader/blocks.h"
#include "src/io/reader/file_checks.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iomanip>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

namespace tetravox::io {

namespace {

std::string trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1));
}

[[noreturn]] void fail_words(const std::string& path, const std::string& words, const char* expected) {
  fail_file(path, std::string("'").append(words, 0, 40).append("' stands where ").append(expected).append(" should"));
}

/// Nodes of an element type; 0 for polygons and polyhedra, empty for what is no element type.
std::optional<std::uint64_t> nodes_of(std::string type) {
  if (type.starts_with("g_")) type.erase(0, 2);  // Ghost elements.
  static const std::map<std::string, std::uint64_t> kNodes{
      {"point", 1},    {"bar2", 2},   {"bar3", 3},     {"tria3", 3},    {"tria6", 6},      {"quad4", 4},
      {"quad8", 8},    {"tetra4", 4}, {"tetra10", 10}, {"pyramid5", 5}, {"pyramid13", 13}, {"penta6", 6},
      {"penta15", 15}, {"hexa8", 8},  {"hexa20", 20},  {"nsided", 0},   {"nfaced", 0}};
  const auto found = kNodes.find(type);
  if (found == kNodes.end()) return std::nullopt;
  return found->second;
}

/// Walks through a text or binary file, and fails where it ends too early.
class Walker {
 public:
  struct Layout {
    bool is_binary = false;
    bool is_gold = true;
    bool is_big_endian = false;
    bool knows_byte_order = false;
  };

  Walker(const std::string& path, const Layout& layout) : file_(path), path_(path), layout_(layout) {}

  Layout layout() const { return layout_; }
  std::string_view text() const { return file_.text(); }
  void set_binary() { layout_.is_binary = true; }

  bool is_at_end() {
    if (!layout_.is_binary) skip_blank_lines();
    return at_ >= text().size();
  }

  std::string line() {
    if (!layout_.is_binary) return trim(text_line());
    const std::string_view record = take(80);
    return trim(record.substr(0, record.find('\0')));
  }

  std::int64_t integer() { return integers(1).front(); }

  /// Integers, in text on one line.
  std::vector<std::int64_t> integers(std::size_t count) {
    std::vector<std::int64_t> values;
    if (layout_.is_binary) {
      for (std::size_t i = 0; i < count; ++i) values.push_back(binary_integer());
      return values;
    }
    std::istringstream words{std::string(text_line())};
    for (std::int64_t value; values.size() < count && words >> value;) values.push_back(value);
    if (values.size() < count) fail_file(path_, "a whole number is missing");
    return values;
  }

  /// A count that is not negative and that the rest of the file could hold.
  std::uint64_t count() {
    const std::int64_t value = integer();
    if (value < 0 || static_cast<std::uint64_t>(value) > text().size())
      fail_file(path_, "the count " + std::to_string(value) + " makes no sense");
    return static_cast<std::uint64_t>(value);
  }

  /// Numbers: one a line in Gold's text, six a line in EnSight 6's.
  void skip_values(std::uint64_t count) {
    if (layout_.is_binary) return skip_bytes(count, 4);
    for (std::uint64_t lines = layout_.is_gold ? count : (count + 5) / 6; lines > 0; --lines) {
      const std::string number = trim(text_line());
      if (std::string_view("0123456789+-.nNiI").find(number.front()) == std::string_view::npos)
        fail_words(path_, number, "a number");
    }
  }

  /// Ids: in text one record a line, of at least `each` words.
  void skip_records(std::uint64_t count, std::uint64_t each) {
    if (layout_.is_binary) return skip_bytes(count, 4 * each);
    for (; count > 0; --count) {
      std::istringstream words{std::string(text_line())};
      std::int64_t value = 0;
      std::uint64_t found = 0;
      while (found < each && words >> value) ++found;
      if (found < each) fail_file(path_, "an element has too few nodes");
    }
  }

  /// Sum of `count` integers, one a line in text.
  std::uint64_t sum(std::uint64_t count) {
    std::uint64_t total = 0;
    for (; count > 0; --count) total += this->count();
    return total;
  }

 private:
  void skip_bytes(std::uint64_t count, std::uint64_t each) {
    if (each > 0 && count > text().size() / each) fail_file(path_, "it ends too early");
    take(count * each);
  }
  std::string_view take(std::uint64_t size) {
    if (size > text().size() - at_) fail_file(path_, "it ends too early");
    at_ += size;
    return text().substr(at_ - size, size);
  }
  void skip_blank_lines() {
    while (at_ < text().size()) {
      const std::size_t end = std::min(text().find('\n', at_), text().size());
      const std::string content = trim(text().substr(at_, end - at_));
      if (!content.empty() && content.front() != '#') return;
      at_ = std::min(end + 1, text().size());
    }
  }
  std::string_view text_line() {
    skip_blank_lines();
    if (at_ >= text().size()) fail_file(path_, "it ends too early");
    const std::size_t end = std::min(text().find('\n', at_), text().size());
    const std::string_view content = text().substr(at_, end - at_);
    at_ = std::min(end + 1, text().size());
    return content;
  }
  std::int64_t binary_integer() {
    const std::string_view bytes = take(4);
    const auto read = [&](bool is_big_endian) {
      std::uint32_t value = 0;
      for (std::size_t i = 0; i < 4; ++i)
        value = value << 8 | static_cast<unsigned char>(bytes[is_big_endian ? i : 3 - i]);
      return static_cast<std::int32_t>(value);
    };
    if (!layout_.knows_byte_order) {  // The first number is small: a part's, or of points.
      const std::int32_t little = read(false), big = read(true);
      layout_.is_big_endian = static_cast<std::uint32_t>(big) < static_cast<std::uint32_t>(little);
      layout_.knows_byte_order = true;
    }
    return read(layout_.is_big_endian);
  }

  MappedFile file_;
  const std::string& path_;
  Layout layout_;
  std::size_t at_ = 0;
};

/// What variables need to know of a part.
struct Part {
  std::uint64_t points = 0;
  std::uint64_t block_cells = 0;
  std::map<std::string, std::uint64_t> elements;
};

struct Geometry {
  std::map<std::int64_t, Part> parts;
  std::uint64_t points = 0;  ///< EnSight 6: all parts share them
  Walker::Layout layout;
};

void walk_elements(Walker& in, const std::string& type, bool has_ids, Part& part) {
  const std::uint64_t nodes = nodes_of(type).value();
  const std::uint64_t count = in.count();
  const bool is_text = !in.layout().is_binary;
  part.elements[type] = count;
  const bool is_fixed = nodes > 0;
  // EnSight 6's text has the id on the element's own line.
  if (has_ids && !(is_text && !in.layout().is_gold)) in.skip_records(count, 1);
  if (is_fixed) {
    in.skip_records(count, nodes + (has_ids && is_text && !in.layout().is_gold ? 1 : 0));
    return;
  }
  std::uint64_t faces = count;
  if (type.ends_with("nfaced")) faces = in.sum(count);
  const std::uint64_t corners = in.sum(faces);
  if (is_text)
    in.skip_records(faces, 1);
  else
    in.skip_records(corners, 1);
}

void walk_block(Walker& in, const std::string& words, const std::string& path, Part& part) {
  const auto size = in.integers(3);
  constexpr std::int64_t kMost = 1 << 20;
  for (const std::int64_t n : size)
    if (n < 1 || n > kMost) fail_file(path, "a block of " + std::to_string(n) + " points along an axis");
  part.points = static_cast<std::uint64_t>(size[0] * size[1] * size[2]);
  part.block_cells = 1;
  for (const std::int64_t n : size) part.block_cells *= static_cast<std::uint64_t>(std::max<std::int64_t>(n - 1, 1));
  if (words.find("range") != std::string::npos) in.integers(6);
  if (words.find("rectilinear") != std::string::npos && words.find("curvilinear") == std::string::npos)
    in.skip_values(static_cast<std::uint64_t>(size[0] + size[1] + size[2]));
  else if (words.find("uniform") != std::string::npos)
    in.skip_values(6);
  else
    in.skip_values(3 * part.points);
  if (words.find("iblanked") != std::string::npos) in.skip_values(part.points);
}

/// Gold: parts have their own points. Returns whether another part follows.
bool walk_gold_part(Walker& in, bool has_node_ids, bool has_element_ids, const std::string& path, Geometry& geometry) {
  Part& part = geometry.parts[in.integer()];
  in.line();  // Its description.
  while (!in.is_at_end()) {
    const std::string words = in.line();
    if (words.starts_with("coordinates")) {
      part.points = in.count();
      if (has_node_ids) in.skip_records(part.points, 1);
      in.skip_values(3 * part.points);
    } else if (words.starts_with("block")) {
      walk_block(in, words, path, part);
    } else if (words.starts_with("ghost_flags") || words.starts_with("element_ids")) {
      in.skip_values(part.block_cells);
    } else if (words.starts_with("node_ids")) {
      in.skip_values(part.points);
    } else if (words.starts_with("part")) {
      return true;
    } else if (nodes_of(words)) {
      walk_elements(in, words, has_element_ids, part);
    } else if (words.find("END TIME STEP") == std::string::npos) {
      fail_words(path, words, "a part or an element type");
    }
  }
  return false;
}

/// EnSight 6: all parts share the points; the number of a part stands on its line.
void walk_six_parts(Walker& in, bool has_node_ids, bool has_element_ids, const std::string& path, Geometry& geometry) {
  Part* part = nullptr;
  while (!in.is_at_end()) {
    const std::string words = in.line();
    if (words.starts_with("coordinates") && !part) {
      geometry.points = in.count();
      if (in.layout().is_binary) {
        if (has_node_ids) in.skip_records(geometry.points, 1);
        in.skip_values(3 * geometry.points);
      } else {
        in.skip_records(geometry.points, 1);
      }
    } else if (words.starts_with("part")) {
      std::int64_t number = 0;
      std::istringstream(words.substr(4)) >> number;
      part = &geometry.parts[number];
      in.line();
    } else if (words.starts_with("block") && part) {
      walk_block(in, words.find("iblanked") == std::string::npos ? "" : "iblanked", path, *part);
    } else if (nodes_of(words) && part) {
      walk_elements(in, words, has_element_ids, *part);
    } else {
      fail_words(path, words, "a part or an element type");
    }
  }
}

bool mentions_ids(const std::string& line) {
  return line.find("given") != std::string::npos || line.find("ignore") != std::string::npos;
}

/// Walks through the geometry; empty where its kind is not walked through (Fortran records, several steps in a file).
std::optional<Geometry> walk_geometry(const std::string& path, bool is_gold) {
  Walker in(path, {false, is_gold, false, false});
  const std::string_view head = in.text().substr(0, 84);
  if (head.find("Fortran Binary") != std::string_view::npos || head.find("BEGIN TIME STEP") != std::string_view::npos)
    return std::nullopt;
  if (head.starts_with("C Binary")) {
    in.set_binary();
    in.line();
  }
  if (in.line().starts_with("BEGIN TIME STEP")) return std::nullopt;
  in.line();
  const bool has_node_ids = mentions_ids(in.line());
  const bool has_element_ids = mentions_ids(in.line());
  Geometry geometry;
  if (!is_gold) {
    walk_six_parts(in, has_node_ids, has_element_ids, path, geometry);
  } else {
    std::string words = in.line();
    if (words.starts_with("extents")) {
      in.skip_values(in.layout().is_binary ? 6 : 3);
      words = in.line();
    }
    if (!words.starts_with("part")) fail_file(path, "no part begins where the first should");
    while (walk_gold_part(in, has_node_ids, has_element_ids, path, geometry)) {
    }
  }
  geometry.layout = in.layout();
  return geometry;
}

/// A line "scalar per node: 1 pressure p.****" of the case file.
struct Variable {
  std::uint64_t components = 0;
  bool is_per_node = false;
  int time_set = 0;  ///< 0: none
  bool has_file_set = false;
  std::string file;
};

/// Walks through the values of one variable.
void walk_variable(const std::string& path, const Variable& variable, const Geometry& geometry) {
  Walker in(path, geometry.layout);
  if (in.line().starts_with("BEGIN TIME STEP")) return;
  const Part* part = nullptr;
  std::uint64_t sections = 0;
  if (!geometry.layout.is_gold && variable.is_per_node && geometry.points > 0) {
    in.skip_values(variable.components * geometry.points);
    ++sections;
  }
  while (!in.is_at_end()) {
    const std::string words = in.line();
    if (words.find("undef") != std::string::npos || words.find("partial") != std::string::npos) return;
    if (words.starts_with("part")) {
      std::int64_t number = 0;
      if (geometry.layout.is_gold)
        number = in.integer();
      else
        std::istringstream(words.substr(4)) >> number;
      const auto found = geometry.parts.find(number);
      if (found == geometry.parts.end())
        fail_file(path, "it names part " + std::to_string(number) + ", which is not there");
      part = &found->second;
      continue;
    }
    std::uint64_t tuples = 0;
    if (part && (words.starts_with("coordinates") || words.starts_with("block")))
      tuples = variable.is_per_node ? part->points : part->block_cells;
    else if (part && part->elements.count(words))
      tuples = part->elements.at(words);
    else
      fail_words(path, words, "a part or an element type");
    in.skip_values(variable.components * tuples);
    ++sections;
  }
  if (sections == 0) fail_file(path, "it holds no values");
}

/// What the case file says, as far as it is needed to find the files of a step.
struct CaseFile {
  bool is_gold = true;
  Variable model;
  std::vector<Variable> variables;
  struct TimeSet {
    std::vector<std::int64_t> numbers;
    std::int64_t steps = 0, start = 0, increment = 1;
    std::vector<double> times;
  };
  std::map<int, TimeSet> time_sets;
};

/// Splits "[time set [file set]] [description] file"; the description is there for variables.
void parse_file_entry(const std::string& rest, bool has_description, Variable& variable) {
  std::istringstream in(rest);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  std::vector<int> numbers;
  const std::size_t least = has_description ? 2 : 1;
  while (words.size() > least && numbers.size() < 2) {
    int value = 0;
    const auto [end, error] = std::from_chars(words[0].data(), words[0].data() + words[0].size(), value);
    if (error != std::errc() || end != words[0].data() + words[0].size()) break;
    numbers.push_back(value);
    words.erase(words.begin());
  }
  if (!numbers.empty()) variable.time_set = numbers[0];
  variable.has_file_set = numbers.size() > 1;
  const std::size_t file = has_description ? 1 : 0;
  if (words.size() > file) variable.file = words[file];
  std::erase(variable.file, '"');
}

std::optional<std::uint64_t> components_of(const std::string& key) {
  if (key.starts_with("scalar per")) return 1;
  if (key.starts_with("vector per")) return 3;
  if (key.starts_with("tensor symm per")) return 6;
  if (key.starts_with("tensor asym per")) return 9;
  return std::nullopt;
}

template <class Number>
void append_numbers(const std::string& text, std::vector<Number>& numbers) {
  std::istringstream in(text);
  for (Number number; in >> number;) numbers.push_back(number);
}

void parse_time_line(const std::string& key, const std::string& rest, CaseFile::TimeSet& set) {
  if (key == "number of steps") std::istringstream(rest) >> set.steps;
  if (key == "filename start number") std::istringstream(rest) >> set.start;
  if (key == "filename increment") std::istringstream(rest) >> set.increment;
  if (key == "filename numbers") append_numbers(rest, set.numbers);
  if (key == "time values") append_numbers(rest, set.times);
}

CaseFile parse_case(const std::string& path) {
  CaseFile out;
  std::istringstream in(read_whole_file(path));
  std::string line, list_key;
  int time_set = 1;
  while (std::getline(in, line)) {
    line = trim(line);
    if (line.empty() || line.front() == '#') continue;
    const std::size_t colon = line.find(':');
    const std::string key = colon == std::string::npos ? list_key : trim(line.substr(0, colon));
    const std::string rest = colon == std::string::npos ? line : trim(line.substr(colon + 1));
    list_key = key == "time values" || key == "filename numbers" ? key : "";  // These go on in the next line.
    if (key == "type") out.is_gold = rest.find("gold") != std::string::npos;
    if (key == "model") parse_file_entry(rest, false, out.model);
    if (key == "time set") std::istringstream(rest) >> time_set;
    parse_time_line(key, rest, out.time_sets[time_set]);
    if (const auto components = components_of(key); components && key.find("measured") == std::string::npos) {
      Variable variable;
      variable.components = *components;
      variable.is_per_node = key.ends_with("node");
      parse_file_entry(rest, true, variable);
      out.variables.push_back(variable);
    }
  }
  return out;
}

/// The variable's file at a time: its stars stand for the number of the step. Empty where that cannot be told.
std::string file_of_step(const CaseFile& file, const Variable& variable, const std::string& case_path, double time) {
  std::string name = variable.file;
  const std::size_t stars = name.find('*');
  if (stars != std::string::npos) {
    const auto found = file.time_sets.find(variable.time_set == 0 ? 1 : variable.time_set);
    if (found == file.time_sets.end() || found->second.times.empty()) return {};
    const CaseFile::TimeSet& set = found->second;
    // VTK takes the last step that is not later than the time asked for.
    std::size_t step = 0;
    for (std::size_t i = 0; i < set.times.size(); ++i)
      if (set.times[i] <= time + 1e-6 * std::abs(time)) step = i;
    if (!set.numbers.empty() && step >= set.numbers.size()) return {};
    const std::int64_t number =
        set.numbers.empty() ? set.start + static_cast<std::int64_t>(step) * set.increment : set.numbers[step];
    const std::size_t width = name.find_first_not_of('*', stars) == std::string::npos
                                  ? name.size() - stars
                                  : name.find_first_not_of('*', stars) - stars;
    std::ostringstream digits;
    digits << std::setw(static_cast<int>(width)) << std::setfill('0') << number;
    name.replace(stars, width, digits.str());
  }
  return (std::filesystem::path(case_path).parent_path() / name).string();
}

}  // namespace

void check_ensight_files(const std::string& path, double time) {
  const CaseFile file = parse_case(path);
  if (file.model.has_file_set || file.model.file.empty()) return;
  const std::string geometry_path = file_of_step(file, file.model, path, time);
  if (geometry_path.empty()) return;
  const std::optional<Geometry> geometry = walk_geometry(geometry_path, file.is_gold);
  if (!geometry) return;
  for (const Variable& variable : file.variables) {
    if (variable.has_file_set) continue;
    const std::string variable_path = file_of_step(file, variable, path, time);
    if (!variable_path.empty()) walk_variable(variable_path, variable, *geometry);
  }
}

}  // namespace tetravox::io
