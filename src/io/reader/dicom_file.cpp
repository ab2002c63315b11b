#include "src/io/reader/dicom_file.h"

#include "src/io/formats.h"
#include "src/io/reader/blocks.h"
#include "src/io/reader/raw_volume.h"

#include <algorithm>
#include <cmath>

namespace tetravox::io {

namespace {

constexpr std::uint32_t kUndefined = 0xFFFFFFFFu;
constexpr int kDeepest = 32;  ///< sequences in sequences

/// Group and element in one number.
enum Tag : std::uint32_t {
  kTransferSyntax = 0x0002'0010,
  kSeries = 0x0020'000E,
  kInstance = 0x0020'0013,
  kThickness = 0x0018'0050,
  kSliceDistance = 0x0018'0088,
  kPosition = 0x0020'0032,
  kOrientation = 0x0020'0037,
  kSamples = 0x0028'0002,
  kPhotometric = 0x0028'0004,
  kPlanar = 0x0028'0006,
  kFrames = 0x0028'0008,
  kRows = 0x0028'0010,
  kColumns = 0x0028'0011,
  kPixelSpacing = 0x0028'0030,
  kBitsAllocated = 0x0028'0100,
  kBitsStored = 0x0028'0101,
  kHighBit = 0x0028'0102,
  kSigned = 0x0028'0103,
  kIntercept = 0x0028'1052,
  kSlope = 0x0028'1053,
  kSharedGroups = 0x5200'9229,
  kFrameGroups = 0x5200'9230,
  kFloatPixels = 0x7FE0'0008,
  kDoublePixels = 0x7FE0'0009,
  kPixels = 0x7FE0'0010,
  kItem = 0xFFFE'E000,
  kItemEnd = 0xFFFE'E00D,
  kSequenceEnd = 0xFFFE'E0DD
};

/// Sequences that tell of single frames, which must be known where the file does not say what is a sequence.
bool is_frame_sequence(std::uint32_t tag) {
  for (const std::uint32_t known : {0x5200'9229u, 0x5200'9230u, 0x0020'9113u, 0x0020'9116u, 0x0028'9110u, 0x0028'9145u})
    if (tag == known) return true;
  return false;
}

struct Element {
  std::uint32_t tag = 0;
  std::string_view type;  ///< "US", ...; empty where the file does not say
  std::uint32_t size = 0;
};

class Parser {
 public:
  Parser(std::string_view bytes, DicomFile& file) : bytes_(bytes), file_(file) {}

  void parse() {
    at_ = 132;
    while (at_ < bytes_.size() && peek_group() == 2) take_element(0, true);
    set_syntax();
    while (at_ < bytes_.size() && !is_done_) take_element(0, true);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { fail_file(file_.name, what); }

  std::uint64_t number(std::string_view bytes) const {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i)
      value = value << 8 | static_cast<unsigned char>(bytes[file_.is_big_endian ? i : bytes.size() - 1 - i]);
    return value;
  }
  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size() - at_) fail("it ends in the middle of an element");
    const std::string_view out = bytes_.substr(at_, static_cast<std::size_t>(size));
    at_ += static_cast<std::size_t>(size);
    return out;
  }
  std::uint32_t take_number(std::size_t size) { return static_cast<std::uint32_t>(number(take(size))); }
  std::uint64_t peek_group() const { return bytes_.size() - at_ < 2 ? 0 : number(bytes_.substr(at_, 2)); }

  void set_syntax() {
    if (syntax_ == "1.2.840.10008.1.2") {
      is_explicit_ = false;
    } else if (syntax_ == "1.2.840.10008.1.2.2") {
      file_.is_big_endian = true;
    } else if (syntax_ != "1.2.840.10008.1.2.1") {
      const bool is_known = syntax_.starts_with("1.2.840.10008.1.2.");
      throw Error(is_known ? ErrorCode::kUnsupported : ErrorCode::kBadFile,
                  "'" + file_.name + "' is compressed (transfer syntax '" + syntax_ +
                      "'): write it uncompressed, as with gdcmconv --raw or dcmdjpeg");
    }
  }

