#include "src/io/collections.h"
#include "src/io/time_steps.h"
#include "tetravox/error.h"

#include <gtest/gtest.h>

namespace tetravox::io {

namespace {

std::string pvd(const std::string& entries) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\"><Collection>" + entries +
         "</Collection></VTKFile>";
}

std::string error_of(const std::string& text) {
  try {
    parse_pvd(text, "a.pvd");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kBadFile);
    return error.what();
  }
  return {};
}

TEST(Pvd, ListsStepsAndParts) {
  const PvdCollection collection = parse_pvd(pvd("<DataSet timestep=\"2\" part=\"0\" file=\"c.vtu\"/>"
                                                 "<DataSet timestep=\" 1e0 \" part=\"1\" file=\"b.vtu\"/>"
                                                 "<DataSet timestep=\"1\" group=\"\" part=\"0\" file=\"a.vtu\"/>"),
                                             "a.pvd");
  EXPECT_EQ(collection.times, (std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(files_of_step(collection, 0), (std::vector<std::string>{"b.vtu", "a.vtu"}));
  EXPECT_EQ(files_of_step(collection, 1), (std::vector<std::string>{"c.vtu"}));
}

TEST(Pvd, MissingTimeIsZero) {
  EXPECT_EQ(parse_pvd(pvd("<DataSet file=\"a.vtu\"/>"), "a.pvd").times, std::vector<double>{0.0});
}

TEST(Pvd, SaysWhatIsWrong) {
  EXPECT_NE(error_of("").find("'a.pvd'"), std::string::npos);
  EXPECT_NE(error_of("<VTKFile><Collection>").find("not well-formed"), std::string::npos);
  EXPECT_NE(error_of("<VTKFile type=\"Collection\"/>").find("no Collection"), std::string::npos);
  EXPECT_NE(error_of(pvd("")).find("no file"), std::string::npos);
  EXPECT_NE(error_of(pvd("<DataSet file=\"a\"/><DataSet timestep=\"1\"/>")).find("entry 1"), std::string::npos);
  for (const char* time : {"x", "1x", "nan", "inf", "1e999"})
    EXPECT_NE(error_of(pvd("<DataSet timestep=\"" + std::string(time) + "\" file=\"a\"/>")).find("timestep"),
              std::string::npos);
}

TEST(Pvd, BoundedByTheNumberOfFiles) {
  std::string entries;
  for (std::size_t i = 0; i <= kMostCollectionFiles; ++i) entries += "<DataSet file=\"a\"/>";
  EXPECT_NE(error_of(pvd(entries)).find("more than"), std::string::npos);
}

TEST(Pvd, DeepNestingIsNoDanger) {
  std::string text;
  for (int i = 0; i < 200'000; ++i) text += "<a>";
  EXPECT_FALSE(error_of(text).empty());
}

TEST(FileList, NestedBlocks) {
  const FileList list = parse_file_list(
      "<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet><Block><DataSet file=\"a.vtu\"/><DataSet/>"
      "<Piece><DataSet file=\"b.vts\"/></Piece></Block></vtkMultiBlockDataSet></VTKFile>",
      "a.vtm");
  EXPECT_EQ(list.files, (std::vector<std::string>{"a.vtu", "b.vts"}));
}

TEST(FileList, PiecesFillTheirExtent) {
  const auto text = [](const char* second) {
    return std::string(
               "<VTKFile type=\"PStructuredGrid\"><PStructuredGrid WholeExtent=\"0 4 0 2 0 2\" "
               "GhostLevel=\"0\"><Piece Extent=\"0 2 0 2 0 2\" Source=\"a.vts\"/><Piece Extent=\"") +
           second + "\" Source=\"b.vts\"/></PStructuredGrid></VTKFile>";
  };
  EXPECT_EQ(parse_file_list(text("2 4 0 2 0 2"), "a.pvts").files.size(), 2u);
  for (const char* bad : {"1 4 0 2 0 2", "3 4 0 2 0 2", "4 2 0 2 0 2", "2 4", "2 4 0 2 0 x"})
    EXPECT_THROW(parse_file_list(text(bad), "a.pvts"), Error) << bad;
}

TEST(FileList, PathsAreRelativeToTheList) {
  EXPECT_EQ(resolve_path("/data/run/a.pvd", "parts/b.vtu"), "/data/run/parts/b.vtu");
  EXPECT_EQ(resolve_path("a.pvd", "b.vtu"), "b.vtu");
  EXPECT_EQ(resolve_path("/data/a.pvd", "/other/b.vtu"), "/other/b.vtu");
  EXPECT_EQ(resolve_path("/data/a.pvd", "parts\\b.vtu"), "/data/parts/b.vtu");
}

TEST(PickTime, ByIndexAndByNearestValue) {
  const std::vector<double> times{0.0, 0.5, 2.0};
  EXPECT_EQ(pick_time(times, {}, "a"), 0u);
  EXPECT_EQ(pick_time(times, {2, {}}, "a"), 2u);
  EXPECT_EQ(pick_time(times, {{}, 0.6}, "a"), 1u);
  EXPECT_EQ(pick_time(times, {{}, 2.0000001}, "a"), 2u);
  EXPECT_EQ(pick_time({}, {0, {}}, "a"), 0u);
}

TEST(PickTime, OutOfRangeSaysTheRange) {
  const std::vector<double> times{0.0, 0.5, 2.0};
  for (const TimeRequest& request : {TimeRequest{3, {}}, TimeRequest{{}, 2.5}, TimeRequest{{}, -1.0}}) {
    try {
      pick_time(times, request, "a.pvd");
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
      EXPECT_NE(std::string(error.what()).find("steps 0 to 2, times 0 to 2"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(pick_time({}, {1, {}}, "a"), Error);
  EXPECT_THROW(pick_time({}, {{}, 1.0}, "a"), Error);
}

}  // namespace

}  // namespace tetravox::io
