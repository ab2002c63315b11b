#pragma once

#include <cstddef>
#include <span>

namespace tetravox::io {

/// Turns the bytes of each value around where they are of the other order than this machine's.
void to_native_order(std::span<std::byte> values, std::size_t value_size, bool is_big_endian);

/// Whether values of this size need no turning.
bool is_native_order(std::size_t value_size, bool is_big_endian);

}  // namespace tetravox::io
