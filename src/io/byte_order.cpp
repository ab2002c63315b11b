#include "src/io/byte_order.h"

#include "src/support/threads.h"

#include <algorithm>
#include <bit>

namespace tetravox::io {

namespace {

constexpr std::size_t kGrain = std::size_t{1} << 16;

/// A size that the compiler knows becomes one instruction a value.
template <std::size_t size>
void turn_around(std::span<std::byte> values) {
  support::parallel_chunks(values.size() / size, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::byte* value = values.data() + begin * size; value != values.data() + end * size; value += size)
      std::reverse(value, value + size);
  });
}

}  // namespace

bool is_native_order(std::size_t value_size, bool is_big_endian) {
  return value_size == 1 || is_big_endian == (std::endian::native == std::endian::big);
}

void to_native_order(std::span<std::byte> values, std::size_t value_size, bool is_big_endian) {
  if (is_native_order(value_size, is_big_endian)) return;
  if (value_size == 2) turn_around<2>(values);
  if (value_size == 4) turn_around<4>(values);
  if (value_size == 8) turn_around<8>(values);
}

}  // namespace tetravox::io
