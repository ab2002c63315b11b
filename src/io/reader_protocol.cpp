#include "src/io/reader_protocol.h"

#include <charconv>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string_view>

namespace tetravox::io {

namespace {

constexpr const char* kVersionArgument = "protocol=3";

std::string format_double(double value) {
  char buffer[64];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value);
  return std::string(buffer, end.ptr);
}

template <class Number>
Number parse_number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw Error(ErrorCode::kInternal, "tetravox-reader: an argument is not a number: " + std::string(text));
  return value;
}

Association association_from_text(std::string_view text) {
  return text == "cell" ? Association::kCell : Association::kPoint;
}

/// The further array that was begun last.
ArrayRequest& last_other(ReadOptions& options) {
  if (options.others.empty()) throw Error(ErrorCode::kInternal, "tetravox-reader: an argument is out of order");
  return options.others.back();
}

void set_request_value(ReaderRequest& request, std::string_view key, std::string_view value) {
  ReadOptions& options = request.options;
  if (key == "file")
    request.file = value;
  else if (key == "parent")
    request.parent = parse_number<std::int64_t>(value);
  else if (key == "array")
    options.array.name = value;
  else if (key == "association")
    options.array.association = association_from_text(value);
  else if (key == "component")
    options.array.component = parse_number<int>(value);
  else if (key == "other")
    options.others.emplace_back().name = value;
  else if (key == "other_association")
    last_other(options).association = association_from_text(value);
  else if (key == "other_component")
    last_other(options).component = parse_number<int>(value);
  else if (key == "time_index")
    options.time.index = parse_number<std::size_t>(value);
  else if (key == "time_value")
    options.time.value = parse_number<double>(value);
  else if (key == "grid_file")
    options.grid_file = value;
  else if (key == "memory_limit")
    options.memory_limit = parse_number<std::uint64_t>(value);
  else if (key == "only_info")
    options.only_info = value == "1";
  else
    throw Error(ErrorCode::kInternal, "tetravox-reader: unknown argument: " + std::string(key));
}

