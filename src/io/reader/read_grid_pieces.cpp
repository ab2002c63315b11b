// PVTI and PVTR: pieces of one grid, put together. Each piece is read as a file of its own, which sees damage that
// VTK's parallel readers fill with whatever stands in memory, and is given back before the next.

#include "src/io/collections.h"
#include "src/io/formats.h"
#include "src/io/reader/blocks.h"
#include "src/io/reader/status.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkMatrix3x3.h>
#include <vtkPointData.h>
#include <vtkRectilinearGrid.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tetravox::io {

namespace {

using Extent = std::array<int, 6>;

Extent extent_of(vtkDataSet& data) {
  Extent extent{0, -1, 0, -1, 0, -1};
  if (auto* image = vtkImageData::SafeDownCast(&data)) image->GetExtent(extent.data());
  if (auto* grid = vtkRectilinearGrid::SafeDownCast(&data)) grid->GetExtent(extent.data());
  return extent;
}

/// The boxes of points, or of cells: along an axis of one point there is one layer of cells.
struct Box {
  std::array<std::int64_t, 3> first{}, count{};

  Box(const Extent& extent, bool is_cells) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first[axis] = extent[2 * axis];
      count[axis] = std::int64_t{extent[2 * axis + 1]} - extent[2 * axis] + (is_cells ? 0 : 1);
      if (is_cells) count[axis] = std::max<std::int64_t>(count[axis], 1);
    }
  }
  std::int64_t total() const { return count[0] * count[1] * count[2]; }
  /// Index of the first value of a row of `part`.
  std::int64_t row(const Box& part, std::int64_t j, std::int64_t k) const {
    return (part.first[0] - first[0]) +
           count[0] * ((part.first[1] - first[1] + j) + count[1] * (part.first[2] - first[2] + k));
  }
};

/// A grid that grows piece by piece.
class Assembly {
 public:
  Assembly(const std::string& path, const Extent& extent) : path_(path), extent_(extent) {}

  void add(vtkDataSet& piece, std::size_t index) {
    place_ = "piece " + std::to_string(index);
    const Extent extent = extent_of(piece);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (extent[2 * axis] < extent_[2 * axis] || extent[2 * axis + 1] > extent_[2 * axis + 1] ||
          extent[2 * axis] > extent[2 * axis + 1])
        fail_file(path_, place_ + " lies outside its whole extent");
    if (!whole_) begin(piece);
    if (whole_->GetDataObjectType() != piece.GetDataObjectType()) fail_file(path_, place_ + " is of another kind");
    add_geometry(piece, extent);
    add_values(*piece.GetPointData(), *whole_->GetPointData(), extent, false);
    add_values(*piece.GetCellData(), *whole_->GetCellData(), extent, true);
  }

  vtkSmartPointer<vtkDataSet> finish() {
    for (const std::vector<bool>& covered : covered_)
      if (std::find(covered.begin(), covered.end(), false) != covered.end()) fail_file(path_, "its pieces leave gaps");
    return whole_;
  }

 private:
  void begin(vtkDataSet& piece) {
    whole_.TakeReference(piece.NewInstance());
    if (auto* image = vtkImageData::SafeDownCast(whole_)) image->SetExtent(extent_.data());
    if (auto* grid = vtkRectilinearGrid::SafeDownCast(whole_)) grid->SetExtent(extent_.data());
    begin_geometry(piece);
    begin_values(*piece.GetPointData(), *whole_->GetPointData(), false);
    begin_values(*piece.GetCellData(), *whole_->GetCellData(), true);
  }

  void begin_geometry(vtkDataSet& piece) {
    if (auto* image = vtkImageData::SafeDownCast(whole_)) {
      auto& from = static_cast<vtkImageData&>(piece);
      image->SetOrigin(from.GetOrigin());
      image->SetSpacing(from.GetSpacing());
      image->SetDirectionMatrix(from.GetDirectionMatrix()->GetData());
      return;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      axes_[axis] = vtkSmartPointer<vtkDoubleArray>::New();
      axes_[axis]->SetNumberOfTuples(extent_[2 * axis + 1] - extent_[2 * axis] + 1);
      axes_[axis]->Fill(std::numeric_limits<double>::quiet_NaN());
    }
    auto& grid = static_cast<vtkRectilinearGrid&>(*whole_);
    grid.SetXCoordinates(axes_[0]);
    grid.SetYCoordinates(axes_[1]);
    grid.SetZCoordinates(axes_[2]);
  }

  void begin_values(vtkDataSetAttributes& from, vtkDataSetAttributes& to, bool is_cells) {
    const Box box(extent_, is_cells);
    for (int i = 0; i < from.GetNumberOfArrays(); ++i) {
      vtkDataArray* array = from.GetArray(i);
      if (!array || is_marker(*array)) continue;
      const auto whole = vtkSmartPointer<vtkDataArray>::Take(array->NewInstance());
      whole->SetName(array->GetName());
      whole->SetNumberOfComponents(array->GetNumberOfComponents());
      whole->SetNumberOfTuples(box.total());
      to.AddArray(whole);
    }
    covered_[is_cells ? 1 : 0].assign(static_cast<std::size_t>(box.total()), false);
  }

