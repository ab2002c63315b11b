#pragma once

/// Files in and pictures out.
///
/// Foreign formats are read by a child process (`tetravox-reader`) that hands its arrays over through shared memory:
/// when it crashes, hangs or eats too much memory, that is an `Error` here and nothing else.

#include "tetravox/dataset.h"
#include "tetravox/environment.h"
#include "tetravox/image.h"
#include "tetravox/progress.h"
#include "tetravox/scene.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace tetravox {

/// Further arrays that can be read beside the one that is drawn.
inline constexpr std::size_t kMostOtherArrays = 8;

struct ReadOptions {
  ArrayRequest array;
  std::vector<ArrayRequest> others;  ///< further fields, named: `MeshData::others`, `Dataset::other_grids`, as ordered
  TimeRequest time;
  RawLayout raw;                   ///< RAW files only
  std::string grid_file;           ///< PLOT3D: the solution (Q) file that goes with the grid at `path`
  double timeout = 600.0;          ///< seconds that the reader may take
  std::uint64_t memory_limit = 0;  ///< bytes that the reader may take; 0: what the machine has free
  bool only_info = false;          ///< leave `Dataset::mesh` empty
};

/// Reads a file of any format in `reader_names()`, or makes a "builtin:" dataset. Everything that comes back is
/// validated.
/// @throws Error that names the file; see ErrorCode.
Dataset read_dataset(const std::string& path, const ReadOptions& options = {}, const Progress& progress = {});

/// Formats that can be read: name, and file endings with a remark.
std::vector<std::pair<std::string, std::string>> reader_names();

/// Colours and opacities of a function of several variables, as `make_optical_table` takes them.
struct FunctionTable {
  std::vector<std::size_t> sizes;  ///< entries along each variable
  std::vector<float> rgba;         ///< [..][4], first variable fastest; not premultiplied
};

/// Reads a table: an image (.png, .exr) of two variables, the first to the right and the second upwards, alpha as
/// opacity; or an .npy file of float32, float64 (from 0 to 1) or uint8 (from 0 to 255), [n2][n1][4] or [n3][n2][n1][4].
/// @throws Error that names the file: kFileNotFound, kBadFile, kUnsupported, kInvalidArgument for other endings.
FunctionTable read_function_table(const std::string& path, std::size_t variables);

/// Surroundings from PNG or EXR pictures, or "builtin:NAME".
///
/// One file is equirectangular, twice as wide as high. A cube is a directory with px, nx, py, ny, pz and nz, each .exr
/// or .png, or a path whose `*` stands for these names. PNG values are taken as displayed, 0 to 1, without alpha; those
/// of EXR (channels R, G, B, or Y alone) as radiance, where negative ones count as 0.
/// @throws Error that names the file: kFileNotFound, kBadFile, kUnsupported, kInvalidArgument, kOutOfMemory.
Environment read_environment(const std::string& path);

struct WriteOptions {
  Color background{0, 0, 0};
  bool use_alpha = false;  ///< PNG: keep transparency instead of compositing over the background
  int bit_depth = 8;       ///< PNG: 8 or 16
  std::string scene;       ///< scene file's text, kept as metadata in PNG and EXR
};

/// Writes a picture by its ending: .png, .exr (float, premultiplied) or .npy (float32 [height][width][4],
/// premultiplied). Writes to a temporary name beside it, then renames: never half a file.
/// @throws Error: kCannotWrite, kInvalidArgument for an unknown ending, kCancelled.
void write_image(const std::string& path, const Image& image, const WriteOptions& options = {},
                 const Progress& progress = {});

/// Writes `Image::depth` in the same way: .exr (one float channel Z) or .npy (float32 [height][width]). Infinite where
/// nothing is met.
/// @throws Error: kCannotWrite, kInvalidArgument for another ending or a picture without depth.
void write_depth(const std::string& path, const Image& image);

/// The endings that `write_image` knows, with a remark.
std::vector<std::pair<std::string, std::string>> image_writer_names();

/// The scene kept in a PNG or EXR that tetravox wrote; empty where there is none.
/// @throws Error: kFileNotFound, kBadFile for what is no picture, kInvalidArgument for another ending.
std::string read_image_scene(const std::string& path);

/// The scene, and for a PNG also `use_alpha` and `bit_depth`, that a picture was written with; throws as above.
WriteOptions read_image_options(const std::string& path);

/// Writes a text file in the same way: all of it or nothing. @throws Error (kCannotWrite).
void write_text_file(const std::string& path, const std::string& text);

/// Writes numbers as an .npy file of float64 with this shape, last axis fastest, in the same way.
/// @throws Error: kCannotWrite; kInvalidArgument where the shape does not hold as many numbers.
void write_array(const std::string& path, std::span<const double> values, const std::vector<std::size_t>& shape);

/// Bytes that this process may still allocate without swapping or the OOM killer (limits of the machine and its control
/// groups).
std::uint64_t available_memory();

}  // namespace tetravox