/// Appends values to a growing string of bytes.
class ByteWriter {
 public:
  void put(std::uint64_t value) { put_bytes(&value, sizeof value); }
  void put(double value) { put_bytes(&value, sizeof value); }
  void put(const std::string& text) {
    put(std::uint64_t{text.size()});
    put_bytes(text.data(), text.size());
  }
  void put(const ValueRange& range) {
    put(range.min);
    put(range.max);
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  void put_bytes(const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  std::vector<std::byte> bytes_;
};

/// Takes values off a span of bytes, never past its end.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  std::uint64_t number() { return value<std::uint64_t>(); }
  double real() { return value<double>(); }
  ValueRange range() {
    const double low = real();
    return {low, real()};
  }
  std::string text() {
    const std::span<const std::byte> part = take(number());
    return std::string(reinterpret_cast<const char*>(part.data()), part.size());
  }
  /// A count of things that take at least `least_bytes` each.
  std::size_t count(std::size_t least_bytes) {
    const std::uint64_t n = number();
    if (n > bytes_.size() / least_bytes) throw std::out_of_range("a count exceeds the description");
    return n;
  }

 private:
  template <class T>
  T value() {
    T result;
    std::memcpy(&result, take(sizeof(T)).data(), sizeof(T));
    return result;
  }
  std::span<const std::byte> take(std::uint64_t size) {
    if (size > bytes_.size()) throw std::out_of_range("the description ends too early");
    const auto part = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return part;
  }
  std::span<const std::byte> bytes_;
};

void put_array(ByteWriter& out, const ArrayInfo& array) {
  out.put(array.name);
  out.put(static_cast<std::uint64_t>(array.association));
  out.put(array.type);
  out.put(std::uint64_t{array.component_ranges.size()});
  for (const ValueRange& range : array.component_ranges) out.put(range);
  out.put(array.magnitude_range);
  out.put(array.nan_count);
}

Association to_association(std::uint64_t number) {
  if (number > 1) throw std::out_of_range("an association is unknown");
  return static_cast<Association>(number);
}

ArrayInfo take_array(ByteReader& in) {
  ArrayInfo array;
  array.name = in.text();
  array.association = to_association(in.number());
  array.type = in.text();
  array.component_ranges.resize(in.count(sizeof(ValueRange)));
  for (ValueRange& range : array.component_ranges) range = in.range();
  array.components = static_cast<int>(array.component_ranges.size());
  array.magnitude_range = in.range();
  array.nan_count = in.number();
  return array;
}

void put_shape(ByteWriter& out, const GridShape& shape) {
  for (const std::uint32_t count : shape.dimensions) out.put(std::uint64_t{count});
  for (const double value : shape.origin) out.put(value);
  for (const double value : shape.spacing) out.put(value);
  for (const double value : shape.direction) out.put(value);
  for (const std::vector<double>& axis : shape.coordinates) {
    out.put(std::uint64_t{axis.size()});
    for (const double value : axis) out.put(value);
  }
}

GridShape take_shape(ByteReader& in) {
  GridShape shape;
  for (std::uint32_t& count : shape.dimensions) {
    const std::uint64_t number = in.number();
    if (number > std::numeric_limits<std::uint32_t>::max()) throw std::out_of_range("a dimension is too large");
    count = static_cast<std::uint32_t>(number);
  }
  for (double& value : shape.origin) value = in.real();
  for (double& value : shape.spacing) value = in.real();
  for (double& value : shape.direction) value = in.real();
  for (std::vector<double>& axis : shape.coordinates) {
    axis.resize(in.count(sizeof(double)));
    for (double& value : axis) value = in.real();
  }
  return shape;
}

void put_info(ByteWriter& out, const DatasetInfo& info) {
  out.put(info.source);
  out.put(info.format);
  out.put(info.point_count);
  out.put(info.cell_count);
  out.put(info.block_count);
  out.put(std::uint64_t{info.cells_by_type.size()});
  for (const auto& [type, count] : info.cells_by_type) {
    out.put(static_cast<std::uint64_t>(type));
    out.put(count);
  }
  out.put(info.left_out.lower_dimension);
  out.put(info.left_out.ghost);
  out.put(info.left_out.blanked);
  out.put(info.left_out.unsupported);
  out.put(std::uint64_t{info.arrays.size()});
  for (const ArrayInfo& array : info.arrays) put_array(out, array);
  for (const ValueRange& range : info.bounds) out.put(range);
  out.put(std::uint64_t{info.times.size()});
  for (double time : info.times) out.put(time);
  out.put(std::uint64_t{info.time_index});
  out.put(std::uint64_t{info.notes.size()});
  for (const std::string& note : info.notes) out.put(note);
  out.put(std::uint64_t{info.grid.has_value()});
  if (info.grid) put_shape(out, *info.grid);
}

DatasetInfo take_info(ByteReader& in) {
  DatasetInfo info;
  info.source = in.text();
  info.format = in.text();
  info.point_count = in.number();
  info.cell_count = in.number();
  info.block_count = in.number();
  for (std::size_t i = 0, n = in.count(16); i < n; ++i) {
    const std::uint64_t type = in.number();
    if (type > std::numeric_limits<std::uint8_t>::max()) throw std::out_of_range("a cell type is unknown");
    info.cells_by_type.emplace_back(static_cast<CellType>(type), in.number());
  }
  info.left_out.lower_dimension = in.number();
  info.left_out.ghost = in.number();
  info.left_out.blanked = in.number();
  info.left_out.unsupported = in.number();
  for (std::size_t i = 0, n = in.count(56); i < n; ++i) info.arrays.push_back(take_array(in));
  for (ValueRange& range : info.bounds) range = in.range();
  for (std::size_t i = 0, n = in.count(8); i < n; ++i) info.times.push_back(in.real());
  info.time_index = in.number();
  for (std::size_t i = 0, n = in.count(8); i < n; ++i) info.notes.push_back(in.text());
  if (in.number() != 0) info.grid = take_shape(in);
  return info;
}

void put_field(ByteWriter& out, const FieldDescription& field) {
  out.put(field.array_name);
  out.put(static_cast<std::uint64_t>(field.component + 1));  // kMagnitude is -1
  out.put(static_cast<std::uint64_t>(field.type));
  out.put(static_cast<std::uint64_t>(field.components));
}

FieldDescription take_field(ByteReader& in) {
  FieldDescription field;
  field.array_name = in.text();
  field.component = static_cast<int>(in.number()) - 1;
  const std::uint64_t type = in.number();
  if (type > static_cast<std::uint64_t>(ScalarType::kFloat64)) throw std::out_of_range("a number type is unknown");
  field.type = static_cast<ScalarType>(type);
  field.components = static_cast<int>(in.number());
  return field;
}

/// Appends the arguments for one array; `prefix` begins the keys that belong to its `key`.
void put_array_request(const std::string& key, const std::string& prefix, const ArrayRequest& array,
                       std::vector<std::string>& out) {
  if (!array.name.empty()) out.push_back(key + "=" + array.name);
  if (array.association)
    out.push_back(prefix + (*array.association == Association::kCell ? "association=cell" : "association=point"));
  if (array.component) out.push_back(prefix + "component=" + std::to_string(*array.component));
}

/// Bytes of the UTF-8 character that starts at `i`; 0 where there is none.
std::size_t utf8_length(const std::string& text, std::size_t i) {
  const auto first = static_cast<unsigned char>(text[i]);
  const std::size_t length = first < 0x80 ? 1 : first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC2 ? 2 : 0;
  if (length == 0 || first > 0xF4 || i + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((static_cast<unsigned char>(text[i + k]) & 0xC0) != 0x80) return 0;
  const auto second = length > 1 ? static_cast<unsigned char>(text[i + 1]) : 0;
  // Reject overlong forms, surrogates and numbers beyond Unicode.
  const bool is_bad = (first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
                      (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F);
  return is_bad ? 0 : length;
}

}  // namespace

std::vector<std::string> format_request(const ReaderRequest& request) {
  const ReadOptions& options = request.options;
  std::vector<std::string> out{kVersionArgument, "file=" + request.file, "parent=" + std::to_string(request.parent)};
  put_array_request("array", "", options.array, out);
  for (const ArrayRequest& other : options.others) put_array_request("other", "other_", other, out);
  if (options.time.index) out.push_back("time_index=" + std::to_string(*options.time.index));
  if (options.time.value) out.push_back("time_value=" + format_double(*options.time.value));
  if (!options.grid_file.empty()) out.push_back("grid_file=" + options.grid_file);
  out.push_back("memory_limit=" + std::to_string(options.memory_limit));
  if (options.only_info) out.emplace_back("only_info=1");
  return out;
}

ReaderRequest parse_request(std::span<const char* const> arguments) {
  if (arguments.empty() || std::string_view(arguments[0]) != kVersionArgument)
    throw Error(ErrorCode::kInternal, "tetravox-reader is started by tetravox, not by hand; or their versions differ");
  ReaderRequest request;
  for (const std::string_view argument : arguments.subspan(1)) {
    const std::size_t equals = argument.find('=');
    if (equals == std::string_view::npos)
      throw Error(ErrorCode::kInternal, "tetravox-reader: argument without a value: " + std::string(argument));
    set_request_value(request, argument.substr(0, equals), argument.substr(equals + 1));
  }
  if (request.file.empty()) throw Error(ErrorCode::kInternal, "tetravox-reader: no file was named");
  return request;
}

std::vector<std::byte> encode_description(const Description& description) {
  ByteWriter out;
  put_info(out, description.info);
  out.put(static_cast<std::uint64_t>(description.association));
  put_field(out, description.field);
  out.put(std::uint64_t{description.others.size()});
  for (const FieldDescription& other : description.others) put_field(out, other);
  return out.take();
}

Description decode_description(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  Description description;
  description.info = take_info(in);
  description.association = to_association(in.number());
  description.field = take_field(in);
  for (std::size_t i = 0, n = in.count(32); i < n; ++i) description.others.push_back(take_field(in));
  if (description.others.size() > kMostOtherArrays) throw std::out_of_range("there are too many fields");
  return description;
}

std::string clean_line(const std::string& text, std::size_t longest) {
  std::string out;
  for (std::size_t i = 0; i < text.size() && out.size() < longest;) {
    const std::size_t length = utf8_length(text, i);
    if (length == 0) {
      out += '?';
    } else if (static_cast<unsigned char>(text[i]) <= 0x20 || text[i] == 0x7F) {
      if (!out.empty() && out.back() != ' ') out += ' ';
    } else if (out.size() + length > longest) {
      break;
    } else {
      out.append(text, i, length);
    }
    i += length == 0 ? 1 : length;
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

}  // namespace tetravox::io
