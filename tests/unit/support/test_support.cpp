#include "src/support/check.h"
#include "src/support/memory.h"
#include "src/support/threads.h"
#include "src/support/timer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace tetravox::support {
namespace {

ErrorCode code_of(const std::function<void()>& call, std::string* message = nullptr) {
  try {
    call();
  } catch (const Error& error) {
    if (message) *message = error.what();
    return error.code();
  }
  ADD_FAILURE() << "no error was thrown";
  return ErrorCode::kInternal;
}

TEST(Check, ThatHoldsSaysNothing) {
  TETRAVOX_CHECK_EQ(1 + 1, 2);
  TETRAVOX_CHECK_LT(1, 2);
  TETRAVOX_CHECK_LE(2, 2);
}

TEST(Check, ThatFailsPrintsBothOperandsInOneLine) {
  const int count = 7, limit = 5;
  std::string message;
  EXPECT_EQ(code_of([&] { TETRAVOX_CHECK_LT(count, limit); }, &message), ErrorCode::kInternal);
  EXPECT_NE(message.find("count < limit does not hold (7 and 5)"), std::string::npos) << message;
  EXPECT_NE(message.find("test_support.cpp:"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(Check, EvaluatesEachOperandOnce) {
  int calls = 0;
  TETRAVOX_CHECK_EQ(++calls, 1);
  EXPECT_EQ(calls, 1);
}

TEST(Check, PrintsBytesAsNumbers) {
  const std::uint8_t type = 65;
  std::string message;
  code_of([&] { TETRAVOX_CHECK_EQ(type, std::uint8_t{66}); }, &message);
  EXPECT_NE(message.find("(65 and 66)"), std::string::npos) << message;
}

TEST(Memory, ThereIsSomeAndWeUseSome) {
  EXPECT_GT(available_memory(), std::uint64_t{1} << 20);
  EXPECT_GT(peak_resident_memory(), std::uint64_t{100} << 10);
}

TEST(Memory, PeakFollowsWhatIsTouched) {
  const std::uint64_t before = peak_resident_memory();
  const std::uint64_t size = std::uint64_t{192} << 20;
  std::vector<char> block(size, 'x');
  EXPECT_EQ(block[size / 2], 'x');
  EXPECT_GE(peak_resident_memory(), std::max(before, size));
}

TEST(Memory, RefusesMoreThanThereIs) {
  require_memory(1024, "a test");
  std::string message;
  EXPECT_EQ(code_of([] { require_memory(std::numeric_limits<std::uint64_t>::max() / 2, "drawing x.vtu"); }, &message),
            ErrorCode::kOutOfMemory);
  EXPECT_NE(message.find("drawing x.vtu needs about"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(Memory, IsWrittenForPeople) {
  EXPECT_EQ(format_bytes(0), "0 bytes");
  EXPECT_EQ(format_bytes(1023), "1023 bytes");
  EXPECT_EQ(format_bytes(1536), "1.5 kB");
  EXPECT_EQ(format_bytes(std::uint64_t{312} << 20), "312 MiB");
  EXPECT_EQ(format_bytes(std::uint64_t{3} << 29), "1.5 GiB");
  EXPECT_EQ(format_bytes(std::uint64_t{5} << 40), "5.0 TiB");
}

TEST(Threads, ChunksCoverEveryIndexOnce) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{1000}, std::size_t{12345}}) {
    std::vector<std::atomic<int>> visits(count);
    parallel_chunks(count, 64, [&](std::size_t begin, std::size_t end) {
      EXPECT_LT(begin, end);
      for (std::size_t i = begin; i < end; ++i) visits[i].fetch_add(1);
    });
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(visits[i].load(), 1) << i;
  }
}

TEST(Threads, LimitHoldsForEverythingInside) {
  std::mutex mutex;
  std::set<std::thread::id> seen;
  with_threads(1, [&] {
    EXPECT_EQ(hardware_threads(), 1);
    parallel_chunks(1000, 1, [&](std::size_t, std::size_t) {
      const std::lock_guard lock(mutex);
      seen.insert(std::this_thread::get_id());
    });
  });
  EXPECT_EQ(seen.size(), 1u);
  with_threads(3, [] { EXPECT_EQ(hardware_threads(), 3); });
  const int all = hardware_threads();
  with_threads(0, [&] { EXPECT_EQ(hardware_threads(), all); });
}

TEST(Threads, ErrorsLeaveParallelWork) {
  const auto work = [] {
    with_threads(2, [] {
      parallel_chunks(100, 1, [](std::size_t begin, std::size_t) {
        if (begin == 57) throw Error(ErrorCode::kBadFile, "x");
      });
    });
  };
  EXPECT_EQ(code_of(work), ErrorCode::kBadFile);
}

TEST(Threads, CancellingThrows) {
  std::atomic<bool> cancelled = false;
  Progress progress;
  throw_if_cancelled(progress);
  progress.cancelled = &cancelled;
  throw_if_cancelled(progress);
  cancelled = true;
  EXPECT_EQ(code_of([&] { throw_if_cancelled(progress); }), ErrorCode::kCancelled);
}

TEST(Timer, RunsForward) {
  const Timer timer;
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const double first = timer.seconds();
  EXPECT_GE(first, 0.019);
  EXPECT_LT(first, 20.0);
  EXPECT_GE(timer.seconds(), first);
}

}  // namespace
}  // namespace tetravox::support
