#include "src/io/collections.h"
#include "src/io/reader/blocks.h"
#include "src/io/reader/file_checks.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace tetravox::io {

namespace {

constexpr std::string_view kBlanks = " \t\r\n";

/// The value of an attribute of an XML tag; empty where it has none.
std::string_view attribute(std::string_view tag, std::string_view name) {
  for (std::size_t at = 0; (at = tag.find(name, at)) != std::string_view::npos; at += name.size()) {
    const std::size_t equals = at + name.size();
    if (at == 0 || kBlanks.find(tag[at - 1]) == std::string_view::npos) continue;
    if (equals + 1 >= tag.size() || tag[equals] != '=') continue;
    const std::size_t end = tag.find(tag[equals + 1], equals + 2);
    if (end != std::string_view::npos) return tag.substr(equals + 2, end - equals - 2);
  }
  return {};
}

std::optional<std::uint64_t> parse_count(std::string_view text) {
  while (!text.empty() && kBlanks.find(text.front()) != std::string_view::npos) text.remove_prefix(1);
  std::uint64_t value = 0;
  if (std::from_chars(text.data(), text.data() + text.size(), value).ec != std::errc()) return std::nullopt;
  return value;
}

/// How numbers are stored in this file.
struct Encoding {
  std::size_t header_size = 4;
  bool is_big_endian = false;
  bool is_compressed = false;
  bool is_appended_raw = false;
  std::string_view appended;  ///< between the underscore and the closing tag
};

/// Bytes of the numbers of this XML type; 0 for types without a fixed size.
std::size_t size_of_type(std::string_view type) {
  if (type.ends_with("8")) return 1;
  if (type.ends_with("16")) return 2;
  if (type.ends_with("32")) return 4;
  if (type.ends_with("64")) return 8;
  return 0;
}

/// Numbers in text, up to the first that VTK could not read.
std::uint64_t count_text_values(std::string_view text) {
  std::uint64_t count = 0;
  for (std::size_t at = 0; (at = text.find_first_not_of(kBlanks, at)) != std::string_view::npos; ++count) {
    if (std::string_view("0123456789+-.").find(text[at]) == std::string_view::npos) break;
    at = text.find_first_of(kBlanks, at);
    if (at == std::string_view::npos) return count + 1;
  }
  return count;
}

/// The first `count` bytes of base64 text; fewer where it ends earlier.
std::string decode_base64(std::string_view text, std::size_t count) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    if (kBlanks.find(c) != std::string_view::npos) continue;
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos || out.size() >= count) break;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    bit_count += 6;
    if (bit_count >= 8) out += static_cast<char>(bits >> (bit_count -= 8) & 0xFF);
  }
  return out;
}

/// What the header of a binary array says. Headers: a byte count, or for compressed arrays the number of blocks, the
/// size of a block, the size of the last (0: as the others), and the compressed size of each block.
struct ArrayHeader {
  std::uint64_t value_bytes = 0;   ///< of the array's values
  std::uint64_t stored_bytes = 0;  ///< in the file, headers included
};

ArrayHeader parse_header(std::string_view bytes, const Encoding& encoding, const std::string& path) {
  const auto number = [&](std::uint64_t index) {
    const std::size_t size = encoding.header_size;
    if (bytes.size() < size || index > bytes.size() / size - 1) fail_file(path, "an array ends before its data begin");
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i)
      value =
          value << 8 | static_cast<unsigned char>(bytes[index * size + (encoding.is_big_endian ? i : size - 1 - i)]);
    return value;
  };
  const std::uint64_t first = number(0);
  if (!encoding.is_compressed) return {first, first + encoding.header_size};
  if (first == 0) return {0, encoding.header_size};
  if (first > bytes.size()) fail_file(path, "an array of too many compressed blocks");
  const std::uint64_t block = number(1), last = number(2);
  ArrayHeader header;
  header.stored_bytes = (3 + first) * encoding.header_size;
  for (std::uint64_t i = 0; i < first; ++i) {
    const std::uint64_t bytes_of_block = number(3 + i);
    if (bytes_of_block > (std::uint64_t{1} << 56)) fail_file(path, "a compressed block makes no sense");
    header.stored_bytes += bytes_of_block;
  }
  if (__builtin_mul_overflow(last == 0 ? first : first - 1, block, &header.value_bytes) ||
      __builtin_add_overflow(header.value_bytes, last, &header.value_bytes))
    fail_file(path, "a compressed block makes no sense");
  return header;
}

/// Bytes of an array's values as its header says, after checking that they are in the file.
std::uint64_t count_binary_bytes(std::string_view tag, std::string_view content, const Encoding& encoding,
                                 const std::string& path) {
  if (attribute(tag, "format") == "binary") {
    // A compressed array's header tells its own length.
    const Encoding plain{encoding.header_size, encoding.is_big_endian, false, false, {}};
    const std::uint64_t first = parse_header(decode_base64(content, encoding.header_size), plain, path).value_bytes;
    if (!encoding.is_compressed) return first;
    if (first > content.size()) fail_file(path, "an array of too many compressed blocks");
    return parse_header(decode_base64(content, (3 + first) * encoding.header_size), encoding, path).value_bytes;
  }
  const auto offset = parse_count(attribute(tag, "offset"));
  if (!offset || *offset >= encoding.appended.size())
    fail_file(path, "an array lies behind the end of the appended data");
  const std::string_view stored = encoding.appended.substr(*offset);
  if (!encoding.is_appended_raw) return count_binary_bytes("<DataArray format=\"binary\"", stored, encoding, path);
  const ArrayHeader header = parse_header(stored, encoding, path);
  if (header.stored_bytes > stored.size()) fail_file(path, "an array ends behind the end of the appended data");
  return header.value_bytes;
}

