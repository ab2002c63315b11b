// AVS UCD. VTK's reader takes zeros where a text file ends too early, and trusts labels and ids: the text is checked
// first, token by token.

#include "src/io/reader/blocks.h"
#include "src/io/reader/file_checks.h"

#include <vtkAVSucdReader.h>
#include <vtkNew.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <string_view>
#include <utility>

namespace tetravox::io {

namespace {

/// VTK keeps labels in 128 bytes.
constexpr std::size_t kLongestLabel = 120;

/// Walks through the text of a UCD file; every complaint says where it is.
class UcdText {
 public:
  UcdText(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  std::string_view word(const char* what) {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    if (begin == at_) fail_file(path_, std::string("it ends before ") + what);
    return text_.substr(begin, at_ - begin);
  }

  long long integer(const char* what) { return number<long long>(what); }
  double real(const char* what) { return number<double>(what); }

  /// A count, of things that each take at least `least_bytes` of what is left.
  std::size_t count(const char* what, std::size_t least_bytes) {
    const long long value = integer(what);
    if (value < 0 || static_cast<unsigned long long>(value) > (text_.size() - at_) / least_bytes + 1)
      fail_file(path_, std::string("the ") + what + ", " + std::to_string(value) + ", does not fit the file's size");
    return static_cast<std::size_t>(value);
  }

  void skip_comments() {
    for (;;) {
      while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
      if (at_ >= text_.size() || text_[at_] != '#') return;
      skip_line();
    }
  }

  void skip_line() {
    at_ = text_.find('\n', at_);
    at_ = at_ == std::string_view::npos ? text_.size() : at_ + 1;
  }

  /// A label line, "name, unit".
  void check_label() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    const std::size_t comma = text_.substr(at_, end - at_).find(',');
    if (comma == std::string_view::npos || comma > kLongestLabel || end - at_ - comma > kLongestLabel)
      fail_file(path_, "a label of its data is not of the form 'name, unit'");
    skip_line();
  }

 private:
  template <class Number>
  Number number(const char* what) {
    std::string_view token = word(what);
    if (token.starts_with('+')) token.remove_prefix(1);
    Number value{};
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    // A number beyond double's range is still a number; VTK reads it as it likes.
    if ((error != std::errc() && error != std::errc::result_out_of_range) || end != token.data() + token.size())
      fail_file(path_, std::string("'") + std::string(token.substr(0, 40)) + "' stands in place of " + what);
    return value;
  }

  std::string_view text_;
  const std::string& path_;
  std::size_t at_ = 0;
};

int corners_of(std::string_view type, const std::string& path) {
  constexpr std::array<std::pair<std::string_view, int>, 8> kTypes{
      {{"pt", 1}, {"line", 2}, {"tri", 3}, {"quad", 4}, {"tet", 4}, {"pyr", 5}, {"prism", 6}, {"hex", 8}}};
  for (const auto& [name, corners] : kTypes)
    if (name == type) return corners;
  fail_file(path, "unknown cell type '" + std::string(type.substr(0, 40)) + "'");
}

void check_values(UcdText& text, std::size_t tuples, std::size_t values, const std::string& path) {
  const std::size_t arrays = text.count("number of arrays", 2);
  std::size_t sum = 0;
  for (std::size_t i = 0; i < arrays; ++i) sum += text.count("number of components", 1);
  if (sum != values)
    fail_file(path,
              "its arrays have " + std::to_string(sum) + " components, and its header says " + std::to_string(values));
  text.skip_line();
  for (std::size_t i = 0; i < arrays; ++i) text.check_label();
  for (std::size_t i = 0; i < tuples; ++i) {
    text.integer("an id in its data");
    for (std::size_t k = 0; k < values; ++k) text.real("a value");
  }
}

void check_text(std::string_view content, const std::string& path) {
  UcdText text(content, path);
  text.skip_comments();
  const std::size_t nodes = text.count("number of nodes", 8);
  const std::size_t cells = text.count("number of cells", 8);
  const std::size_t node_values = text.count("number of node values", 2);
  const std::size_t cell_values = text.count("number of cell values", 2);
  text.integer("the number of model values");
  long long first_id = 1;
  for (std::size_t i = 0; i < nodes; ++i) {
    const long long id = text.integer("a node id");
    if (i == 0) first_id = id == 0 ? 0 : 1;
    if (id != static_cast<long long>(i) + first_id)
      throw Error(ErrorCode::kUnsupported,
                  "'" + path + "': node " + std::to_string(i) + " has id " + std::to_string(id) +
                      ", and only ids that count up from 0 or 1 can be read: renumber the nodes");
    for (int axis = 0; axis < 3; ++axis) text.real("a coordinate");
  }
  for (std::size_t i = 0; i < cells; ++i) {
    text.integer("a cell id");
    text.integer("a material id");
    const int corners = corners_of(text.word("a cell type"), path);
    for (int k = 0; k < corners; ++k) {
      const long long id = text.integer("a node id of a cell") - first_id;
      if (id < 0 || id >= static_cast<long long>(nodes))
        fail_file(path, "cell " + std::to_string(i) + " names a node that does not exist");
    }
  }
  if (node_values > 0) check_values(text, nodes, node_values, path);
  if (cell_values > 0) check_values(text, cells, cell_values, path);
}

}  // namespace

FileContents read_ucd(const std::string& path) {
  constexpr char kBinaryMagic = 7;
  const std::string text = read_whole_file(path);
  if (!text.starts_with(kBinaryMagic)) check_text(text, path);
  const vtkNew<vtkAVSucdReader> reader;
  reader->SetFileName(path.c_str());
  FileContents contents;
  update_reader(*reader, path, {}, contents);
  vtkUnstructuredGrid* grid = reader->GetOutput();
  if (grid->GetNumberOfCells() != reader->GetNumberOfCells() || grid->GetNumberOfPoints() != reader->GetNumberOfNodes())
    fail_file(path, "its header promises other numbers of nodes and cells than came");
  append_blocks(grid, contents);
  return contents;
}

}  // namespace tetravox::io