  Element take_head() {
    Element element;
    const std::uint32_t group = take_number(2);
    element.tag = group << 16 | take_number(2);
    if (!is_explicit_ || group == 0xFFFE) {
      element.size = take_number(4);
      return element;
    }
    element.type = take(2);
    for (const char c : element.type)
      if (c < 'A' || c > 'Z') fail("an element has no type");
    bool is_long = false;
    for (const std::string_view type : {"OB", "OD", "OF", "OL", "OV", "OW", "SQ", "SV", "UC", "UN", "UR", "UT", "UV"})
      is_long = is_long || element.type == type;
    if (is_long) take(2);
    element.size = take_number(is_long ? 4 : 2);
    return element;
  }

  /// Takes an element; `is_wanted`: what it says is of this file, or of one of its frames.
  Element take_element(int depth, bool is_wanted) {
    const Element element = take_head();
    if (element.tag == kItemEnd || element.tag == kSequenceEnd) return element;
    const bool is_pixels = element.tag == kPixels || element.tag == kFloatPixels || element.tag == kDoublePixels;
    if (is_pixels && depth == 0) {
      take_pixels(element);
    } else if (element.type == "SQ" || element.size == kUndefined ||
               (element.type.empty() && is_frame_sequence(element.tag))) {
      const bool is_of_frame = element.tag == kSharedGroups || element.tag == kFrameGroups || (depth > 0 && is_wanted);
      take_sequence(element, depth + 1, is_of_frame);
    } else {
      const std::string_view value = take(element.size);
      if (is_wanted) set_value(element.tag, value, depth);
    }
    return element;
  }

  void take_sequence(const Element& sequence, int depth, bool is_wanted) {
    if (depth > kDeepest) fail("its sequences nest too deeply");
    // What is of unknown type and undefined length is written without types (PS3.5, 6.2.2).
    const bool was_explicit = is_explicit_;
    if (sequence.type == "UN") is_explicit_ = false;
    const bool has_end = sequence.size != kUndefined;
    if (has_end && sequence.size > bytes_.size() - at_) fail("a sequence ends behind the end of the file");
    const std::size_t end = has_end ? at_ + sequence.size : bytes_.size();
    while (at_ < end || !has_end) {
      const Element item = take_head();
      if (item.tag == kSequenceEnd) break;
      if (item.tag != kItem) fail("a sequence holds something else than items");
      take_item(item, depth, is_wanted);
    }
    is_explicit_ = was_explicit;
  }

  void take_item(const Element& item, int depth, bool is_wanted) {
    if (item.size == kUndefined) {
      while (take_element(depth, is_wanted).tag != kItemEnd) {
      }
      return;
    }
    if (item.size > bytes_.size() - at_) fail("an item ends behind the end of the file");
    const std::size_t end = at_ + item.size;
    while (at_ < end) take_element(depth, is_wanted);
  }

  void take_pixels(const Element& element) {
    if (element.tag != kPixels)
      throw Error(ErrorCode::kUnsupported, "'" + file_.name + "' has real numbers for pixels: write whole numbers");
    if (element.size == kUndefined)
      throw Error(ErrorCode::kUnsupported,
                  "'" + file_.name + "' is compressed: write it uncompressed, as with gdcmconv --raw");
    file_.pixels = take(element.size);
    is_done_ = true;
  }

  /// Numbers in text, parted by backslashes; nothing where they are not `count` numbers.
  std::vector<double> decimals(std::string_view value, std::size_t count) const {
    std::string text(value);
    std::replace(text.begin(), text.end(), '\\', ' ');
    std::replace(text.begin(), text.end(), '\0', ' ');
    std::vector<double> out;
    for (const std::string& word : split_words(text)) {
      const auto decimal = to_double(word);
      if (!decimal || !std::isfinite(*decimal)) return {};
      out.push_back(*decimal);
    }
    if (out.size() < count) return {};
    return out;
  }

  static std::string text(std::string_view value) {
    while (!value.empty() && (value.back() == '\0' || value.back() == ' ')) value.remove_suffix(1);
    return std::string(trim(value));
  }