  void add_geometry(vtkDataSet& piece, const Extent& extent) {
    if (auto* image = vtkImageData::SafeDownCast(&piece)) {
      auto& whole = static_cast<vtkImageData&>(*whole_);
      const bool is_same =
          std::equal(image->GetOrigin(), image->GetOrigin() + 3, whole.GetOrigin()) &&
          std::equal(image->GetSpacing(), image->GetSpacing() + 3, whole.GetSpacing()) &&
          std::equal(image->GetDirectionMatrix()->GetData(), image->GetDirectionMatrix()->GetData() + 9,
                     whole.GetDirectionMatrix()->GetData());
      if (!is_same) fail_file(path_, place_ + " has another origin, spacing or direction than the first");
      return;
    }
    auto& grid = static_cast<vtkRectilinearGrid&>(piece);
    vtkDataArray* const axes[3] = {grid.GetXCoordinates(), grid.GetYCoordinates(), grid.GetZCoordinates()};
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (int i = extent[2 * axis]; i <= extent[2 * axis + 1]; ++i)
        axes_[axis]->SetValue(i - extent_[2 * axis], axes[axis]->GetComponent(i - extent[2 * axis], 0));
  }

  /// Copies all values of the piece but duplicates, row by row.
  void add_values(vtkDataSetAttributes& from, vtkDataSetAttributes& to, const Extent& extent, bool is_cells) {
    const Box whole(extent_, is_cells), part(extent, is_cells);
    const auto* marks = vtkUnsignedCharArray::SafeDownCast(from.GetArray(vtkDataSetAttributes::GhostArrayName()));
    check_marks(marks, part, is_cells);
    std::vector<std::pair<vtkDataArray*, vtkDataArray*>> pairs;
    for (int i = 0; i < to.GetNumberOfArrays(); ++i) {
      vtkDataArray* array = to.GetArray(i);
      vtkDataArray* other = from.GetArray(array->GetName());
      if (!other || other->GetNumberOfComponents() != array->GetNumberOfComponents() ||
          other->GetDataType() != array->GetDataType() || other->GetNumberOfTuples() != part.total())
        fail_file(path_, place_ + " lacks array '" + array->GetName() + "' as the first piece has it");
      pairs.emplace_back(array, other);
    }
    std::vector<bool>& covered = covered_[is_cells ? 1 : 0];
    for (std::int64_t k = 0; k < part.count[2]; ++k)
      for (std::int64_t j = 0; j < part.count[1]; ++j) {
        const std::int64_t row = part.row(part, j, k), target = whole.row(part, j, k);
        copy_row(pairs, marks, row, target, part.count[0], covered);
      }
  }

  /// Copies the runs of a row that are not duplicates of another piece's.
  static void copy_row(const std::vector<std::pair<vtkDataArray*, vtkDataArray*>>& pairs,
                       const vtkUnsignedCharArray* marks, std::int64_t row, std::int64_t target, std::int64_t count,
                       std::vector<bool>& covered) {
    const auto is_own = [&](std::int64_t i) {
      return !marks || (marks->GetValue(row + i) & vtkDataSetAttributes::DUPLICATECELL) == 0;
    };
    for (std::int64_t i = 0; i < count;) {
      std::int64_t end = i;
      while (end < count && is_own(end)) covered[static_cast<std::size_t>(target + end++)] = true;
      for (const auto& [to, from] : pairs)
        if (end > i) to->InsertTuples(target + i, end - i, row + i, from);
      i = end + 1;
    }
  }

  void check_marks(const vtkUnsignedCharArray* marks, const Box& part, bool is_cells) const {
    if (!marks) return;
    if (marks->GetNumberOfTuples() != part.total()) fail_file(path_, place_ + " has marks of another number");
    int hidden = vtkDataSetAttributes::HIDDENPOINT;
    if (is_cells) hidden = vtkDataSetAttributes::HIDDENCELL;
    for (std::int64_t i = 0; i < part.total(); ++i)
      if ((marks->GetValue(i) & hidden) != 0)
        throw Error(ErrorCode::kUnsupported,
                    "'" + path_ + "', " + place_ + ": it hides cells or points: write the grid as one file");
  }

  static bool is_marker(vtkDataArray& array) {
    return !array.GetName() || std::string_view(array.GetName()) == vtkDataSetAttributes::GhostArrayName();
  }

  std::string path_, place_;
  Extent extent_;
  vtkSmartPointer<vtkDataSet> whole_;
  std::array<vtkSmartPointer<vtkDoubleArray>, 3> axes_;
  std::array<std::vector<bool>, 2> covered_;  ///< points, cells
};

/// Points of an extent, which must be within reason before memory is taken for them.
Extent parse_extent(const FileList& list, const std::string& path) {
  std::array<std::uint64_t, 3> points{};
  Extent extent{};
  count_extent_cells(list.whole_extent, path, &points, &extent);
  if (points[0] * points[1] > (std::uint64_t{1} << 40) / points[2]) fail_file(path, "its whole extent makes no sense");
  return extent;
}

}  // namespace

FileContents read_grid_pieces(const std::string& path) {
  const FileList list = parse_file_list(read_collection_text(path), path);
  Assembly assembly(path, parse_extent(list, path));
  FileContents contents;
  for (std::size_t i = 0; i < list.files.size(); ++i) {
    const std::string file = resolve_path(path, list.files[i]);
    try {
      if (const Format format = detect_format(file, false); format != Format::kVti && format != Format::kVtr)
        fail_file(file, "it is no piece of a grid (" + format_name(format) + ")");
      FileContents piece = read_file(file, {}, {});
      throw_if_vtk_failed(file);
      for (const auto& block : piece.blocks) assembly.add(*block, i);
    } catch (const Error& error) {
      const bool is_missing = error.code() == ErrorCode::kFileNotFound;
      throw Error(is_missing ? ErrorCode::kBadFile : error.code(),
                  "'" + path + "', entry " + std::to_string(i) + ": " + error.what());
    }
    send_progress(0.9 * static_cast<double>(i + 1) / static_cast<double>(list.files.size()));
  }
  contents.blocks.push_back(assembly.finish());
  return contents;
}

}  // namespace tetravox::io
