#include "src/io/image_exr.h"

#include "tetravox/error.h"

#include "src/support/threads.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <exception>
#include <fstream>
#include <optional>
#include <vector>

namespace tetravox::io {
namespace {

constexpr char kSceneAttribute[] = "tetravox_scene";
constexpr int kCompressionLevel = 2;               // of 9: higher ones take twice the time for a few per cent
constexpr std::size_t kLargestName = 255;          // bytes of an attribute's name, by the format
constexpr std::uint32_t kLargestText = 64u << 20;  // bytes of a scene
constexpr std::uint64_t kLargestHeader = 256u << 20;

/// Hands OpenEXR's bytes to an output file.
class ExrStream final : public Imf::OStream {
 public:
  explicit ExrStream(OutputFile& file) : Imf::OStream("picture"), file_(file) {}
  void write(const char bytes[], int count) override { file_.write(bytes, static_cast<std::size_t>(count)); }
  std::uint64_t tellp() override { return file_.tell(); }
  void seekp(std::uint64_t position) override { file_.seek(position); }

 private:
  OutputFile& file_;
};

/// Interleaved float channels of a picture.
struct Channels {
  std::vector<const char*> names;
  const float* values = nullptr;  ///< [height][width][names]
};

Imf::Header make_header(const Image& image, const Channels& channels, const std::string& scene) {
  Imf::Header header(image.width, image.height, 1.0f, Imath::V2f(0, 0), 1.0f, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
  for (const char* name : channels.names) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  header.zipCompressionLevel() = kCompressionLevel;
  header.insert("software", Imf::StringAttribute("tetravox"));
  if (!scene.empty()) header.insert(kSceneAttribute, Imf::StringAttribute(scene));
  return header;
}

void write_rows(ExrStream& stream, const Image& image, const Channels& channels, const std::string& scene,
                const Progress& progress) {
  Imf::OutputFile output(stream, make_header(image, channels, scene), 0);
  Imf::FrameBuffer frame;
  const std::size_t pixel = channels.names.size() * sizeof(float);
  const std::size_t row = pixel * static_cast<std::size_t>(image.width);
  for (std::size_t c = 0; c < channels.names.size(); ++c) {
    char* base = reinterpret_cast<char*>(const_cast<float*>(channels.values + c));  // read only
    frame.insert(channels.names[c], Imf::Slice(Imf::FLOAT, base, pixel, row));
  }
  output.setFrameBuffer(frame);
  for (int y = 0; y < image.height; y += 16) {
    support::throw_if_cancelled(progress);
    output.writePixels(std::min(16, image.height - y));
  }
}

/// Translates what OpenEXR throws.
void write_channels(OutputFile& file, const Image& image, const Channels& channels, const std::string& scene,
                    const Progress& progress) {
  try {
    ExrStream stream(file);
    write_rows(stream, image, channels, scene, progress);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    // OpenEXR wraps what our stream throws in exceptions of its own.
    if (file.has_failed()) file.fail();
    throw Error(ErrorCode::kCannotWrite, std::string("cannot write an EXR: ") + error.what());
  }
}

/// Reads a text that ends with a zero byte; nothing where it is too long or the file ends.
std::optional<std::string> read_name(std::istream& file) {
  std::string name;
  for (int byte = file.get(); byte != std::char_traits<char>::eof(); byte = file.get()) {
    if (byte == 0) return name;
    if (name.size() == kLargestName) return {};
    name.push_back(static_cast<char>(byte));
  }
  return {};
}

std::optional<std::uint32_t> read_word(std::istream& file) {
  std::array<unsigned char, 4> bytes{};
  if (!file.read(reinterpret_cast<char*>(bytes.data()), bytes.size())) return {};
  return bytes[0] | (std::uint32_t{bytes[1]} << 8) | (std::uint32_t{bytes[2]} << 16) | (std::uint32_t{bytes[3]} << 24);
}

/// The channels that make colours, in the order red, green, blue.
std::array<const char*, 3> choose_channels(const std::string& path, const Imf::ChannelList& channels) {
  if (channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B")) return {"R", "G", "B"};
  if (channels.findChannel("Y") && !channels.findChannel("RY")) return {"Y", "Y", "Y"};
  throw Error(ErrorCode::kUnsupported, "'" + path + "' has neither channels R, G and B nor Y alone");
}

Pixels read_colors(const std::string& path, std::size_t most) {
  Imf::InputFile file(path.c_str(), 0);
  const Imath::Box2i window = file.header().dataWindow();
  const auto side = [](int min, int max) { return static_cast<long long>(max) - min + 1; };
  const std::array<const char*, 3> channels = choose_channels(path, file.header().channels());
  Pixels pixels = make_pixels(path, side(window.min.x, window.max.x), side(window.min.y, window.max.y), most);
  const std::size_t pixel = 3 * sizeof(float), row = pixel * static_cast<std::size_t>(pixels.width);
  const bool is_grey = channels[0] == channels[1];
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < (is_grey ? 1u : 3u); ++c)
    frame.insert(channels[c], Imf::Slice::Make(Imf::FLOAT, pixels.colors.data() + c, window, pixel, row));
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  for (std::size_t i = 0; is_grey && i < pixels.colors.size(); i += 3)
    pixels.colors[i + 1] = pixels.colors[i + 2] = pixels.colors[i];
  return pixels;
}

}  // namespace

void write_exr(OutputFile& file, const Image& image, const WriteOptions& options, const Progress& progress) {
  write_channels(file, image, {{"R", "G", "B", "A"}, image.pixels.data()}, options.scene, progress);
}

void write_depth_exr(OutputFile& file, const Image& image) {
  write_channels(file, image, {{"Z"}, image.depth.data()}, "", {});
}

Pixels read_exr_pixels(const std::string& path, std::size_t most) {
  if (!std::ifstream(path, std::ios::binary))
    throw Error(ErrorCode::kFileNotFound, "cannot open '" + path + "': " + std::strerror(errno));
  try {
    return read_colors(path, most);
  } catch (const Error&) {
    throw;
  } catch (const std::exception&) {
    throw Error(ErrorCode::kBadFile, "'" + path + "' is not an EXR, or a damaged one");
  }
}

std::string read_exr_scene(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(ErrorCode::kFileNotFound, "cannot open '" + path + "': " + std::strerror(errno));
  const Error damaged(ErrorCode::kBadFile, "'" + path + "' is not an EXR, or a damaged one");
  if (read_word(file) != 20000630u || !read_word(file)) throw damaged;

  // An attribute is a name, a type, a length and as many bytes; an empty name ends the header.
  std::uint64_t header_bytes = 0;
  while (true) {
    const auto name = read_name(file);
    if (!name) throw damaged;
    if (name->empty()) return {};
    const auto type = read_name(file);
    const auto length = read_word(file);
    if (!type || !length) throw damaged;
    header_bytes += *length;
    if (header_bytes > kLargestHeader) throw damaged;
    if (*name != kSceneAttribute || *type != "string") {
      file.ignore(*length);
      continue;
    }
    // Grow with what is really there, so that a false length costs nothing.
    if (*length > kLargestText) throw damaged;
    std::string scene;
    std::array<char, 65536> part{};
    while (scene.size() < *length) {
      const std::size_t wanted = std::min<std::size_t>(part.size(), *length - scene.size());
      if (!file.read(part.data(), static_cast<std::streamsize>(wanted))) throw damaged;
      scene.append(part.data(), wanted);
    }
    return scene;
  }
}

}  // namespace tetravox::io
