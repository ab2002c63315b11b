#pragma once

/// What the library and the reader process say to each other.
///
/// The parent starts `tetravox-reader protocol=1 key=value ...` with two descriptors: a pipe for one-line messages
/// ("progress 0.25", "complaint TEXT", "error CODE TEXT", "done") and a memory file. The reader lays its arrays out in
/// the memory file behind a `SharedHeader` and leaves; only then the parent seals, maps and validates it.

#include "tetravox/dataset.h"
#include "tetravox/error.h"
#include "tetravox/io.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tetravox::io {

inline constexpr int kStatusDescriptor = 3;  ///< messages, written by the reader
inline constexpr int kDataDescriptor = 4;    ///< memory file, written by the reader
inline constexpr std::size_t kLongestMessage = 2000;

/// What the reader is asked for. `options.timeout` stays with the parent.
struct ReaderRequest {
  std::string file;
  ReadOptions options;
  std::int64_t parent = 0;  ///< process id of the one who asks
};

/// The request as command line arguments, and back.
/// @throws Error (kInternal) for arguments of another version or without a file.
std::vector<std::string> format_request(const ReaderRequest& request);
ReaderRequest parse_request(std::span<const char* const> arguments);

/// A piece of the memory file, bytes from its beginning.
struct Section {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
};

/// Begins the memory file. Sections start on multiples of 64 bytes.
struct SharedHeader {
  std::uint64_t magic = 0;
  std::uint64_t total_bytes = 0;
  Section points;        ///< double [points][3]
  Section cell_types;    ///< CellType [cells]
  Section cell_offsets;  ///< uint64 [cells + 1]
  Section connectivity;  ///< uint32
  Section scalars;       ///< double
  Section values;        ///< of a grid, which has nothing else: see `GridData`
  /// Of further fields, as `scalars` or `values`; those of one array may be one section.
  std::array<Section, kMostOtherArrays> others;
  Section description;  ///< see `encode_description`
};
inline constexpr std::uint64_t kSharedMagic = 0x32'58'56'54'52'54'45'54ull;

/// A field that is handed over.
struct FieldDescription {
  std::string array_name;
  int component = 0;
  ScalarType type = ScalarType::kFloat64;  ///< of a grid's values
  int components = 1;                      ///< of a grid's values
};

/// Everything that is not an array.
struct Description {
  DatasetInfo info;
  Association association = Association::kPoint;  ///< of all fields
  FieldDescription field;
  std::vector<FieldDescription> others;
};

/// The description as bytes, and back.
/// @throws std::out_of_range where the bytes end too early or a count makes no sense.
std::vector<std::byte> encode_description(const Description& description);
Description decode_description(std::span<const std::byte> bytes);

/// The text on one line: control characters and runs of blanks become one blank, invalid UTF-8 becomes '?', and what
/// exceeds `longest` bytes is cut off.
std::string clean_line(const std::string& text, std::size_t longest = kLongestMessage);

}  // namespace tetravox::io
