#include "src/io/reader/file_checks.h"

#include "src/io/reader/blocks.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

namespace tetravox::io {

namespace {

/// Takes big-endian numbers off the header of a netCDF classic file (netCDF Users Guide, "File Format Specification").
class NetcdfHeader {
 public:
  NetcdfHeader(std::string_view bytes, const std::string& path)
      : bytes_(bytes), path_(path), count_size_(bytes[3] == 5 ? 8 : 4), offset_size_(bytes[3] == 1 ? 4 : 8) {
    skip(4);
  }

  std::uint64_t count() { return number(count_size_); }
  std::uint64_t offset() { return number(offset_size_); }
  std::uint64_t tag() { return number(4); }
  void skip(std::uint64_t size) {
    if (size > bytes_.size() - at_) fail_file(path_, "its header ends too early");
    at_ += size;
  }
  void skip_name() { skip(padded(count())); }
  void skip_attributes() {
    tag();
    for (std::uint64_t i = 0, n = count(); i < n; ++i) {
      skip_name();
      const std::uint64_t size = size_of_type(tag());
      skip(padded(checked_product(count(), size)));
    }
  }
  std::uint64_t size_of_type(std::uint64_t type) {
    constexpr std::uint64_t kSizes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    if (type < 1 || type >= std::size(kSizes)) fail_file(path_, "its header names an unknown number type");
    return kSizes[type];
  }
  std::uint64_t checked_product(std::uint64_t a, std::uint64_t b) {
    std::uint64_t product = 0;
    if (__builtin_mul_overflow(a, b, &product) || product > kMost) fail_file(path_, "its header promises too much");
    return product;
  }
  static std::uint64_t padded(std::uint64_t size) { return (size + 3) / 4 * 4; }

  static constexpr std::uint64_t kMost = std::uint64_t{1} << 56;

 private:
  std::uint64_t number(std::size_t size) {
    const std::size_t begin = at_;
    skip(size);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = value << 8 | static_cast<unsigned char>(bytes_[begin + i]);
    return value;
  }
  std::string_view bytes_;
  const std::string& path_;
  std::size_t count_size_, offset_size_;
  std::size_t at_ = 0;
};

struct NetcdfVariable {
  std::uint64_t begin = 0;
  std::uint64_t bytes = 0;  ///< of one record, or of all of it
  bool has_records = false;
};

NetcdfVariable take_variable(NetcdfHeader& header, const std::vector<std::uint64_t>& dimensions,
                             const std::string& path) {
  NetcdfVariable variable;
  header.skip_name();
  std::uint64_t values = 1;
  for (std::uint64_t i = 0, n = header.count(); i < n; ++i) {
    const std::uint64_t id = header.count();
    if (id >= dimensions.size()) fail_file(path, "its header names an unknown dimension");
    if (i == 0 && dimensions[id] == 0)
      variable.has_records = true;
    else
      values = header.checked_product(values, dimensions[id]);
  }
  header.skip_attributes();
  variable.bytes = header.checked_product(values, header.size_of_type(header.tag()));
  header.count();  // The size that the file states; wrong by definition for the largest variables.
  variable.begin = header.offset();
  return variable;
}

}  // namespace

MappedFile::MappedFile(const std::string& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (descriptor >= 0 && fstat(descriptor, &status) == 0 && status.st_size > 0) {
    void* address = mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (address != MAP_FAILED) text_ = {static_cast<const char*>(address), static_cast<std::size_t>(status.st_size)};
  }
  if (descriptor >= 0) close(descriptor);
  if (text_.empty()) fail_file(path, "could not be opened");
}

MappedFile::~MappedFile() { munmap(const_cast<char*>(text_.data()), text_.size()); }

void check_netcdf_length(const std::string& path) {
  const MappedFile file(path);
  const std::string_view bytes = file.text();
  if (bytes.size() < 8 || !bytes.starts_with("CDF")) return;
  NetcdfHeader header(bytes, path);
  std::uint64_t records = header.count();
  if (records == (bytes[3] == 5 ? ~std::uint64_t{0} : 0xFFFFFFFFu)) records = 0;  // Still being written.
  std::vector<std::uint64_t> dimensions;
  header.tag();
  for (std::uint64_t i = 0, n = header.count(); i < n; ++i) {
    header.skip_name();
    dimensions.push_back(header.count());
  }
  header.skip_attributes();
  std::vector<NetcdfVariable> variables;
  header.tag();
  for (std::uint64_t i = 0, n = header.count(); i < n; ++i)
    variables.push_back(take_variable(header, dimensions, path));
  std::uint64_t record_bytes = 0;
  const auto record_variables =
      std::count_if(variables.begin(), variables.end(), [](auto& v) { return v.has_records; });
  for (const NetcdfVariable& variable : variables)
    if (variable.has_records)
      record_bytes += record_variables == 1 ? variable.bytes : NetcdfHeader::padded(variable.bytes);
  for (const NetcdfVariable& variable : variables) {
    if (variable.has_records && records == 0) continue;
    const std::uint64_t before = variable.has_records ? header.checked_product(records - 1, record_bytes) : 0;
    if (variable.begin > NetcdfHeader::kMost || variable.begin + before + variable.bytes > bytes.size())
      fail_file(path, "it is " + std::to_string(bytes.size()) + " bytes long and shorter than its header says");
  }
}

std::string read_whole_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  std::string text(in ? static_cast<std::size_t>(in.tellg()) : 0, '\0');
  in.seekg(0);
  if (!in.read(text.data(), static_cast<std::streamsize>(text.size()))) fail_file(path, "could not be read to its end");
  return text;
}

}  // namespace tetravox::io
