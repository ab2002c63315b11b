#include "tests/cli/run_tool.h"

#include <signal.h>
#include <sys/stat.h>

#include <chrono>
#include <thread>

namespace tetravox::cli {
namespace {

class Interrupt : public ToolTest {
 protected:
  static void wait(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }
};

TEST_F(Interrupt, WhileDrawingLeavesNothing) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Running running = start({"render", "builtin:buckyball", "--resolution", "256,256", "--repeat", "100000",
                                   "--statistics", "s.json", "--save-scene", "scene.json"});
    wait(1200);
    ::kill(running.pid, signal);
    const Result result = finish(running, 10.0);
    EXPECT_EQ(result.code, 128 + signal) << result.err;
    EXPECT_EQ(result.err, "tetravox: interrupted; nothing was written\n");
    EXPECT_TRUE(names().empty());
  }
}

TEST_F(Interrupt, AtAnyMomentLeavesNothing) {
  // From the first instruction on: before the handlers stand, the signal itself ends the process.
  for (const int milliseconds : {0, 3, 10, 30, 60, 100, 200, 400}) {
    const Running running = start({"render", "builtin:buckyball?cells=1000000", "--repeat", "10000"});
    wait(milliseconds);
    ::kill(running.pid, SIGINT);
    const Result result = finish(running, 10.0);
    EXPECT_EQ(result.code, 130) << result.err;
    EXPECT_TRUE(names().empty());
  }
}

TEST_F(Interrupt, SecondSignalKillsAtOnce) {
  const Running running = start({"render", "builtin:buckyball", "--resolution", "2000,2000", "--repeat", "100000"});
  wait(800);
  ::kill(running.pid, SIGINT);
  ::kill(running.pid, SIGINT);
  wait(1);
  ::kill(running.pid, SIGINT);
  EXPECT_EQ(finish(running, 2.0).code, 130);
  EXPECT_TRUE(names().empty());
}

TEST_F(Interrupt, WholeGroupLikeATerminal) {
  // Ctrl-C in a terminal reaches the reader as well: whichever ends first, it is an interrupt.
  write_tetrahedron("one.vtk");
  for (int milliseconds = 0; milliseconds < 60; milliseconds += 4) {
    std::filesystem::remove(path("one.png"));
    const Running running = start({"render", "one.vtk", "--resolution", "64,64"});
    wait(milliseconds);
    ::kill(-running.pid, SIGINT);
    const Result result = finish(running, 5.0);
    EXPECT_TRUE(result.code == 130 || result.code == 0) << result.code << " " << result.err;
    EXPECT_EQ(std::filesystem::exists(path("one.png")), result.code == 0);
    EXPECT_EQ(names().size(), result.code == 0 ? 2u : 1u);
  }
}

TEST_F(Interrupt, WhileReadingLeavesNoChild) {
  // A reader that waits for a pipe that nobody writes to.
  ASSERT_EQ(::mkfifo(path("slow.vtk").c_str(), 0600), 0);
  const Running running = start({"render", "slow.vtk", "-o", "a.png"});
  wait(400);
  const std::vector<pid_t> children = children_of(running.pid);
  ::kill(running.pid, SIGINT);
  const Result result = finish(running, 5.0);
  // A file that is no regular one may also be refused right away.
  EXPECT_TRUE(result.code == 130 || result.code == 1) << result.code << " " << result.err;
  wait(100);
  for (const pid_t child : children) EXPECT_NE(::kill(child, 0), 0) << "process " << child << " is left";
  EXPECT_FALSE(std::filesystem::exists(path("a.png")));
}

}  // namespace
}  // namespace tetravox::cli
