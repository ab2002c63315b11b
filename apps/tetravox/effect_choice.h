#pragma once

/// Light, surfaces and clipping: from the command line and the scene to the renderer.

#include "apps/tetravox/options.h"

#include "tetravox/environment.h"
#include "tetravox/grid.h"
#include "tetravox/progress.h"
#include "tetravox/render.h"
#include "tetravox/scene.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace tetravox::tool {

/// Puts the options over the scene, before data are read. @throws UsageError.
void override_effects(const EffectOptions& options, Scene& scene);

/// What the data decide: colours of surfaces, and whether the volume is drawn. After the transfer function is known.
void complete_effects(const EffectOptions& options, CompletedScene& completed, Scene& scene);

/// Options that change nothing here, one line each.
std::vector<std::string> check_effects(const EffectOptions& options, const RenderSettings& settings);

/// Files that a scene names beside its data, as the renderer wants them.
class SceneParts {
 public:
  /// Reads and prepares them; each may take `reader_timeout` seconds to read. @throws Error that names the file.
  void load(const Scene& scene, double reader_timeout, const Progress& progress);
  /// Hands them to a renderer, which views them.
  void attach(Renderer& renderer) const;

 private:
  struct Volume {
    std::size_t shape = 0;
    std::unique_ptr<PreparedGrid> grid;
  };
  std::vector<Volume> volumes_;
  std::unique_ptr<Environment> environment_;
};

}  // namespace tetravox::tool