/// A piece's numbers, and the section that is being walked through.
struct Place {
  std::uint64_t points = 0, cells = 0;
  std::array<std::uint64_t, 3> axes{};
  std::size_t next_axis = 0;
  std::string_view section;
};

/// Values that an array here must have; empty where any number will do.
std::optional<std::uint64_t> expected_values(std::string_view tag, Place& place) {
  const std::uint64_t components = parse_count(attribute(tag, "NumberOfComponents")).value_or(1);
  if (place.section == "PointData") return place.points * components;
  if (place.section == "CellData") return place.cells * components;
  if (place.section == "Points") return place.points * 3;
  if (place.section == "Coordinates" && place.next_axis < 3) return place.axes[place.next_axis++];
  const std::string_view name = attribute(tag, "Name");
  if (place.section == "Cells" && (name == "types" || name == "offsets")) return place.cells;
  return std::nullopt;
}

void check_array(std::string_view tag, std::string_view content, const Encoding& encoding, Place& place,
                 const std::string& path) {
  const std::optional<std::uint64_t> expected = expected_values(tag, place);
  if (place.section == "Points" && parse_count(attribute(tag, "NumberOfComponents")).value_or(3) != 3)
    fail_file(path, "its points have other than three coordinates");
  const std::string_view format = attribute(tag, "format");
  const std::size_t size = size_of_type(attribute(tag, "type"));
  if (!expected || size == 0) return;
  std::uint64_t values = 0;
  if (format == "appended" || format == "binary")
    values = count_binary_bytes(tag, content, encoding, path) / size;
  else
    values = count_text_values(content);
  if (values != *expected)
    fail_file(path, "array '" + std::string(attribute(tag, "Name")) + "' in " + std::string(place.section) + " has " +
                        std::to_string(values) + " values instead of " + std::to_string(*expected));
}

void begin_piece(std::string_view tag, Place& place, std::uint64_t& all_cells, const std::string& path) {
  place = {};
  if (const std::string_view extent = attribute(tag, "Extent"); !extent.empty()) {
    all_cells += count_extent_cells(std::string(extent), path, &place.axes);
    place.points = place.axes[0] * place.axes[1] * place.axes[2];
    // An axis of one point has no cells of its own; VTK counts the others.
    place.cells = 1;
    for (const std::uint64_t points : place.axes) place.cells *= std::max<std::uint64_t>(points - 1, 1);
    return;
  }
  const auto points = parse_count(attribute(tag, "NumberOfPoints")),
             cells = parse_count(attribute(tag, "NumberOfCells"));
  if (!points || !cells) fail_file(path, "a piece does not say how many points and cells it has");
  constexpr std::uint64_t kMost = std::uint64_t{1} << 48;
  if (*points > kMost || *cells > kMost) fail_file(path, "a piece promises more than a file could hold");
  place.points = *points;
  place.cells = *cells;
}

Encoding find_encoding(std::string_view text, std::size_t appended, const std::string& path) {
  const std::size_t root = text.find("<VTKFile");
  if (root == std::string_view::npos) fail_file(path, "no VTKFile element");
  const std::string_view tag = text.substr(root, text.find('>', root) - root);
  Encoding encoding;
  encoding.header_size = attribute(tag, "header_type") == "UInt64" ? 8 : 4;
  encoding.is_big_endian = attribute(tag, "byte_order") == "BigEndian";
  encoding.is_compressed = !attribute(tag, "compressor").empty();
  if (appended == std::string_view::npos) return encoding;
  const std::size_t tag_end = text.find('>', appended);
  const std::size_t begin = tag_end == std::string_view::npos ? tag_end : text.find('_', tag_end);
  const std::size_t end = text.rfind("</AppendedData");
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin ||
      text.rfind("</VTKFile") == std::string_view::npos)
    fail_file(path, "it ends before its appended data do");
  encoding.is_appended_raw = attribute(text.substr(appended, tag_end - appended), "encoding") == "raw";
  encoding.appended = text.substr(begin + 1, end - begin - 1);
  return encoding;
}

}  // namespace

void check_xml_arrays(const std::string& path) {
  const MappedFile file(path);
  const std::size_t appended = file.text().find("<AppendedData");
  const Encoding encoding = find_encoding(file.text(), appended, path);
  const std::string_view text = file.text().substr(0, appended);
  Place place;
  std::uint64_t all_cells = 0;
  std::optional<std::uint64_t> whole_cells;
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string_view::npos;) {
    const std::size_t end = text.find('>', at);
    if (end == std::string_view::npos) break;  // VTK's parser will say what is wrong.
    const std::string_view tag = text.substr(at, end - at);
    const std::string_view name = tag.substr(1, tag.find_first_of(" \t\r\n/>", 2) - 1);
    at = end + 1;
    if (const std::string_view whole = attribute(tag, "WholeExtent"); !whole.empty())
      whole_cells = count_extent_cells(std::string(whole), path);
    if (name == "Piece") begin_piece(tag, place, all_cells, path);
    if (name == "FieldData" || name == "PointData" || name == "CellData" || name == "Points" || name == "Cells" ||
        name == "Coordinates")
      place.section = name;
    if (name == "DataArray") check_array(tag, text.substr(at, text.find('<', at) - at), encoding, place, path);
  }
  if (whole_cells && *whole_cells != all_cells)
    fail_file(path, "its pieces have " + std::to_string(all_cells) + " cells, and its whole extent " +
                        std::to_string(*whole_cells));
}

}  // namespace tetravox::io
