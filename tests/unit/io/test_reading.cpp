// What read_dataset promises beyond formats: times, blocks, ghosts, fields, errors, and the reader process.

#include "src/io/validate_mesh.h"
#include "src/support/timer.h"
#include "tests/unit/io/sample_files.h"
#include "tetravox/error.h"
#include "tetravox/io.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <thread>

namespace tetravox {

namespace {

namespace fs = std::filesystem;
using test::TemporaryDirectory;

void write_sample(const char* name, const TemporaryDirectory& directory) {
  for (const test::Sample& sample : test::samples())
    if (sample.name == name) return sample.write(directory.path());
  FAIL() << "no sample " << name;
}

/// The error that reading ends in.
Error error_of(const std::string& path, const ReadOptions& options = {}, const Progress& progress = {}) {
  try {
    read_dataset(path, options, progress);
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << path << " was read";
  return Error(ErrorCode::kInternal, "");
}

bool contains(const Error& error, const std::string& words) {
  return std::string(error.what()).find(words) != std::string::npos;
}

TEST(Times, PvdStepsByIndexAndValue) {
  const TemporaryDirectory directory;
  write_sample("pvd", directory);
  ReadOptions options;
  EXPECT_EQ(read_dataset(directory.file("mesh.pvd"), options).info.cell_count, 4u);
  options.time.index = 1;
  const Dataset second = read_dataset(directory.file("mesh.pvd"), options);
  EXPECT_EQ(second.info.cell_count, 2u);
  EXPECT_EQ(second.info.times, (std::vector<double>{0.0, 0.5}));
  EXPECT_EQ(second.info.time_index, 1u);
  options.time = {{}, 0.4};
  EXPECT_EQ(read_dataset(directory.file("mesh.pvd"), options).info.time_index, 1u);
  options.time = {2, {}};
  EXPECT_TRUE(contains(error_of(directory.file("mesh.pvd"), options), "steps 0 to 1"));
}

TEST(Times, EnSightAndOpenFoam) {
  for (const char* name : {"ensight", "openfoam"}) {
    const TemporaryDirectory directory;
    write_sample(name, directory);
    ReadOptions options;
    options.time.value = 0.5;
    const std::string file = directory.file(std::string(name) == "ensight" ? "mesh.case" : "case.foam");
    const Dataset dataset = read_dataset(file, options);
    EXPECT_EQ(dataset.info.times, (std::vector<double>{0.0, 0.5})) << name;
    EXPECT_EQ(dataset.info.time_index, 1u) << name;
  }
}

TEST(OpenFoam, CaseDirectoryAndControlDict) {
  const TemporaryDirectory directory;
  write_sample("openfoam", directory);
  EXPECT_EQ(read_dataset(directory.path().string()).info.cell_count, 2u);
  EXPECT_EQ(read_dataset(directory.file("system/controlDict")).info.cell_count, 2u);
}

TEST(Plot3d, FindsTheSolutionBesideTheGrid) {
  const TemporaryDirectory directory;
  write_sample("plot3d_single", directory);
  const Dataset dataset = read_dataset(directory.file("mesh.xyz"));
  EXPECT_EQ(dataset.mesh.array_name, "Density");
  ASSERT_FALSE(dataset.info.notes.empty());
  EXPECT_NE(dataset.info.notes.front().find("mesh.q"), std::string::npos);
}

TEST(Blocks, ArraysThatSomeLackAreMissingThere) {
  const TemporaryDirectory directory;
  write_sample("vtm", directory);
  std::string text = test::read_text(directory.file("parts/b.vtu"));
  text.replace(text.find("Name=\"S\""), 8, "Name=\"T\"");
  test::write_text(directory.file("parts/b.vtu"), text);
  ReadOptions options;
  options.array.name = "S";
  const Dataset dataset = read_dataset(directory.file("mesh.vtm"), options);
  EXPECT_EQ(dataset.info.block_count, 2u);
  ASSERT_EQ(dataset.mesh.scalars.size(), 24u);
  EXPECT_EQ(dataset.mesh.scalars[11], 11.0);
  EXPECT_TRUE(std::isnan(dataset.mesh.scalars[12]));
  EXPECT_EQ(dataset.info.arrays.front().nan_count, 12u);
  EXPECT_NE(dataset.info.notes.front().find("missing in 1 of 2 blocks"), std::string::npos);
}

TEST(LeftOut, GhostBlankedLowerDimensionAndUnsupported) {
  const TemporaryDirectory directory;
  const auto marked = [](const char* marks) {
    return test::vtu_text(std::string("<DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">") + marks +
                          "</DataArray>");
  };
  test::write_text(directory.file("ghost.vtu"), marked("1 0"));
  test::write_text(directory.file("hidden.vtu"), marked("0 32"));
  const Dataset ghost = read_dataset(directory.file("ghost.vtu"));
  EXPECT_EQ(ghost.info.left_out.ghost, 1u);
  EXPECT_DOUBLE_EQ(ghost.info.bounds[0].min, 1.0);
  EXPECT_DOUBLE_EQ(ghost.info.arrays.front().component_ranges[0].min, 1.0);  // Point 0 is of no cell that is drawn.
  EXPECT_EQ(read_dataset(directory.file("hidden.vtu")).info.left_out.blanked, 1u);

  std::string text = test::vtu_text();
  const auto with_types = [&](const char* types) {
    std::string out = text;
    out.replace(out.find("12 12<"), 5, types);
    return out;
  };
  test::write_text(directory.file("flat.vtu"), with_types("12 7"));
  test::write_text(directory.file("lagrange.vtu"), with_types("12 72"));
  test::write_text(directory.file("all_lagrange.vtu"), with_types("72 72"));
  EXPECT_EQ(read_dataset(directory.file("flat.vtu")).info.left_out.lower_dimension, 1u);
  EXPECT_EQ(read_dataset(directory.file("lagrange.vtu")).info.left_out.unsupported, 1u);
  EXPECT_EQ(error_of(directory.file("all_lagrange.vtu")).code(), ErrorCode::kUnsupported);
}

TEST(Fields, UnknownArrayListsWhatThereIs) {
  const TemporaryDirectory directory;
  test::write_text(directory.file("a.vtu"), test::vtu_text());
  ReadOptions options;
  options.array.name = "nothing";
  const Error error = error_of(directory.file("a.vtu"), options);
  EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
  EXPECT_TRUE(contains(error, "S") && contains(error, "C")) << error.what();
}

TEST(Fields, ComponentsAndMagnitude) {
  const TemporaryDirectory directory;
  test::write_text(directory.file("a.vtu"),
                   test::vtu_text("<DataArray type=\"Float64\" Name=\"V\" NumberOfComponents=\"3\" "
                                  "format=\"ascii\">3 4 0 0 0 -2</DataArray>"));
  ReadOptions options;
  options.array.name = "V";
  const Dataset magnitude = read_dataset(directory.file("a.vtu"), options);
  EXPECT_EQ(magnitude.mesh.component, kMagnitude);
  EXPECT_EQ(std::vector<double>(magnitude.mesh.scalars.begin(), magnitude.mesh.scalars.end()),
            (std::vector<double>{5, 2}));
  options.array.component = 2;
  const Dataset third = read_dataset(directory.file("a.vtu"), options);
  EXPECT_EQ(std::vector<double>(third.mesh.scalars.begin(), third.mesh.scalars.end()), (std::vector<double>{0, -2}));
  options.array.component = 3;
  EXPECT_EQ(error_of(directory.file("a.vtu"), options).code(), ErrorCode::kInvalidArgument);
}

TEST(Refusals, FilesThatCannotBeRead) {
  const TemporaryDirectory directory;
  EXPECT_EQ(error_of(directory.file("missing.vtu")).code(), ErrorCode::kFileNotFound);
  EXPECT_EQ(error_of(directory.path().string()).code(), ErrorCode::kUnsupported);
  test::write_text(directory.file("empty.vtu"), "");
  EXPECT_TRUE(contains(error_of(directory.file("empty.vtu")), "is empty"));
  test::write_text(directory.file("a.txt"), "hello");
  EXPECT_TRUE(contains(error_of(directory.file("a.txt")), ".vtu"));
  test::write_text(directory.file("a.vtu"), "hello");
  EXPECT_EQ(error_of(directory.file("a.vtu")).code(), ErrorCode::kBadFile);
  test::write_text(directory.file("a.vti"), "<VTKFile type=\"ImageData\"></VTKFile>");
  EXPECT_EQ(error_of(directory.file("a.vti")).code(), ErrorCode::kBadFile);
  test::write_text(directory.file("a.vthb"), "<VTKFile type=\"vtkOverlappingAMR\"></VTKFile>");
  EXPECT_TRUE(contains(error_of(directory.file("a.vthb")), "AMR"));
  ASSERT_EQ(mkfifo(directory.file("pipe.vtu").c_str(), 0600), 0);
  EXPECT_EQ(error_of(directory.file("pipe.vtu")).code(), ErrorCode::kBadFile);
  EXPECT_EQ(error_of("builtin:nothing").code(), ErrorCode::kInvalidArgument);
}

TEST(Refusals, FileWithoutPermission) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  const TemporaryDirectory directory;
  test::write_text(directory.file("a.vtu"), test::vtu_text());
  fs::permissions(directory.file("a.vtu"), fs::perms::none);
  EXPECT_EQ(error_of(directory.file("a.vtu")).code(), ErrorCode::kFileNotFound);
}

TEST(Content, TellsMoreThanTheEnding) {
  const TemporaryDirectory directory;
  test::write_text(directory.file("mesh.dat"), test::vtu_text());
  EXPECT_EQ(read_dataset(directory.file("mesh.dat")).info.cell_count, 2u);
}

TEST(Builtin, ComesWithItsField) {
  ReadOptions options;
  options.array.name = "nothing";
  EXPECT_EQ(error_of("builtin:sphere", options).code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(read_dataset("builtin:sphere").mesh.cell_count(), 2560u);
  options.array.name.clear();
  options.only_info = true;
  EXPECT_EQ(read_dataset("builtin:sphere", options).mesh.cell_count(), 0u);
}

/// A program in place of the reader.
class FakeReader : public testing::Test {
 protected:
  void use(const std::string& script) {
    const std::string program = directory_.file("reader");
    test::write_text(program, "#!/bin/sh\n" + script + "\n");
    fs::permissions(program, fs::perms::owner_all);
    setenv("TETRAVOX_READER", program.c_str(), 1);
    test::write_text(file_, test::vtu_text());
  }
  void TearDown() override { unsetenv("TETRAVOX_READER"); }

  TemporaryDirectory directory_;
  std::string file_ = directory_.file("a.vtu");
};

TEST_F(FakeReader, ThatHangsIsEnded) {
  use("exec sleep 100");
  ReadOptions options;
  options.timeout = 0.3;
  const support::Timer timer;
  const Error error = error_of(file_, options);
  EXPECT_EQ(error.code(), ErrorCode::kTimeout);
  EXPECT_TRUE(contains(error, file_));
  EXPECT_LT(timer.seconds(), 5.0);
}

TEST_F(FakeReader, IsEndedWhenTheUserCancels) {
  use("exec sleep 100");
  std::atomic<bool> cancelled{false};
  std::thread user([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    cancelled = true;
  });
  Progress progress;
  progress.cancelled = &cancelled;
  const support::Timer timer;
  EXPECT_EQ(error_of(file_, {}, progress).code(), ErrorCode::kCancelled);
  EXPECT_LT(timer.seconds(), 5.0);
  user.join();
}

TEST_F(FakeReader, ThatCrashesIsAnError) {
  use("kill -SEGV $$");
  const Error error = error_of(file_);
  EXPECT_EQ(error.code(), ErrorCode::kReaderFailed);
  EXPECT_TRUE(contains(error, file_) && contains(error, "Segmentation fault")) << error.what();
}

TEST_F(FakeReader, ThatIsKilledLacksMemory) {
  use("kill -KILL $$");
  EXPECT_EQ(error_of(file_).code(), ErrorCode::kOutOfMemory);
}

TEST_F(FakeReader, ThatSaysNothingOrNonsense) {
  for (const char* script : {"exit 0", "exit 3", "echo done >&3", "echo done >&3; head -c 4096 /dev/urandom >&4",
                             "echo error 99 boo >&3", "echo error x >&3; exit 1"}) {
    use(script);
    EXPECT_EQ(error_of(file_).code(), ErrorCode::kReaderFailed) << script;
  }
}

TEST_F(FakeReader, ThatComplainsOnItsErrorStream) {
  use("echo 'HDF5-DIAG: Error detected' >&2; echo done >&3");
  EXPECT_TRUE(contains(error_of(file_), "HDF5-DIAG"));
}

TEST_F(FakeReader, ThatIsMissingIsNamed) {
  use("");
  setenv("TETRAVOX_READER", "/nowhere/reader", 1);
  EXPECT_TRUE(contains(error_of(file_), "/nowhere/reader"));
}

TEST(ReaderProcess, KeepsToItsMemory) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers map terabytes, which no limit allows";
#endif
  const TemporaryDirectory directory;
  test::write_text(directory.file("a.vtu"), test::vtu_text());
  ReadOptions options;
  options.memory_limit = 1 << 20;
  const Error error = error_of(directory.file("a.vtu"), options);
  EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory) << error.what();
}

TEST(ReaderProcess, ReportsProgress) {
  const TemporaryDirectory directory;
  test::write_text(directory.file("a.vtu"), test::vtu_text());
  double last = -1.0;
  Progress progress;
  progress.report = [&](std::string_view step, double fraction) {
    EXPECT_EQ(step, "read");
    EXPECT_GE(fraction, last);
    last = fraction;
  };
  read_dataset(directory.file("a.vtu"), {}, progress);
  EXPECT_EQ(last, 1.0);
}

/// One tetrahedron, to be damaged.
struct TetrahedronMesh {
  std::vector<double> points{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::vector<CellType> types{CellType::kTetrahedron};
  std::vector<std::uint64_t> offsets{0, 4};
  std::vector<std::uint32_t> connectivity{0, 1, 2, 3};
  std::vector<double> scalars{0, 1, 2, 3};

  std::string problem() const {
    MeshData mesh;
    mesh.points = points;
    mesh.cell_types = types;
    mesh.cell_offsets = offsets;
    mesh.connectivity = connectivity;
    mesh.scalars = scalars;
    try {
      io::validate_mesh(mesh, "file");
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }
};

TEST(ValidateMesh, NamesWhatIsWrong) {
  EXPECT_EQ(TetrahedronMesh().problem(), "");
  const auto problem = [](const auto& damage) {
    TetrahedronMesh mesh;
    damage(mesh);
    return mesh.problem();
  };
  using M = TetrahedronMesh&;
  EXPECT_NE(problem([](M m) { m.connectivity[2] = 4; }).find("cell 0: a point id"), std::string::npos);
  EXPECT_NE(problem([](M m) { m.points[7] = NAN; }).find("point 2: a coordinate"), std::string::npos);
  EXPECT_NE(problem([](M m) { m.types[0] = static_cast<CellType>(9); }).find("unknown cell type 9"), std::string::npos);
  EXPECT_NE(problem([](M m) { m.types[0] = CellType::kHexahedron; }).find("needs 8"), std::string::npos);
  EXPECT_NE(problem([](M m) { m.offsets[1] = 3; }).find("offsets"), std::string::npos);
  EXPECT_NE(problem([](M m) { m.offsets.pop_back(); }).find("offsets"), std::string::npos);
  EXPECT_NE(problem([](M m) { m.scalars.pop_back(); }).find("3 values instead of 4"), std::string::npos);
  EXPECT_NE(problem([](M m) { m.points.pop_back(); }).find("triples"), std::string::npos);
}

TEST(ValidateMesh, FaceStreams) {
  TetrahedronMesh mesh;
  mesh.types[0] = CellType::kPolyhedron;
  mesh.connectivity = {4, 3, 0, 2, 1, 3, 0, 1, 3, 3, 1, 2, 3, 3, 2, 0, 3};
  mesh.offsets[1] = mesh.connectivity.size();
  EXPECT_EQ(mesh.problem(), "");
  for (const auto& [at, value] :
       {std::pair{0, 5u}, {0, 3u}, {0, 0xFFFFFFFFu}, {1, 4u}, {1, 0xFFFFFFFFu}, {2, 4u}, {13, 2u}}) {
    TetrahedronMesh damaged = mesh;
    damaged.connectivity[static_cast<std::size_t>(at)] = value;
    EXPECT_NE(damaged.problem().find("polyhedron"), std::string::npos) << at << " " << value;
  }
}

}  // namespace

}  // namespace tetravox
