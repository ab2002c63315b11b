// Damaged and hostile files: every one must end in an error that names a file and takes one line, or, where only values
// changed, in a mesh that keeps all promises (read_dataset has validated it); within seconds, and the test survives.

#include "tests/unit/io/damage.h"
#include "tests/unit/io/sample_files.h"
#include "tetravox/error.h"
#include "tetravox/io.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <random>

namespace tetravox {

namespace {

namespace fs = std::filesystem;
using test::Case;
using test::check_all;
using test::check_hostile;
using test::cut_positions;
using test::Hostile;
using test::make_case;
using test::Outcome;
using test::read_case;
using test::Sample;
using test::TemporaryDirectory;

class Malformed : public testing::TestWithParam<Sample> {
 protected:
  void SetUp() override {
    const Outcome outcome = read_case(test::whole_case(GetParam(), directory_.path() / "whole"));
    ASSERT_FALSE(outcome.error) << outcome.error->what();
    whole_ = outcome.dataset;
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
  sample_.write = [](const fs::path&) {};
  const Outcome whole = read_case(test::whole_case(sample_, directory_.path() / "whole"));
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

const Hostile kHostile[] = {
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

TEST(MalformedText, HostileReplacementsFail) { check_hostile(kHostile, test::samples()); }

}  // namespace

}  // namespace tetravox