  void set_value(std::uint32_t tag, std::string_view value, int depth) {
    if (depth == 0 && value.size() == 2) set_number(tag, static_cast<unsigned>(number(value)));
    if (set_place(tag, value) || depth > 0) return;
    switch (tag) {
      case kTransferSyntax:
        syntax_ = text(value);
        break;
      case kSeries:
        file_.series = text(value);
        break;
      case kPhotometric:
        file_.photometric = text(value);
        break;
      case kInstance:
        file_.instance = to_integer(text(value));
        break;
      case kFrames:
        if (const auto frames = to_integer(text(value)); frames && *frames > 0)
          file_.frames = static_cast<std::uint64_t>(*frames);
        else
          fail("its number of frames makes no sense");
        break;
      default:
        break;
    }
  }

  void set_number(std::uint32_t tag, unsigned value) {
    switch (tag) {
      case kSamples:
        file_.samples = value;
        break;
      case kPlanar:
        file_.is_planar = value == 1;
        break;
      case kRows:
        file_.rows = value;
        break;
      case kColumns:
        file_.columns = value;
        break;
      case kBitsAllocated:
        file_.bits_allocated = value;
        break;
      case kBitsStored:
        file_.bits_stored = value;
        break;
      case kHighBit:
        file_.high_bit = value;
        break;
      case kSigned:
        file_.is_signed = value == 1;
        break;
      default:
        break;
    }
  }

  /// Sets what may also stand with a frame.
  bool set_place(std::uint32_t tag, std::string_view value) {
    const std::size_t count = tag == kPosition ? 3 : tag == kOrientation ? 6 : tag == kPixelSpacing ? 2 : 1;
    if (tag != kPosition && tag != kOrientation && tag != kPixelSpacing && tag != kThickness && tag != kSliceDistance &&
        tag != kSlope && tag != kIntercept)
      return false;
    const std::vector<double> numbers = decimals(value, count);
    if (numbers.empty()) return true;
    if (tag == kPosition) {
      file_.positions.push_back({numbers[0], numbers[1], numbers[2]});
    } else if (tag == kOrientation) {
      file_.orientation.emplace();
      std::copy_n(numbers.begin(), 6, file_.orientation->begin());
    } else if (tag == kPixelSpacing) {
      file_.pixel_spacing = {numbers[0], numbers[1]};
    } else if (tag == kSliceDistance || (tag == kThickness && file_.thickness == 0.0)) {
      file_.thickness = std::abs(numbers[0]);  // The distance comes later, and wins.
    } else if (tag == kSlope) {
      file_.slope = numbers[0];
    } else if (tag == kIntercept) {
      file_.intercept = numbers[0];
    }
    return true;
  }

  std::string_view bytes_;
  DicomFile& file_;
  std::size_t at_ = 0;
  std::string syntax_;
  bool is_explicit_ = true;
  bool is_done_ = false;
};

/// An image says what its pixels are, and holds them all.
void check_image(DicomFile& file) {
  const unsigned allocated = file.bits_allocated;
  if (file.pixels.empty() && file.rows > 0) fail_file(file.name, "its pixels are missing");
  if (file.pixels.empty()) return;
  if (allocated != 8 && allocated != 16 && allocated != 32)
    throw Error(allocated > 64 ? ErrorCode::kBadFile : ErrorCode::kUnsupported,
                "'" + file.name + "' has pixels of " + std::to_string(allocated) + " bits, not of 8, 16 or 32");
  if (file.bits_stored == 0) file.bits_stored = allocated;
  if (file.high_bit == 0) file.high_bit = file.bits_stored - 1;
  const bool is_sane = file.bits_stored <= allocated && file.high_bit < allocated &&
                       file.high_bit + 1 >= file.bits_stored && file.samples >= 1 && file.samples <= 4 &&
                       file.rows > 0 && file.columns > 0;
  if (!is_sane) fail_file(file.name, "its rows, columns, samples or bits make no sense");
  const std::uint64_t needed =
      count_bytes(std::array{file.rows, file.columns, file.samples, std::uint64_t{allocated / 8}, file.frames},
                  ScalarType::kUint8, file.name);
  if (file.pixels.size() < needed)
    fail_file(file.name, "it holds " + std::to_string(file.pixels.size()) + " bytes of pixels instead of " +
                             std::to_string(needed));
}

}  // namespace

DicomFile parse_dicom(std::string_view bytes, const std::string& name) {
  DicomFile file;
  file.name = name;
  if (!is_dicom_head(bytes)) fail_file(name, "it does not begin as a DICOM file does");
  Parser(bytes, file).parse();
  check_image(file);
  return file;
}

}  // namespace tetravox::io
