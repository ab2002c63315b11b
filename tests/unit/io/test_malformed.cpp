// Damaged and hostile files: every one must end in an error that names a file and takes one line, or, where only values
// changed, in a mesh that keeps all promises (read_dataset has validated it); within seconds, and the test survives.

#include "src/support/timer.h"
#include "tests/unit/io/sample_files.h"
#include "tetravox/error.h"
#include "tetravox/io.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <mutex>
#include <optional>
#include <random>
#include <thread>

namespace tetravox {

namespace {

namespace fs = std::filesystem;
using test::Sample;
using test::TemporaryDirectory;

constexpr double kSlowest = 10.0;  // seconds for one file, on a busy machine
constexpr std::uint64_t kMemory = std::uint64_t{1} << 30;

/// One damaged file: where it lies, and what the tests need to know.
struct Case {
  std::string name;
  std::string file;
  std::string solution_file;
  bool must_fail_or_equal = false;  ///< truncated: an error, or exactly the undamaged mesh
};

/// What became of a case.
struct Outcome {
  std::optional<Dataset> dataset;
  std::optional<Error> error;
  double seconds = 0.0;
};

Outcome read_case(const Case& damaged) {
  ReadOptions options;
  options.grid_file = damaged.solution_file;
  options.timeout = kSlowest;
  options.memory_limit = kMemory;
  Outcome outcome;
  const support::Timer timer;
  try {
    outcome.dataset = read_dataset(damaged.file, options);
  } catch (const Error& error) {
    outcome.error = error;
  }
  outcome.seconds = timer.seconds();
  return outcome;
}

bool are_equal(const Dataset& a, const Dataset& b) {
  const auto equal = [](const auto& x, const auto& y) { return std::equal(x.begin(), x.end(), y.begin(), y.end()); };
  return equal(a.mesh.points, b.mesh.points) && equal(a.mesh.cell_types, b.mesh.cell_types) &&
         equal(a.mesh.connectivity, b.mesh.connectivity) && equal(a.mesh.scalars, b.mesh.scalars) &&
         a.info.arrays.size() == b.info.arrays.size();
}

void check_outcome(const Case& damaged, const Outcome& outcome, const std::optional<Dataset>& whole) {
  EXPECT_LT(outcome.seconds, kSlowest) << damaged.name;
  if (outcome.error) {
    const std::string message = outcome.error->what();
    EXPECT_NE(message.find(fs::path(damaged.file).parent_path().string()), std::string::npos)
        << damaged.name << ": names no file: " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << damaged.name << ": more than a line: " << message;
    EXPECT_NE(outcome.error->code(), ErrorCode::kInternal) << damaged.name << ": " << message;
    EXPECT_NE(outcome.error->code(), ErrorCode::kTimeout) << damaged.name << ": " << message;
  } else if (damaged.must_fail_or_equal && whole) {
    EXPECT_TRUE(are_equal(*outcome.dataset, *whole)) << damaged.name << ": a partial mesh came";
  }
}

/// Reads all cases, two at a time, and checks what became of them.
void check_all(const std::vector<Case>& cases, const std::optional<Dataset>& whole) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  const auto work = [&] {
    for (std::size_t i; (i = next++) < cases.size();) {
      const Outcome outcome = read_case(cases[i]);
      const std::lock_guard lock(mutex);
      check_outcome(cases[i], outcome, whole);
    }
  };
  std::thread other(work);
  work();
  other.join();
}

/// A copy of the undamaged files with one of them replaced.
Case make_case(const Sample& sample, const fs::path& whole, const fs::path& parent, const std::string& name,
               const std::string& victim, const std::string& content) {
  const fs::path directory = parent / name;
  fs::copy(whole, directory, fs::copy_options::recursive);
  test::write_text(directory / victim, content);
  Case damaged;
  damaged.name = sample.name + " " + victim + " " + name;
  damaged.file = (directory / sample.main_file).string();
  if (!sample.solution_file.empty()) damaged.solution_file = (directory / sample.solution_file).string();
  return damaged;
}

std::vector<std::size_t> cut_positions(std::size_t size, std::size_t count) {
  std::vector<std::size_t> cuts;
  for (std::size_t i = 0; i < count; ++i) cuts.push_back(size * i / count);
  for (const std::size_t from_end : {1, 3, 9, 21})
    if (from_end < size) cuts.push_back(size - from_end);
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  return cuts;
}

class Malformed : public testing::TestWithParam<Sample> {
 protected:
  void SetUp() override {
    GetParam().write(directory_.path() / "whole");
    Case undamaged;
    undamaged.file = (directory_.path() / "whole" / GetParam().main_file).string();
    if (!GetParam().solution_file.empty())
      undamaged.solution_file = (directory_.path() / "whole" / GetParam().solution_file).string();
    Outcome outcome = read_case(undamaged);
    ASSERT_FALSE(outcome.error) << outcome.error->what();
    whole_ = std::move(outcome.dataset);
  }

