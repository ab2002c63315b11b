#pragma once

/// The memory file: what the parent gets.

#include "src/io/reader/collect.h"
#include "src/io/reader_protocol.h"

#include <vector>

namespace tetravox::io {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kLimitsMemory = false;  // Sanitizers map terabytes of shadow memory.
#else
inline constexpr bool kLimitsMemory = true;
#endif

/// Name of the array that stands in where a file has none; no file's own array can bear it, since then there is one.
inline constexpr const char* kUniformArray = "(uniform)";

/// The arrays of `Description::field` and of `Description::others`, in this order.
using FieldArrays = std::vector<const ArrayInfo*>;

/// Writes the memory file with the mesh and its fields, or the stand-in of that name; with the grid and its fields,
/// whose memory is given back while they are copied; or with the description alone.
/// @throws Error (kOutOfMemory) where it does not fit into the memory that the request allows.
void hand_over_mesh(const std::vector<Block>& blocks, const Description& description, const FieldArrays& arrays,
                    const ReaderRequest& request);
void hand_over_grid(const Block& block, Description description, const FieldArrays& arrays,
                    const ReaderRequest& request);
void hand_over_info(const Description& description, const ReaderRequest& request);

}  // namespace tetravox::io
