#pragma once

/// A picture is never blank without a word: why there is nothing to see, and what to do.

#include "apps/tetravox/body.h"

#include "tetravox/dataset.h"
#include "tetravox/image.h"
#include "tetravox/render.h"
#include "tetravox/scene.h"

#include <string>
#include <vector>

namespace tetravox::tool {

/// Whatever a user should know about what the picture shows, one line each; usually nothing.
struct PictureContext {
  const Scene& scene;
  const CompletedScene& completed;
  const Body& body;
  const DatasetInfo& info;
  const RenderStatistics& statistics;
};
std::vector<std::string> explain_picture(const Image& image, const PictureContext& context);

}  // namespace tetravox::tool
