#include "src/io/npy_file.h"

#include "tetravox/error.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

namespace tetravox::io {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are taken as they stand");

constexpr std::size_t kLargestDictionary = 65536;  // bytes
constexpr std::size_t kMostAxes = 8;

/// Whatever stands in the header, and where the numbers begin.
struct Header {
  std::string type;
  bool is_fortran_order = false;
  std::vector<std::size_t> shape;
};

/// Reads the Python dictionary of the header: names, strings, booleans and one tuple, in any order.
class DictionaryReader {
 public:
  DictionaryReader(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  Header read() {
    Header header;
    bool has_type = false, has_order = false, has_shape = false;
    expect('{');
    while (!accept('}')) {
      const std::string key = read_string();
      expect(':');
      bool& is_known = key == "descr" ? has_type : key == "fortran_order" ? has_order : has_shape;
      if (is_known || (key != "descr" && key != "fortran_order" && key != "shape")) fail();
      is_known = true;
      if (key == "descr") header.type = read_string();
      if (key == "fortran_order") header.is_fortran_order = read_boolean();
      if (key == "shape") header.shape = read_shape();
      if (!accept(',')) {
        expect('}');
        break;
      }
    }
    if (!has_type || !has_order || !has_shape) fail();
    return header;
  }

 private:
  [[noreturn]] void fail() const {
    throw Error(ErrorCode::kBadFile, "'" + path_ + "': the header of this .npy file is damaged");
  }
  void skip_blanks() {
    while (!text_.empty() && (text_[0] == ' ' || text_[0] == '\n' || text_[0] == '\t')) text_.remove_prefix(1);
  }
  bool accept(char symbol) {
    skip_blanks();
    if (text_.empty() || text_[0] != symbol) return false;
    text_.remove_prefix(1);
    return true;
  }
  void expect(char symbol) {
    if (!accept(symbol)) fail();
  }
  std::string read_string() {
    skip_blanks();
    const char quote = accept('\'') ? '\'' : '"';
    if (quote == '"') expect('"');
    const std::size_t end = text_.find(quote);
    if (end == std::string_view::npos || end > 64) fail();
    const std::string result(text_.substr(0, end));
    text_.remove_prefix(end + 1);
    return result;
  }
  bool read_boolean() {
    skip_blanks();
    for (const std::string_view word : {"True", "False"}) {
      if (!text_.starts_with(word)) continue;
      text_.remove_prefix(word.size());
      return word == "True";
    }
    fail();
  }
  std::vector<std::size_t> read_shape() {
    std::vector<std::size_t> shape;
    expect('(');
    while (!accept(')')) {
      std::size_t length = 0;
      skip_blanks();
      const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), length);
      if (error != std::errc() || shape.size() == kMostAxes) fail();
      text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
      shape.push_back(length);
      if (!accept(',')) {
        expect(')');
        break;
      }
    }
    return shape;
  }

  std::string_view text_;
  const std::string& path_;
};

Header read_header(std::ifstream& file, const std::string& path) {
  const Error not_npy(ErrorCode::kBadFile, "'" + path + "' is not an .npy file, or a damaged one");
  char start[8];
  if (!file.read(start, sizeof start) || std::memcmp(start, "\x93NUMPY", 6) != 0 || start[6] < 1 || start[6] > 3)
    throw not_npy;
  unsigned char length_bytes[4] = {};
  if (!file.read(reinterpret_cast<char*>(length_bytes), start[6] == 1 ? 2 : 4)) throw not_npy;
  std::size_t length = 0;
  for (int i = 3; i >= 0; --i) length = length << 8 | length_bytes[i];
  if (length > kLargestDictionary) throw not_npy;
  std::string dictionary(length, '\0');
  if (!file.read(dictionary.data(), static_cast<std::streamsize>(length))) throw not_npy;
  return DictionaryReader(dictionary, path).read();
}

template <class T>
std::vector<float> read_numbers(std::ifstream& file, std::size_t count, const std::string& path) {
  std::vector<T> numbers(count);
  if (!file.read(reinterpret_cast<char*>(numbers.data()), static_cast<std::streamsize>(count * sizeof(T))))
    throw Error(ErrorCode::kBadFile, "'" + path + "' cannot be read to its end");
  std::vector<float> values(count);
  std::transform(numbers.begin(), numbers.end(), values.begin(), [](T number) { return static_cast<float>(number); });
  return values;
}

/// How many numbers the shape holds. @throws Error where they are too many.
std::size_t count_numbers(const Header& header, std::size_t largest, const std::string& path) {
  std::size_t count = 1;
  for (const std::size_t length : header.shape)
    if (__builtin_mul_overflow(count, length, &count)) count = largest + 1;
  if (count > largest)
    throw Error(ErrorCode::kUnsupported,
                "'" + path + "' holds more than the " + std::to_string(largest) + " numbers that can be used");
  return count;
}

}  // namespace

NpyArray read_npy(const std::string& path, std::size_t largest) {
  std::error_code error;
  const std::uintmax_t file_bytes = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file)
    throw Error(ErrorCode::kFileNotFound, "cannot open '" + path + "': no such file, or it may not be read");
  const Header header = read_header(file, path);
  if (header.is_fortran_order)
    throw Error(ErrorCode::kUnsupported, "'" + path + "' is in Fortran order: save numpy.ascontiguousarray of it");
  const std::size_t count = count_numbers(header, largest, path);
  const bool is_bytes = header.type == "|u1", is_float = header.type == "<f4", is_double = header.type == "<f8";
  if (!is_bytes && !is_float && !is_double)
    throw Error(ErrorCode::kUnsupported, "'" + path + "' holds numbers of type '" + header.type.substr(0, 16) +
                                             "': save float32, float64 or uint8, little-endian");
  const std::size_t bytes = count * (is_bytes ? 1 : is_float ? 4 : 8), begin = static_cast<std::size_t>(file.tellg());
  if (file_bytes != begin + bytes)
    throw Error(ErrorCode::kBadFile, "'" + path + "' has " + std::to_string(file_bytes) +
                                         " bytes where its shape needs " + std::to_string(begin + bytes));
  NpyArray array{header.shape, {}, is_bytes};
  if (is_bytes) array.values = read_numbers<std::uint8_t>(file, count, path);
  if (is_float) array.values = read_numbers<float>(file, count, path);
  if (is_double) array.values = read_numbers<double>(file, count, path);
  return array;
}

}  // namespace tetravox::io
