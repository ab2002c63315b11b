#pragma once

/// What INPUT means: a data file, a scene file, or a picture that holds its scene.

#include "apps/tetravox/options.h"

#include "tetravox/io.h"
#include "tetravox/scene.h"

#include <optional>
#include <string>

namespace tetravox::tool {

struct SceneInput {
  Scene scene;
  std::string data_path;                ///< as to open from the current directory, or "builtin:NAME"
  ReadOptions read;                     ///< how to read it
  std::string name;                     ///< of the input, without directory and ending: for the default output
  std::optional<WriteOptions> picture;  ///< how the picture was written, where the input is one
};

/// The scene that INPUT stands for, with the data options of the command line put over it.
/// @throws Error for files that cannot be read; UsageError for options that contradict each other.
SceneInput load_scene_input(const InputOptions& options);

/// The scene as a file in the directory of `target` must say it: paths relative to that directory where the two share a
/// directory below the root, so that a folder can be moved; absolute otherwise.
Scene scene_seen_from(const SceneInput& input, const std::string& target);

}  // namespace tetravox::tool
