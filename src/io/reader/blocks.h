#pragma once

/// What the readers of all formats return: data sets of VTK, one a block.

#include "tetravox/error.h"
#include "tetravox/scene.h"

#include <vtkDataSet.h>
#include <vtkSmartPointer.h>

#include <cstdint>
#include <string>
#include <vector>

class vtkAlgorithm;
class vtkDataObject;

namespace tetravox::io {

struct FileContents {
  std::vector<vtkSmartPointer<vtkDataSet>> blocks;
  std::vector<double> times;
  std::size_t time_index = 0;
  std::string format;
  std::vector<std::string> notes;
  /// Where the slices of an image lie along k, from its origin on, strictly ascending; empty: evenly, as it says.
  std::vector<double> slice_coordinates;
};

/// Reads a file of any format.
/// @throws Error that names the file.
FileContents read_file(const std::string& path, const std::string& grid_file, const TimeRequest& time);

/// @throws Error (kBadFile) that names the file and what is wrong.
[[noreturn]] void fail_file(const std::string& path, const std::string& what);

/// Runs VTK's reader for the step that `time` asks for, with progress; fills in `times` and `time_index`.
/// @throws Error with VTK's first complaint.
void update_reader(vtkAlgorithm& reader, const std::string& path, const TimeRequest& time, FileContents& contents);

/// Appends the data set, or all leaves of the composite data set, that a reader returned.
void append_blocks(vtkDataObject* data, FileContents& contents);

// One function a family of formats.
FileContents read_xml(const std::string& path, const TimeRequest& time);         // VTU, VTS, VTR, VTI
FileContents read_collection(const std::string& path, const TimeRequest& time);  // PVD, VTM, PVTU, PVTS, PVTI, PVTR
FileContents read_grid_pieces(const std::string& path);                          // PVTI, PVTR
FileContents read_legacy(const std::string& path);
FileContents read_vtkhdf(const std::string& path, const TimeRequest& time);
FileContents read_exodus(const std::string& path, const TimeRequest& time);
FileContents read_cgns(const std::string& path, const TimeRequest& time);
FileContents read_ensight(const std::string& path, const TimeRequest& time);
FileContents read_openfoam(const std::string& path, const TimeRequest& time);
FileContents read_ucd(const std::string& path);
FileContents read_plot3d(const std::string& path, const std::string& solution_path);
FileContents read_nrrd(const std::string& path, const TimeRequest& time);
FileContents read_meta_image(const std::string& path, const TimeRequest& time);
FileContents read_nifti(const std::string& path, const TimeRequest& time);
FileContents read_slc(const std::string& path);
FileContents read_dicom(const std::string& path);
FileContents read_tiff(const std::string& path);
FileContents read_mrc(const std::string& path);

}  // namespace tetravox::io
