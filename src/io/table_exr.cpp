#include "src/io/table_image.h"

#include "tetravox/error.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <system_error>

namespace tetravox::io {
namespace {

constexpr const char* kChannels[4] = {"R", "G", "B", "A"};
constexpr float kRoundedAbove = 1.001f;  // what division leaves above 1

std::size_t extent(int first, int last) {
  return last >= first ? static_cast<std::size_t>(static_cast<long long>(last) - first + 1) : 0;
}

TableImage read_pixels(Imf::InputFile& file, const std::string& path, std::size_t largest) {
  const Imf::Header& header = file.header();
  const Imath::Box2i window = header.dataWindow();
  TableImage image;
  image.width = extent(window.min.x, window.max.x);
  image.height = extent(window.min.y, window.max.y);
  require_table_size(path, image.width, image.height, largest);
  image.rgba.resize(4 * image.width * image.height);
  Imf::FrameBuffer frame;
  constexpr std::size_t kPixel = 4 * sizeof(float);
  for (std::size_t c = 0; c < 4; ++c) {
    const Imf::Channel* channel = header.channels().findChannel(kChannels[c]);
    if (!channel || channel->xSampling != 1 || channel->ySampling != 1)
      throw Error(ErrorCode::kUnsupported,
                  "'" + path + "' has no channel " + kChannels[c] + ": a table needs R, G, B and A (opacity)");
    frame.insert(kChannels[c],
                 Imf::Slice::Make(Imf::FLOAT, image.rgba.data() + c, window, kPixel, kPixel * image.width));
  }
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  return image;
}

}  // namespace

TableImage read_exr_table(const std::string& path, std::size_t largest) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw Error(ErrorCode::kFileNotFound, "cannot open '" + path + "': no such file, or it may not be read");
  TableImage image;
  try {
    Imf::InputFile file(path.c_str(), 0);
    image = read_pixels(file, path, largest);
  } catch (const Error&) {
    throw;
  } catch (const std::exception&) {
    throw Error(ErrorCode::kBadFile, "'" + path + "' is not an EXR, or a damaged one");
  }
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const float alpha = image.rgba[i + 3];
    for (std::size_t c = 0; alpha > 0.0f && c < 3; ++c) {
      const float color = image.rgba[i + c] / alpha;
      image.rgba[i + c] = color <= kRoundedAbove ? std::min(color, 1.0f) : color;
    }
  }
  return image;
}

}  // namespace tetravox::io
