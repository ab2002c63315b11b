// Damaged and hostile files of every format of grids; damage.h says what must become of them.

#include "tests/unit/io/damage.h"
#include "tests/unit/io/sample_grids.h"
#include "tetravox/io.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <random>

namespace tetravox {

namespace {

namespace fs = std::filesystem;
using test::Case;
using test::GridSample;
using test::Hostile;
using test::TemporaryDirectory;

class MalformedGrid : public testing::TestWithParam<GridSample> {
 protected:
  void SetUp() override {
    const test::Outcome outcome = test::read_case(test::whole_case(GetParam(), directory_.path() / "whole"));
    ASSERT_FALSE(outcome.error) << outcome.error->what();
    whole_ = outcome.dataset;
  }
  std::string content(const std::string& victim) const {
    return test::read_text((directory_.path() / "whole" / victim).string());
  }
  Case damage(const std::string& name, const std::string& victim, const std::string& content) {
    return test::make_case(GetParam(), directory_.path() / "whole", directory_.path(), name + "-" + victim, victim,
                           content);
  }

  TemporaryDirectory directory_;
  std::optional<Dataset> whole_;
};

TEST_P(MalformedGrid, TruncatedFilesNeverGiveAPartialGrid) {
  std::vector<Case> cases;
  for (const std::string& victim : GetParam().victims) {
    const std::string text = content(victim);
    for (const std::size_t cut : test::cut_positions(text.size(), 16)) {
      cases.push_back(damage("cut-" + std::to_string(cut), victim, text.substr(0, cut)));
      cases.back().must_fail_or_equal = true;
    }
  }
  const std::size_t errors = test::check_all(cases, whole_);
  EXPECT_GE(errors, cases.size() / 2);
}

TEST_P(MalformedGrid, FlippedBitsGiveAnErrorOrAValidGrid) {
  std::mt19937 random(20240601);
  std::vector<Case> cases;
  for (const std::string& victim : GetParam().victims) {
    const std::string text = content(victim);
    for (int i = 0; i < 24; ++i) {
      std::string damaged = text;
      // Half of them in the beginning, where the header is.
      const std::size_t reach = i % 2 == 0 ? std::min<std::size_t>(512, text.size()) : text.size();
      for (int k = 0; k <= i % 3; ++k) damaged[random() % reach] ^= static_cast<char>(1 << random() % 8);
      cases.push_back(damage("flip-" + std::to_string(i), victim, damaged));
    }
  }
  test::check_all(cases, std::nullopt);
}

TEST_P(MalformedGrid, BytesThatAreAllOnesGiveAnErrorOrAValidGrid) {
  std::vector<Case> cases;
  for (const std::string& victim : GetParam().victims) {
    const std::string text = content(victim);
    const std::size_t stride = std::max<std::size_t>(4, text.size() / 40 / 4 * 4);
    for (std::size_t at = 0; at + 4 <= text.size(); at += stride) {
      std::string damaged = text;
      damaged.replace(at, 4, "\xff\xff\xff\xff");
      cases.push_back(damage("ones-" + std::to_string(at), victim, damaged));
    }
  }
  test::check_all(cases, std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(All, MalformedGrid, testing::ValuesIn(test::grid_samples()),
                         [](const auto& instance) { return instance.param.name; });

/// The bytes of a number.
template <class T>
std::string bytes_of(T value) {
  std::string out;
  test::append_number(out, value);
  return out;
}

std::vector<Hostile> hostile_texts() {
  return {
      {"vti", "grid.vti", "Extent=\"0 3 0 2 0 4\" Origin", "Extent=\"0 3 0 2 0 5\" Origin"},
      {"vti", "grid.vti", "<Piece Extent=\"0 3 0 2 0 4\"", "<Piece Extent=\"0 3 0 2 0 3\""},
      {"vti", "grid.vti", "<Piece Extent=\"0 3 0 2 0 4\"", "<Piece Extent=\"0 3 0 2 4 0\""},
      {"vti", "grid.vti", "WholeExtent=\"0 3 0 2 0 4\"", "WholeExtent=\"0 2000000000 0 2000000000 0 4\""},
      {"vti", "grid.vti", "58 59 60", "58 59"},
      {"vti", "grid.vti", "58 59 60", "58 59 sixty"},
      {"vti", "grid.vti", "type=\"UInt8\"", "type=\"UInt8\" NumberOfComponents=\"2\""},
      {"vti_appended", "grid.vti", "offset=\"0\"", "offset=\"100000\""},
      {"pvti", "grid.pvti", "high.vti", "missing.vti"},
      {"pvti", "grid.pvti", "high.vti", "low.vti"},
      {"pvti", "grid.pvti", "high.vti", "grid.pvti"},
      {"pvti", "grid.pvti", "WholeExtent=\"0 3 0 2 0 4\"", "WholeExtent=\"0 3 0 2 0 6\""},
      {"pvti", "high.vti", "Spacing=\"0.5 1 2\"", "Spacing=\"0.5 1 3\""},
      {"pvti", "high.vti", "Name=\"S\"", "Name=\"T\""},
      {"pvti", "high.vti", "type=\"UInt8\"", "type=\"Int32\""},
      {"vtr", "grid.vtr", "10 10.5 11 11.5", "10 10.5 11"},
      {"vtr", "grid.vtr", "10 10.5 11 11.5", "10 10.5 11 nan"},
      {"legacy_text", "grid.vtk", "DIMENSIONS 4 3 5", "DIMENSIONS 4 3 6"},
      {"legacy_text", "grid.vtk", "DIMENSIONS 4 3 5", "DIMENSIONS -4 -3 5"},
      {"legacy_text", "grid.vtk", "DIMENSIONS 4 3 5", "DIMENSIONS 4000000 3000000 5000000"},
      {"legacy_text", "grid.vtk", "POINT_DATA 60", "POINT_DATA 50"},
      {"legacy_text", "grid.vtk", "57 58 59 60", "57 58 59"},
      {"legacy_text", "grid.vtk", "unsigned_char 1", "unsigned_char 100000000"},
      {"legacy_rectilinear", "grid.vtk", "X_COORDINATES 4", "X_COORDINATES 3"},
      {"nrrd", "grid.nrrd", "sizes: 4 3 5", "sizes: 4 3 6"},
      {"nrrd", "grid.nrrd", "sizes: 4 3 5", "sizes: 4 -3 5"},
      {"nrrd", "grid.nrrd", "sizes: 4 3 5", "sizes: 4 3"},
      {"nrrd", "grid.nrrd", "sizes: 4 3 5", "sizes: 4294967296 4294967296 4294967296"},
      {"nrrd", "grid.nrrd", "sizes: 4 3 5", "sizes: 2147483647 2147483647 2147483647"},
      {"nrrd", "grid.nrrd", "dimension: 3", "dimension: 17"},
      {"nrrd", "grid.nrrd", "type: short", "type: block"},
      {"nrrd", "grid.nrrd", "type: short", "type: double"},
      {"nrrd", "grid.nrrd", "encoding: raw", "encoding: bzip2"},
      {"nrrd", "grid.nrrd", "endian: big\n", ""},
      {"nrrd", "grid.nrrd", "endian: big", "line skip: 99999"},
      {"nrrd", "grid.nrrd", "endian: big", "endian: big\nbyte skip: 99999999999999999"},
      {"nrrd", "grid.nrrd", "(0.5,0,0)", "(0.5,0,x)"},
      {"nrrd", "grid.nrrd", "(0.5,0,0)", "(0.5,0,0"},
      {"nrrd_gzip", "grid.nrrd", "sizes: 4 3 5", "sizes: 4 3 6"},
      {"nrrd_gzip", "grid.nrrd", "sizes: 4 3 5", "sizes: 4000 3000 5000"},
      {"nrrd_text", "grid.nrrd", "sizes: 4 3 5", "sizes: 4 3 6"},
      {"nrrd_text", "grid.nrrd", "58 59", "58 fifty-nine"},
      {"nhdr", "grid.nhdr", "data file: grid.raw", "data file: missing.raw"},
      {"nhdr", "grid.nhdr", "data file: grid.raw", "data file: /dev/zero"},
      {"nhdr", "grid.nhdr", "data file: grid.raw", "data file: grid%d.raw 0 999999999999 1"},
      {"nhdr", "grid.nhdr", "data file: grid.raw", "data file: g%s%n.raw 0 1 1"},
      {"nhdr", "grid.nhdr", "data file: grid.raw", "data file: LIST"},
      {"mhd", "grid.mhd", "DimSize = 4 3 5", "DimSize = 4 3 6"},
      {"mhd", "grid.mhd", "DimSize = 4 3 5", "DimSize = 4 0 5"},
      {"mhd", "grid.mhd", "DimSize = 4 3 5", "DimSize = 4000000000 3000000000 5000000000"},
      {"mhd", "grid.mhd", "NDims = 3", "NDims = 2"},
      {"mhd", "grid.mhd", "MET_UCHAR", "MET_DOUBLE"},
      {"mhd", "grid.mhd", "MET_UCHAR", "MET_OTHER"},
      {"mhd", "grid.mhd", "= grid.raw", "= missing.raw"},
      {"mhd", "grid.mhd", "= grid.raw", "= LIST"},
      {"mhd", "grid.mhd", "ElementType", "ElementNumberOfChannels = 1000000\nElementType"},
      {"mhd", "grid.mhd", "ElementType", "HeaderSize = 1\nElementType"},
      {"mhd", "grid.mhd", "ElementType", "HeaderSize = 9223372036854775807\nElementType"},
      {"mhd", "grid.mhd", "0.5 1 2", "0.5 1"},
      {"mhd_compressed", "grid.mhd", "DimSize = 4 3 5", "DimSize = 4 3 6"},
      {"slc", "grid.slc", "4 3 5 8", "4 3 6 8"},
      {"slc", "grid.slc", "4 3 5 8", "4 -3 5 8"},
      {"slc", "grid.slc", "4 3 5 8", "4 3 5 16"},
      {"slc", "grid.slc", "4 3 5 8", "4000000 3000000 5000000 8"},
      {"slc", "grid.slc", "2 2 X", "2000000000 2000000000 X"},
      {"slc_runs", "grid.slc", "4 3 5 8", "4 4 5 8"},
      {"slc_runs", "grid.slc", "4 3 5 8", "4 2 5 8"},
      {"slc_runs", "grid.slc", "\x87", "\xff"},
      {"slc_runs", "grid.slc", "19 X", "99999 X"},
  };
}

std::vector<Hostile> hostile_binaries() {
  const auto shorts = [](std::initializer_list<int> values) {
    std::string out;
    for (const int value : values) test::append_number(out, static_cast<std::int16_t>(value));
    return out;
  };
  const auto words = [](std::initializer_list<int> values) {
    std::string out;
    for (const int value : values) test::append_number(out, static_cast<std::int32_t>(value));
    return out;
  };
  const std::string sizes = shorts({3, 4, 3, 5});
  const std::string rows = test::dicom_element(0x0028, 0x0010, "US", shorts({3}));
  const std::string stored = test::dicom_element(0x0028, 0x0101, "US", shorts({12}));
  const std::string frames = test::dicom_element(0x0028, 0x0008, "IS", "5 ");
  const std::string samples = test::dicom_element(0x0028, 0x0002, "US", shorts({1}));
  return {
      {"nifti", "grid.nii", sizes, shorts({3, 4, 3, 6})},
      {"nifti", "grid.nii", sizes, shorts({3, 4, -3, 5})},
      {"nifti", "grid.nii", sizes, shorts({8, 4, 3, 5})},
      {"nifti", "grid.nii", sizes, shorts({3, 32767, 32767, 32767})},
      {"nifti", "grid.nii", shorts({4, 16}), shorts({64, 16})},
      {"nifti", "grid.nii", shorts({4, 16}), shorts({64, 64})},
      {"nifti", "grid.nii", shorts({4, 16}), shorts({3333, 16})},
      {"nifti", "grid.nii", bytes_of(352.0f), bytes_of(353.0f)},
      {"nifti", "grid.nii", bytes_of(352.0f), bytes_of(1e30f)},
      {"nifti", "grid.nii", bytes_of(352.0f), bytes_of(-1.0f)},
      {"nifti", "grid.nii", bytes_of(std::int32_t{348}), bytes_of(std::int32_t{347})},
      {"nifti_pair", "grid.hdr", sizes, shorts({3, 5, 3, 5})},
      {"nifti2", "grid.nii", bytes_of(std::int64_t{4}), bytes_of(std::int64_t{1} << 60)},
      {"dicom", "a.dcm", rows, test::dicom_element(0x0028, 0x0010, "US", shorts({4}))},
      {"dicom", "a.dcm", rows, test::dicom_element(0x0028, 0x0010, "US", shorts({-1}))},
      {"dicom", "a.dcm", rows, test::dicom_element(0x0028, 0x0010, "US", shorts({0}))},
      {"dicom", "a.dcm", stored, test::dicom_element(0x0028, 0x0101, "US", shorts({17}))},
      {"dicom", "a.dcm", samples, test::dicom_element(0x0028, 0x0002, "US", shorts({3}))},
      {"dicom", "a.dcm", "1.2.840.10008.1.2.1", "1.2.840.10008.1.2.4"},
      {"dicom", "a.dcm", "OW" + std::string(2, '\0') + words({24}), "OW" + std::string(2, '\0') + words({22})},
      {"dicom", "a.dcm", "OW" + std::string(2, '\0') + words({24}), "OW" + std::string(2, '\0') + words({26})},
      {"dicom", "a.dcm", "OW" + std::string(2, '\0') + words({24}), "OW" + std::string(2, '\0') + words({-1})},
      {"dicom_frames", "grid.dcm", frames, test::dicom_element(0x0028, 0x0008, "IS", "6 ")},
      {"dicom_frames", "grid.dcm", frames, test::dicom_element(0x0028, 0x0008, "IS", "-5")},
      {"dicom_zip", "grid.zip", "DICM", "DICN"},
      {"tiff", "grid.tif", bytes_of(std::uint32_t{257} | 4u << 16) + words({1, 3}),
       bytes_of(std::uint32_t{257} | 4u << 16) + words({1, 4})},
      {"tiff", "grid.tif", bytes_of(std::uint32_t{256} | 4u << 16) + words({1, 4}),
       bytes_of(std::uint32_t{256} | 4u << 16) + words({1, 2000000000})},
      {"tiff", "grid.tif", bytes_of(std::uint32_t{258} | 4u << 16) + words({1, 8}),
       bytes_of(std::uint32_t{258} | 4u << 16) + words({1, 64})},
      {"tiff", "grid.tif", bytes_of(std::uint32_t{259} | 4u << 16) + words({1, 1}),
       bytes_of(std::uint32_t{259} | 4u << 16) + words({1, 5})},
      {"mrc", "grid.mrc", words({4, 3, 5, 2}), words({4, 3, 6, 2})},
      {"mrc", "grid.mrc", words({4, 3, 5, 2}), words({4, 3, -5, 2})},
      {"mrc", "grid.mrc", words({4, 3, 5, 2}), words({16777216, 16777216, 16777216, 2})},
      {"mrc", "grid.mrc", words({4, 3, 5, 2}), words({4, 3, 5, 5})},
      {"mrc", "grid.mrc", words({4, 3, 5, 2}), words({4, 3, 5, 4})},
      {"mrc", "grid.mrc", words({1, 2, 3}), words({1, 1, 3})},
  };
}

TEST(MalformedGridText, HostileReplacementsFail) { test::check_hostile(hostile_texts(), test::grid_samples()); }

TEST(MalformedGridBinary, HostileReplacementsFail) { test::check_hostile(hostile_binaries(), test::grid_samples()); }

/// Real files: what is large, and packed by other programs.
class MalformedPublicGrid : public testing::TestWithParam<const char*> {};

TEST_P(MalformedPublicGrid, TruncatedAndFlipped) {
  const fs::path file = fs::path(TETRAVOX_SHARED_DIR) / "data" / GetParam();
  if (!fs::exists(file)) GTEST_SKIP() << "no " << file;
  const TemporaryDirectory directory;
  const std::string text = test::read_text(file.string());
  test::Sample sample;
  sample.name = sample.main_file = GetParam();
  sample.write = [&](const fs::path& to) { test::write_text(to / GetParam(), text); };
  const test::Outcome whole = test::read_case(test::whole_case(sample, directory.path() / "whole"));
  ASSERT_TRUE(whole.dataset);
  std::mt19937 random(20240602);
  std::vector<Case> cuts, flips;
  const auto damage = [&](const std::string& name, const std::string& content) {
    return test::make_case(sample, directory.path() / "whole", directory.path(), name, GetParam(), content);
  };
  for (const std::size_t cut : test::cut_positions(text.size(), 6)) {
    cuts.push_back(damage("cut-" + std::to_string(cut), text.substr(0, cut)));
    cuts.back().must_fail_or_equal = true;
  }
  for (int i = 0; i < 10; ++i) {
    std::string damaged = text;
    const std::size_t reach = i % 2 == 0 ? std::min<std::size_t>(400, text.size()) : text.size();
    for (int k = 0; k < 4; ++k) damaged[random() % reach] ^= static_cast<char>(1 << random() % 8);
    flips.push_back(damage("flip-" + std::to_string(i), damaged));
  }
  test::check_all(cuts, whole.dataset);
  test::check_all(flips, std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(All, MalformedPublicGrid,
                         testing::Values("neghip.slc", "ironProt.vtk", "hydrogen.vti", "avg152T1_RL_nifti.nii.gz",
                                         "RectilinearGrid.vtr"),
                         [](const auto& instance) {
                           std::string name = instance.param;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

}  // namespace

}  // namespace tetravox