  Case damage(const std::string& name, const std::string& victim, const std::string& content) {
    return make_case(GetParam(), directory_.path() / "whole", directory_.path(), name, victim, content);
  }
  std::string content(const std::string& victim) const {
    return test::read_text((directory_.path() / "whole" / victim).string());
  }

  TemporaryDirectory directory_;
  std::optional<Dataset> whole_;
};

TEST_P(Malformed, TruncatedFilesNeverGiveAPartialMesh) {
  std::vector<Case> cases;
  for (const std::string& victim : GetParam().victims) {
    const std::string text = content(victim);
    const std::size_t cuts = GetParam().victims.size() > 2 ? 5 : 10;
    for (const std::size_t cut : cut_positions(text.size(), cuts)) {
      cases.push_back(
          damage(fs::path(victim).filename().string() + "-cut-" + std::to_string(cut), victim, text.substr(0, cut)));
      cases.back().must_fail_or_equal = true;
    }
  }
  check_all(cases, whole_);
}

TEST_P(Malformed, FlippedBitsGiveAnErrorOrAValidMesh) {
  std::mt19937 random(20240501);
  std::vector<Case> cases;
  for (const std::string& victim : GetParam().victims) {
    const std::string text = content(victim);
    const int flips = GetParam().victims.size() > 2 ? 4 : 12;
    for (int i = 0; i < flips && !text.empty(); ++i) {
      std::string damaged = text;
      for (int k = 0; k <= i % 3; ++k) {
        const std::size_t at = random() % text.size();
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
      }
      cases.push_back(damage(fs::path(victim).filename().string() + "-flip-" + std::to_string(i), victim, damaged));
    }
  }
  check_all(cases, std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(All, Malformed, testing::ValuesIn(test::samples()),
                         [](const auto& instance) { return instance.param.name; });

/// Formats that are too intricate to write here: public files, where they are.
class MalformedPublic : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const fs::path file = fs::path(TETRAVOX_SHARED_DIR) / "data" / GetParam();
    if (!fs::exists(file)) GTEST_SKIP() << "no " << file;
    fs::create_directories(directory_.path() / "whole");
    text_ = test::read_text(file.string());
    sample_.name = sample_.main_file = GetParam();
    test::write_text(directory_.path() / "whole" / GetParam(), text_);
  }
  Case damage(const std::string& name, const std::string& content) {
    return make_case(sample_, directory_.path() / "whole", directory_.path(), name, GetParam(), content);
  }

  TemporaryDirectory directory_;
  Sample sample_;
  std::string text_;
};

TEST_P(MalformedPublic, TruncatedFilesNeverGiveAPartialMesh) {
  Case undamaged;
  undamaged.file = (directory_.path() / "whole" / GetParam()).string();
  const Outcome whole = read_case(undamaged);
  ASSERT_TRUE(whole.dataset);
  std::vector<Case> cases;
  for (const std::size_t cut : cut_positions(text_.size(), 10)) {
    cases.push_back(damage("cut-" + std::to_string(cut), text_.substr(0, cut)));
    cases.back().must_fail_or_equal = true;
  }
  check_all(cases, whole.dataset);
}

TEST_P(MalformedPublic, FlippedBitsGiveAnErrorOrAValidMesh) {
  std::mt19937 random(20240502);
  std::vector<Case> cases;
  for (int i = 0; i < 24; ++i) {
    std::string damaged = text_;
    // Half of them in the beginning, where the structure is.
    const std::size_t reach = i % 2 == 0 ? std::min<std::size_t>(4096, text_.size()) : text_.size();
    for (int k = 0; k < 8; ++k) damaged[random() % reach] ^= static_cast<char>(1 << random() % 8);
    cases.push_back(damage("flip-" + std::to_string(i), damaged));
  }
  check_all(cases, std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(All, MalformedPublic,
                         testing::Values("disk_out_ref.ex2", "sqnz_s.adf.cgns", "can.vtu", "bluntfin.vts",
                                         "notch_stress_fixed.vtk"),
                         [](const auto& instance) {
                           std::string name = instance.param;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

/// A replacement in a text sample that must end in an error.
struct Hostile {
  const char* sample;
  const char* victim;
  const char* from;
  const char* to;
};

constexpr Hostile kHostile[] = {
    {"vtu", "mesh.vtu", "NumberOfPoints=\"12\"", "NumberOfPoints=\"11\""},
    {"vtu", "mesh.vtu", "NumberOfPoints=\"12\"", "NumberOfPoints=\"13\""},
    {"vtu", "mesh.vtu", "NumberOfPoints=\"12\"", "NumberOfPoints=\"-1\""},
    {"vtu", "mesh.vtu", "NumberOfPoints=\"12\"", "NumberOfPoints=\"99999999999999\""},
    {"vtu", "mesh.vtu", "NumberOfCells=\"2\"", "NumberOfCells=\"9223372036854775807\""},
    {"vtu", "mesh.vtu", "NumberOfCells=\"2\"", "NumberOfCells=\"3\""},
    {"vtu", "mesh.vtu", "NumberOfCells=\"2\"", "NumberOfCells=\"-2\""},
    {"vtu", "mesh.vtu", ">8 16<", ">16 8<"},
    {"vtu", "mesh.vtu", ">8 16<", ">8 17<"},
    {"vtu", "mesh.vtu", ">8 16<", ">-8 16<"},
    {"vtu", "mesh.vtu", ">8 16<", ">4 16<"},
    {"vtu", "mesh.vtu", ">12 12<", ">12 99<"},
    {"vtu", "mesh.vtu", ">12 12<", ">12 42<"},
    {"vtu", "mesh.vtu", ">12 12<", ">12 13 12<"},
    {"vtu", "mesh.vtu", "0 1 4 3", "0 1 4 12"},
    {"vtu", "mesh.vtu", "0 1 4 3", "0 1 4 -3"},
    {"vtu", "mesh.vtu", "0 1 4 3", "0 1 4 9223372036854775807"},
    {"vtu", "mesh.vtu", "\n2 1 1\n", "\n2 1 nan\n"},
    {"vtu", "mesh.vtu", "\n2 1 1\n", "\n2 1 inf\n"},
    {"vtu", "mesh.vtu", "0 1 2 3 4 5 6 7 8 9 10 11<", "0 1 2 3 4 5 6 7 8 9 10<"},
    {"vtu", "mesh.vtu", "type=\"Float64\" N", "type=\"Float77\" N"},
    {"vtu", "mesh.vtu", "NumberOfComponents=\"3\"", "NumberOfComponents=\"300000000\""},
    {"vtu_polyhedra", "mesh.vtu", "31 62", "31 31"},
    {"vtu_polyhedra", "mesh.vtu", "31 62", "31 99999"},
    {"vtu_polyhedra", "mesh.vtu", "6 4 0", "7 4 0"},
    {"vtu_polyhedra", "mesh.vtu", "6 4 0", "6 5 0"},
    {"vtu_polyhedra", "mesh.vtu", "6 4 0", "6 4 12"},
    {"vtu_polyhedra", "mesh.vtu", "6 4 0", "-6 4 0"},
    {"vtu_polyhedra", "mesh.vtu", "6 4 0", "6 -4 0"},
    {"vtu_appended", "mesh.vtu", "offset=\"0\"", "offset=\"1000000\""},
    {"vtu_appended", "mesh.vtu", "offset=\"0\"", "offset=\"-8\""},
    {"vts", "mesh.vts", "<Piece Extent=\"0 2 0 1 0 1\"", "<Piece Extent=\"0 3 0 1 0 1\""},
    {"vts", "mesh.vts", "<Piece Extent=\"0 2 0 1 0 1\"", "<Piece Extent=\"0 -2 0 1 0 1\""},
    {"vts", "mesh.vts", "WholeExtent=\"0 2 0 1 0 1\"", "WholeExtent=\"0 2 0 2 0 1\""},
    {"vts", "mesh.vts", "WholeExtent=\"0 2 0 1 0 1\"", "WholeExtent=\"0 2000000000 0 2000000000 0 1\""},
    {"vtr", "mesh.vtr", "\"x\" format=\"ascii\">0 1 2<", "\"x\" format=\"ascii\">0 1<"},
    {"vtr", "mesh.vtr", "\"x\" format=\"ascii\">0 1 2<", "\"x\" format=\"ascii\">0 1 nan<"},
    {"pvtu", "mesh.pvtu", "piece_1.vtu", "missing.vtu"},
    {"pvtu", "mesh.pvtu", "piece_1.vtu", "mesh.pvtu"},
    {"pvtu", "mesh.pvtu", "piece_1.vtu", ""},
    {"vtm", "mesh.vtm", "parts/b.vtu", "mesh.vtm"},
    {"vtm", "mesh.vtm", "parts/b.vtu", "parts"},
    {"vtm", "mesh.vtm", "parts/b.vtu", "/dev/zero"},
    {"pvd", "mesh.pvd", "b.vtu", "mesh.pvd"},
    {"pvd", "mesh.pvd", "b.vtu", "../../../../../../etc"},
    {"pvd", "mesh.pvd", "timestep=\"0\"", "timestep=\"zero\""},
    {"pvd", "mesh.pvd", "timestep=\"0\"", "timestep=\"nan\""},
    {"legacy_text", "mesh.vtk", "POINTS 12", "POINTS 11"},
    {"legacy_text", "mesh.vtk", "POINTS 12", "POINTS -12"},
    {"legacy_text", "mesh.vtk", "POINTS 12", "POINTS 999999999999"},
    {"legacy_text", "mesh.vtk", "CELLS 2 18", "CELLS 3 18"},
    {"legacy_text", "mesh.vtk", "CELLS 2 18", "CELLS 2 19"},
    {"legacy_text", "mesh.vtk", "CELLS 2 18", "CELLS 2000000000 18"},
    {"legacy_text", "mesh.vtk", "8 0 1 4", "9 0 1 4"},
    {"legacy_text", "mesh.vtk", "8 0 1 4", "8 0 1 -4"},
    {"legacy_text", "mesh.vtk", "8 0 1 4", "8 0 1 44"},
    {"legacy_text", "mesh.vtk", "CELL_TYPES 2", "CELL_TYPES 1"},
    {"legacy_text", "mesh.vtk", "POINT_DATA 12", "POINT_DATA 24"},
    {"legacy_text", "mesh.vtk", "SCALARS S float 1", "SCALARS S float 100000000"},
    {"legacy_structured", "mesh.vtk", "DIMENSIONS 3 2 2", "DIMENSIONS 3 2 3"},
    {"legacy_structured", "mesh.vtk", "DIMENSIONS 3 2 2", "DIMENSIONS 100000 100000 100000"},
    {"legacy_structured", "mesh.vtk", "DIMENSIONS 3 2 2", "DIMENSIONS -3 -2 2"},
    {"legacy_rectilinear", "mesh.vtk", "X_COORDINATES 3", "X_COORDINATES 2"},
    {"ucd_text", "mesh.inp", "12 2 1 1 0", "13 2 1 1 0"},
    {"ucd_text", "mesh.inp", "12 2 1 1 0", "-12 2 1 1 0"},
    {"ucd_text", "mesh.inp", "12 2 1 1 0", "2000000000 2 1 1 0"},
    {"ucd_text", "mesh.inp", "12 2 1 1 0", "12 3 1 1 0"},
    {"ucd_text", "mesh.inp", "12 2 1 1 0", "12 2 2 1 0"},
    {"ucd_text", "mesh.inp", "1 hex 1", "1 hex 0"},
    {"ucd_text", "mesh.inp", "1 hex 1", "1 hex 13"},
    {"ucd_text", "mesh.inp", "1 hex 1", "1 hexagon 1"},
    {"ucd_text", "mesh.inp", "S, none", "S none"},
    {"ensight", "mesh.case", "mesh.geo", "missing.geo"},
    {"ensight", "mesh.case", "S.****", "T.****"},
    {"ensight", "mesh.geo", "        12\n", "        13\n"},
    {"ensight", "mesh.geo", "hexa8\n         2", "hexa8\n         3"},
    {"ensight", "mesh.geo", "hexa8\n         2", "hexa8\n        -2"},
    {"ensight", "mesh.geo", "         1         2", "        99         2"},
    {"openfoam", "constant/polyMesh/points", "12\n", "13\n"},
    {"openfoam", "constant/polyMesh/points", "12\n", "-12\n"},
    {"openfoam", "constant/polyMesh/points", "12\n", "999999999\n"},
    {"openfoam", "constant/polyMesh/faces", "4(1 4 10 7)", "4(1 4 10 77)"},
    {"openfoam", "constant/polyMesh/faces", "4(1 4 10 7)", "400000000(1 4 10 7)"},
    {"openfoam", "constant/polyMesh/owner", "0 0 0 0", "0 -7 0 0"},
    {"openfoam", "constant/polyMesh/owner", "0 0 0 0", "0 2000000000 0 0"},
    {"openfoam", "0/C", "2\n(\n5\n7\n)", "3\n(\n5\n7\n6\n)"},
    {"openfoam", "0/C", "2\n(\n5\n7\n)", "1\n(\n5\n)"},
    {"plot3d_text", "mesh.xyz", "3 2 2", "3 2 3"},
    {"plot3d_text", "mesh.xyz", "3 2 2", "-3 2 2"},
    {"plot3d_text", "mesh.xyz", "3 2 2", "2000000000 2000000000 2"},
    {"plot3d_text", "mesh.q", "3 2 2", "3 3 2"},
};

TEST(MalformedText, HostileReplacementsFail) {
  const TemporaryDirectory directory;
  std::vector<Case> cases;
  for (const Hostile& hostile : kHostile) {
    const auto sample = std::find_if(test::samples().begin(), test::samples().end(),
                                     [&](const Sample& s) { return s.name == hostile.sample; });
    ASSERT_NE(sample, test::samples().end()) << hostile.sample;
    const fs::path whole = directory.path() / ("whole-" + sample->name);
    if (!fs::exists(whole)) sample->write(whole);
    std::string text = test::read_text((whole / hostile.victim).string());
    const std::size_t at = text.find(hostile.from);
    ASSERT_NE(at, std::string::npos) << hostile.sample << ": no " << hostile.from;
    text.replace(at, std::string(hostile.from).size(), hostile.to);
    cases.push_back(
        make_case(*sample, whole, directory.path(), "hostile-" + std::to_string(cases.size()), hostile.victim, text));
    cases.back().name += std::string(" '") + hostile.from + "' -> '" + hostile.to + "'";
  }
  std::vector<Outcome> outcomes(cases.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i; (i = next++) < cases.size();) outcomes[i] = read_case(cases[i]);
  };
  std::thread other(work);
  work();
  other.join();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    EXPECT_TRUE(outcomes[i].error) << cases[i].name << ": was read as if nothing were wrong";
    check_outcome(cases[i], outcomes[i], std::nullopt);
  }
}

}  // namespace

}  // namespace tetravox
